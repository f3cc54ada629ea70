// SPDX-License-Identifier: BSD-3-Clause
/// Against the reference: stage by stage from its own input, and running free.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/check/check.hpp"
#include "verification/suite/probes.hpp"
#include "verification/support/snow_cases.hpp"

namespace firn::suite {
namespace {

/// Each row of the check is a row here.
void compare(const fixtures::Case& c, const CheckOptions& options) {
  const auto reference = subject().create_reference();
  const auto solver = make_subject();
  const CheckReport report = run_check(c.scene, c.state, *reference, *solver, options);
  for (const FieldCheck& row : report.fields)
    if (row.compared > 0)
      within_all(fmt::format("{}: {}{} after {}", c.name, name(row.field), row.kept ? " kept" : "",
                             stage_range(row.from, row.through)),
                 row.compared,
                 row.valid ? std::min(row.largest_in_bounds, 1.0)
                           : std::max(row.largest_in_bounds, 1.001));
  for (const PropertyCheck& row : report.properties)
    expect(fmt::format("{}: {}", c.name, row.name), row.valid, row.detail);
  if (report.first_divergence)
    expect(fmt::format("{}: no divergence", c.name), false,
           fmt::format("step {}, {}: {}", report.first_divergence->step,
                       stage_range(report.first_divergence->from, report.first_divergence->through),
                       report.first_divergence->message));
}

void lockstep(fixtures::Case c, std::int64_t start_step = 0) {
  if (subject().slow) c.state.particles.resize(std::min<std::size_t>(c.state.particles.size(), 60));
  CheckOptions options;
  options.steps = c.steps;
  options.start_step = start_step;
  compare(c, options);
}

FIRN_TEST(Lockstep, lump_on_a_slope) { lockstep(fixtures::lump_on_slope()); }
FIRN_TEST(Lockstep, lump_on_a_slope_later) { lockstep(fixtures::lump_on_slope(), 40); }
FIRN_TEST(Lockstep, periodic_lump) { lockstep(fixtures::periodic_lump()); }
FIRN_TEST(Lockstep, awkward_lump) { lockstep(fixtures::awkward_lump()); }

FIRN_TEST(Lockstep, implicit_lump) {
  if (!solves_implicitly()) GTEST_SKIP() << "the solver takes explicit scenes only";
  lockstep(fixtures::implicit_lump());
}

/// A case of adaptive steps has steps of its own choice in both runs.
FIRN_TEST(FreeRunning, lump_on_a_slope) {
  CheckOptions options;
  options.mode = CheckMode::free_running;
  options.steps = effort(100, 5);
  compare(fixtures::lump_on_slope(), options);
}

FIRN_TEST(FreeRunning, periodic_lump) {
  CheckOptions options;
  options.mode = CheckMode::free_running;
  options.steps = effort(100, 5);
  compare(fixtures::periodic_lump(), options);
}

}  // namespace
}  // namespace firn::suite
