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

Case awkward_lump() {
  Case c = lump_on_slope();
  Particles& p = c.state.particles;
  const double h = c.scene.grid.spacing;
  const Vec3 o = c.scene.grid.origin;
  p.x[0] = o + h * Vec3(4, 4, 3);      // on a node
  p.x[1] = o + h * Vec3(4, 4.5, 3.5);  // on a face
  p.x[2] = Vec3(std::nextafter(p.x[1][0], 1), p.x[1][1], p.x[1][2]);
  p.x[3] = Vec3(std::nextafter(p.x[1][0], 0), p.x[1][1], p.x[1][2]);
  p.x[4] = p.x[5];                                     // coincident
  p.x[6] = o + h * Vec3(40.25, -30.5, 25.75);          // alone
  p.x[7] = o + h * Vec3(40.25 + 3.999, -30.5, 25.75);  // within reach by a thousandth of h
  p.m[8] *= 1e-4;
  p.V_0[8] *= 1e-4;
  p.m[9] *= 1e3;
  p.F_E[10] = -Mat3::Identity();
  p.F_E[11] = Vec3(1, 1, -0.99).asDiagonal();
  p.F_E[12] = Vec3(1, 0.5, 1e-3).asDiagonal();
  p.F_E[13] << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  p.F_E[14] = Vec3(0.5, 0.6, 0.7).asDiagonal();
  p.F_E[15] = Vec3(1.5, 1.2, 1.4).asDiagonal();
  p.F_E[16] = Mat3::Identity();
  p.F_P[17] *= 0.85;
  p.F_P[18] *= 1.3;
  p.v[19].setZero();
  return c;
}

Case far_lump() {
  Case c = lump_on_slope();
  const Vec3 away = 20000 * c.scene.grid.spacing * Vec3(1, -1, 0.5);
  c.scene.grid.origin += away;
  for (Vec3& x : c.state.particles.x) x += away;
  for (Collider& collider : c.scene.colliders) {
    if (auto* plane = std::get_if<HalfSpace>(&collider.shape)) plane->point += away;
    if (auto* sphere = std::get_if<Sphere>(&collider.shape)) sphere->center += away;
    collider.center += away;
  }
  return c;
}

Case periodic_lump() {
  Case c{snow_scene(), {}};
  c.scene.grid.periodic = {0.3, 0, 0};
  c.state = lump(c.scene, 300, {0.1, 0.2, 0.2}, 0.15);
  return c;
}

}  // namespace firn::test
