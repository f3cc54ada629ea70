#include "verification/check/tests/scenes.hpp"

#include <cmath>
#include <random>

namespace firn::test {

namespace {

/// Uniform numbers in [−1, 1], the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return std::ldexp(static_cast<double>(engine_() >> 11), -52) - 1; }
  Vec3 vec3() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
  Mat3 mat3() {
    Mat3 m;
    for (int row = 0; row < 3; ++row) m.row(row) = vec3();
    return m;
  }

 private:
  std::mt19937_64 engine_;
};

Scene snow_scene() {
  Scene scene;
  scene.name = "lump";
  scene.gravity = {0, 0, -9.81};
  scene.grid.spacing = 0.05;
  scene.grid.origin = {0.01, -0.02, 0.03};
  scene.time.step = 1e-4;
  scene.time.end = 1;
  scene.materials.push_back(Material{});
  return scene;
}

State lump(const Scene& scene, std::size_t n, const Vec3& center, double half_width) {
  Random random(7);
  State state;
  Particles& p = state.particles;
  p.resize(n);
  const double h = scene.grid.spacing;
  for (std::size_t q = 0; q < n; ++q) {
    p.x[q] = scene.wrap(center + half_width * random.vec3());
    p.v[q] = Vec3(1, 0.3, -2) + 0.5 * random.vec3();
    p.m[q] = 50 * h * h * h * (1 + 0.5 * random());
    p.V_0[q] = q % 2 == 0 ? p.m[q] / 400 : 0;
    p.F_E[q] = Mat3::Identity() + 0.03 * random.mat3();
    p.F_P[q] = Mat3::Identity() + 0.05 * random.mat3();
    p.id[q] = static_cast<std::int64_t>(n - q);
  }
  return state;
}

}  // namespace

Case lump_on_slope() {
  Case c{snow_scene(), {}};
  Collider slope;
  slope.shape = HalfSpace{{0.0123, 0.0077, 0.0031}, {0.2, 0.1, 1}};
  slope.center = center(slope.shape);
  slope.friction = 0.3;
  Collider wheel;
  wheel.shape = Sphere{{0.32, 0.21, 0.1}, 0.12};
  wheel.center = center(wheel.shape);
  wheel.sticky = true;
  wheel.angular_velocity = {0, 3, 1};
  c.scene.colliders = {slope, wheel};
  c.state = lump(c.scene, 400, {0.2, 0.2, 0.1}, 0.12);
  return c;
}

Case implicit_lump_on_slope() {
  Case c = lump_on_slope();
  c.scene.time.step = 1e-3;
  c.scene.integrator.type = IntegratorType::semi_implicit;
  c.scene.integrator.tolerance = 1e-6;
  return c;
}

Case periodic_lump() {
  Case c{snow_scene(), {}};
  c.scene.grid.periodic = {0.3, 0, 0};
  c.state = lump(c.scene, 300, {0.1, 0.2, 0.2}, 0.15);
  return c;
}

}  // namespace firn::test
