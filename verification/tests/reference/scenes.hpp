#pragma once
/// Small scenes for the tests of the reference's steps.

#include <random>

#include "firn/registry.hpp"
#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "reference/reference_solver.hpp"

namespace firn::test {

/// h = 0.1, no gravity, no colliders, the paper's snow.
inline Scene empty_scene() {
  Scene scene;
  scene.grid.spacing = 0.1;
  scene.time.step = 1e-4;
  scene.materials.push_back(Material{});
  return scene;
}

inline std::unique_ptr<Solver> make_reference() { return make_reference_solver({}); }

/// n particles at rest, undeformed, 1 kg each, in the middle of cell (0,0,0).
inline State particles_at_rest(const Scene& scene, std::size_t n = 1) {
  State state;
  state.particles.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    state.particles.x[p] = Vec3::Constant(0.5 * scene.grid.spacing);
    state.particles.m[p] = 1;
    state.particles.id[p] = static_cast<std::int64_t>(p);
  }
  return state;
}

/// Uniform numbers in [−1, 1], the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-52 - 1; }
  Vec3 vec3() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
  Mat3 mat3() {
    Mat3 m;
    for (int column = 0; column < 3; ++column) m.col(column) = vec3();
    return m;
  }

 private:
  std::mt19937_64 engine_;
};

/// n particles strewn over a cube of `cells` cells around the origin, with random
/// masses, velocities and elastic and plastic deformations of a few per cent.
inline State random_particles(const Scene& scene, std::size_t n, double cells, std::uint64_t seed) {
  Random random(seed);
  State state;
  Particles& p = state.particles;
  p.resize(n);
  const double h = scene.grid.spacing;
  for (std::size_t i = 0; i < n; ++i) {
    p.x[i] = scene.grid.origin + 0.5 * cells * h * random.vec3();
    p.v[i] = random.vec3();
    p.m[i] = 400 * h * h * h / 8 * (1 + 0.5 * random());
    p.F_E[i] = Mat3::Identity() + 0.02 * random.mat3();
    p.F_P[i] = Mat3::Identity() + 0.05 * random.mat3();
    p.id[i] = static_cast<std::int64_t>(i);
  }
  return state;
}

}  // namespace firn::test
