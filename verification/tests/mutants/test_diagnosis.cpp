// SPDX-License-Identifier: BSD-3-Clause
/// A check says what wrong numbers have in common, and which rule makes them.

#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "verification/check/check.hpp"
#include "verification/studies/standard_set.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn {
namespace {

using fixtures::builtin_registry;
using fixtures::make_reference;

/// The tables of the standard cases in which the mutant shows.
std::string tables(const std::string& mutant) {
  std::string all;
  for (const studies::StandardCase& c : studies::standard_set()) {
    const auto subject = builtin_registry().create("mutant:" + mutant, {});
    const CheckReport report = run_check(c.scene, c.windows, *make_reference(), *subject);
    if (!report.valid()) all += to_table(report);
  }
  return all;
}

class Diagnosis : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Diagnosis, NamesTheMistake) {
  const auto& [mutant, phrase] = GetParam();
  const std::string text = tables(mutant);
  EXPECT_NE(text.find(phrase), std::string::npos) << phrase << "\n" << text;
}

INSTANTIATE_TEST_SUITE_P(
    Mutants, Diagnosis,
    testing::Values(
        std::pair{"force_sign",
                  "stage 3 grid_forces, f_i: 2 of the field's size; subject = -1 × "
                  "reference"},
        std::pair{"gradient_without_1_over_h", "subject = 0.05 × reference, and h = 0.05"},
        std::pair{"cell_area_for_volume", "the subject's change = 20 × the reference's, and 1/h"},
        std::pair{"half_a_kick", "the subject's change = 0.5 × the reference's"},
        std::pair{"force_taken_for_velocity", "and 1/Δt = "},
        std::pair{"gravity_missing", "differs by −gΔt everywhere"},
        std::pair{"gravity_twice", "differs by gΔt everywhere"},
        std::pair{"particle_collisions_skipped", "unchanged in the subject"},
        std::pair{"light_nodes_thresholded", "the nodes are missing in the subject"},
        std::pair{"truncation_for_floor", "all wrong numbers belong to nodes of negative index"},
        std::pair{"limits_of_material_zero", "belong to particles of material 1 (wet)"},
        std::pair{"svd_of_normal_equations", "belong to particles with an inverted F_E"},
        std::pair{"sticky_slides", "all wrong numbers belong to nodes inside a collider"},
        std::pair{"kernel_as_printed", "m_p differ: a kernel in expanded form"}),
    [](const auto& info) { return std::string(info.param.first); });

}  // namespace
}  // namespace firn
