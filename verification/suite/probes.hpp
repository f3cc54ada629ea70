// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What several suites need: particles so far apart that each has its nodes to itself, the
/// kernel in extended precision, sums over particles and nodes.

#include <string>
#include <vector>

#include "firn/error.hpp"
#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "verification/oracles/svd_oracle.hpp"
#include "verification/suite/ledger.hpp"
#include "verification/suite/subject.hpp"
#include "verification/support/scenes.hpp"
#include "verification/support/snow.hpp"

namespace firn::suite {

/// A test of the suite. Where the subject says that it does not do what a scene asks for, the
/// test does not apply.
#define FIRN_TEST(topic, name)             \
  static void topic##_##name();            \
  TEST(topic, name) {                      \
    try {                                  \
      topic##_##name();                    \
    } catch (const Unsupported& refusal) { \
      GTEST_SKIP() << refusal.what();      \
    }                                      \
  }                                        \
  static void topic##_##name()

/// For tests of many steps: a guest that is a program per step would take hours.
#define FIRN_NEEDS_SPEED() \
  if (subject().slow) GTEST_SKIP() << "every step starts a program: too long"

using verification::Matrix;
using verification::Real;

/// h of the scenes here, a power of two: positions that are multiples of h/4096 are held exactly
/// by every solver, also in float.
inline constexpr double spacing = 0x1p-4;

/// No gravity, no colliders, α = 1, one elastic material of the paper's stiffness, Δt = 1e-4 s.
Scene plain_scene();

using fixtures::elastic_material;

/// n particles of random snow in a cube of `cells` cells around the origin, in numbers that the
/// subject can hold.
State rounded_snow(std::size_t n, double cells, std::uint64_t seed,
                   const fixtures::Snow& snow = {});

/// N and N' of the cubic B-spline in extended precision, in factored form; x in units of h.
Real N(Real x);
Real dN(Real x);

/// x_i [m].
Vec3 position(const Scene& scene, const NodeIndex& node);

Matrix to_matrix(const Mat3& m);
Mat3 to_mat3(const Matrix& m);

/// Particles six cells apart, each near the middle of its own 4×4×4 nodes, around the grid's
/// origin, so that half of the coordinates are negative.
struct LoneParticles {
  Scene scene = plain_scene();
  State state;
  int edge = 0;  ///< particles along an edge of the cube

  /// n = edge³ particles of 1 kg and h³, at rest, undeformed, at random places of their cells,
  /// the awkward ones (on a node, beside it, in the middle) among them.
  explicit LoneParticles(int edge, std::uint64_t seed = 1);

  std::size_t size() const { return state.particles.size(); }
  /// Which particle a node belongs to.
  std::size_t owner(const NodeIndex& node) const;
};

/// τ_p of each particle as the solver's forces have it: −Σ f_i ⊗ (x_i − x_p)/V where it stops
/// after step 3, else from the growth of F in one whole step, Δt ∇v = −(Δt²V/m) τ Σ ∇w∇wᵀ/w.
std::vector<Mat3> kirchhoff_stresses(const LoneParticles& lone);

/// Rounding of τ [Pa]: each of its terms takes some ten operations on numbers of this size.
double stress_roundoff(const Material& material, const Mat3& F_E, const Mat3& F_P);

/// The same and what kirchhoff_stresses() adds where τ has to be measured from a whole step.
double measured_stress_roundoff(const Material& material, const Mat3& F_E, const Mat3& F_P);

/// The stage's input, made by the subject itself, for a test to alter.
State before_stage(const Scene& scene, const State& state, Stage stage, double dt);

struct Totals {
  double mass = 0, kinetic_energy = 0;
  Vec3 momentum = Vec3::Zero(), angular_momentum = Vec3::Zero();
  double momentum_scale = 0;  ///< Σ m|v|: the size of the terms, which carries the roundoff
  double angular_scale = 0;   ///< Σ m|x||v|
};
Totals totals(const Particles& particles);
Totals totals(const Scene& scene, const Grid& grid, const std::vector<Vec3>& v);

/// Calls visit(i, w_ip) for every node of `grid` within reach of x, weights in extended
/// precision; `grid.node` is sorted.
template <class Visit>
void for_each_weight(const Scene& scene, const Grid& grid, const Vec3& x, Visit&& visit);

/// Place of a node in the sorted list; its size where it is missing.
std::size_t place_of(const Grid& grid, const NodeIndex& node);

template <class Visit>
void for_each_weight(const Scene& scene, const Grid& grid, const Vec3& x, Visit&& visit) {
  Real X[3];
  std::int32_t first[3];
  for (int a = 0; a < 3; ++a) {
    X[a] = (static_cast<Real>(x[a]) - scene.grid.origin[a]) / scene.grid.spacing;
    first[a] = static_cast<std::int32_t>(std::floor(X[a])) - 1;
  }
  const auto wrapped = [&](std::int32_t i, int axis) {
    const int n = scene.grid.period_nodes(axis);
    return n == 0 ? i : ((i % n) + n) % n;
  };
  for (std::int32_t a = first[0]; a < first[0] + 4; ++a)
    for (std::int32_t b = first[1]; b < first[1] + 4; ++b)
      for (std::int32_t c = first[2]; c < first[2] + 4; ++c) {
        const Real w = N(X[0] - a) * N(X[1] - b) * N(X[2] - c);
        const std::size_t i = place_of(grid, {wrapped(a, 0), wrapped(b, 1), wrapped(c, 2)});
        if (i < grid.size()) visit(i, static_cast<double>(w));
      }
}

/// Skips the running test unless the subject stops after every one of these stages.
#define FIRN_NEEDS_STOP(stage) \
  if (!stops_at(stage)) GTEST_SKIP() << "the solver does not stop after step " << number(stage)

}  // namespace firn::suite
