// SPDX-License-Identifier: BSD-3-Clause
/// snowball_drop before it touches anything: the centre of mass obeys
/// X0 + nΔt V0 + gΔt² n(n+1)/2 whatever happens inside the ball, because step 4
/// adds gΔt to every node, the transfers conserve momentum, and step 10 moves
/// with the new velocity.

#include <cmath>
#include <gtest/gtest.h>

#include "io/scene/scene_file.hpp"
#include "io/trajectory/reader.hpp"
#include "verification/support/program.hpp"

namespace firn::test {
namespace {

using fixtures::Outcome;
using fixtures::run_firn;
using fixtures::TemporaryFolder;

class FreeFall : public testing::TestWithParam<const char*> {};

TEST_P(FreeFall, CenterOfMassFollowsTheDiscreteParabola) {
  const TemporaryFolder folder;
  constexpr std::int64_t steps = 60;  // before contact: the gap closes at step 100 or later
  const Outcome outcome = run_firn({"run", "snowball_drop", "--solver", GetParam(), "--steps",
                                    std::to_string(steps), "--threads", "1", "-o", "a.vtkhdf"},
                                   folder.path());
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Scene scene = find_scene("snowball_drop");
  const TrajectoryReader reader(folder.path() / "a.vtkhdf");
  const std::vector<DiagnosticsRow> rows = reader.diagnostics();
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(steps));

  const Particles initial = reader.read_frame(0).particles;
  Vec3 X0 = Vec3::Zero(), V0 = Vec3::Zero();
  double mass = 0;
  for (std::size_t p = 0; p < initial.size(); ++p) {
    X0 += initial.m[p] * initial.x[p];
    V0 += initial.m[p] * initial.v[p];
    mass += initial.m[p];
  }
  X0 /= mass;
  V0 /= mass;

  const double dt = scene.time.step;
  for (std::int64_t n = 1; n <= steps; ++n) {
    const Diagnostics& row = rows[static_cast<std::size_t>(n - 1)];
    const double count = static_cast<double>(n);
    const Vec3 expected =
        X0 + count * dt * V0 + scene.gravity * (dt * dt * count * (count + 1) / 2);
    // Sums of n_p = 4194 terms of size ≤ 0.5 m round to √n_p·eps·0.5 m ≈ 7e-15 m; measured 1e-15.
    EXPECT_LE((row.center_of_mass - expected).norm(), 1e-13) << "step " << n;
    // Mass is the same sum of the same numbers; only a solver's own order may differ by roundoff.
    EXPECT_LE(std::abs(row.mass - mass), 1e-13 * mass) << "step " << n;
    // n_p terms of one sign: n_p·eps = 4194 · 2.2e-16 = 9.3e-13 of the sum at the most, in each of
    // the two sums that are compared.
    const Vec3 momentum = mass * (V0 + count * dt * scene.gravity);
    EXPECT_LE((row.momentum - momentum).norm(), 2e-12 * momentum.norm()) << "step " << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, FreeFall, testing::Values("reference", "optimized"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace firn::test
