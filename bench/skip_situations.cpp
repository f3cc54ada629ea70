// SPDX-License-Identifier: BSD-3-Clause
#include "bench/skip_situations.hpp"

#include <cmath>

namespace firn::bench {

namespace {

constexpr std::size_t size = 100'000;

Workload elastic(std::uint64_t seed) { return block(size, Deformation::elastic, seed); }
Workload plastic(std::uint64_t seed) { return block(size, Deformation::plastic, seed); }

double middle(const Particles& p) {
  double sum = 0;
  for (const Vec3& x : p.x) sum += x[0];
  return sum / static_cast<double>(p.size());
}

/// Every particle with x < share of the block's width yields, the others are elastic.
Workload partly_plastic(double share, std::uint64_t seed) {
  Workload work = plastic(seed);
  const Workload other = elastic(seed);
  Particles& p = work.state.particles;
  const double border = 2 * share * middle(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.x[i][0] < border) continue;
    p.F_E[i] = other.state.particles.F_E[i];
    p.v[i] = other.state.particles.v[i];
  }
  return work;
}

Workload half_plastic(std::uint64_t seed) { return partly_plastic(0.5, seed); }
Workload tenth_plastic(std::uint64_t seed) { return partly_plastic(0.1, seed); }

/// Undeformed, at rest.
Workload at_rest(std::uint64_t seed) {
  Workload work = elastic(seed);
  for (Vec3& v : work.state.particles.v) v.setZero();
  for (Mat3& F_E : work.state.particles.F_E) F_E.setIdentity();
  return work;
}

/// One half rests, the other, a block's width away, moves and is deformed.
Workload half_at_rest(std::uint64_t seed) {
  Workload work = elastic(seed);
  Particles& p = work.state.particles;
  const double border = middle(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.x[i][0] > border) {
      p.x[i][0] += border;
    } else {
      p.v[i].setZero();
      p.F_E[i].setIdentity();
    }
  }
  return work;
}

Collider& add(Workload& work, const Shape& shape, double friction) {
  work.scene.colliders.push_back(Collider{});
  Collider& collider = work.scene.colliders.back();
  collider.shape = shape;
  collider.friction = friction;
  return collider;
}

Workload rest_on_floor(std::uint64_t seed) {
  Workload work = at_rest(seed);
  add(work, HalfSpace{Vec3(0, 0, 0), Vec3::UnitZ()}, 0.5);
  return work;
}

/// All of the block is deep in a solid that moves with it.
Workload inside_solid(double friction, Workload work) {
  add(work, HalfSpace{Vec3(0, 0, 100), Vec3::UnitZ()}, friction).velocity =
      work.state.particles.v.front();
  return work;
}

Workload in_rough_solid(std::uint64_t seed) { return inside_solid(0.3, elastic(seed)); }
Workload in_smooth_solid(std::uint64_t seed) { return inside_solid(0, elastic(seed)); }
Workload plastic_in_smooth_solid(std::uint64_t seed) { return inside_solid(0, plastic(seed)); }

Workload over_floor(std::uint64_t seed) {
  Workload work = elastic(seed);
  add(work, HalfSpace{Vec3(0, 0, -1), Vec3::UnitZ()}, 0.3);
  return work;
}

Workload plastic_over_floor(std::uint64_t seed) {
  Workload work = plastic(seed);
  add(work, HalfSpace{Vec3(0, 0, -1), Vec3::UnitZ()}, 0.3);
  return work;
}

/// Floor, wall, ball and a turning roll: out of reach, all of them.
Workload among_four(std::uint64_t seed) {
  Workload work = over_floor(seed);
  add(work, HalfSpace{Vec3(-1, 0, 0), Vec3::UnitX()}, 0.3);
  add(work, Sphere{Vec3(3, 3, 3), 0.5}, 0.3);
  add(work, Cylinder{Vec3(0, 0, -2), Vec3::UnitY(), 0.5, 2}, 0.3).angular_velocity = Vec3(0, 5, 0);
  return work;
}

/// A ball without friction in the middle.
Workload around_smooth_ball(std::uint64_t seed) {
  Workload work = elastic(seed);
  add(work, Sphere{Vec3::Constant(middle(work.state.particles)), 0.4}, 0).velocity =
      work.state.particles.v.front();
  return work;
}

/// The half with large x is shifted: empty space between two blocks.
Workload two_blocks(std::uint64_t seed) {
  Workload work = elastic(seed);
  Particles& p = work.state.particles;
  const double border = middle(p);
  for (Vec3& x : p.x)
    if (x[0] > border) x += Vec3::Constant(2);
  return work;
}

/// Ten slices, each shifted against the one before.
Workload staircase(std::uint64_t seed) {
  Workload work = elastic(seed);
  Particles& p = work.state.particles;
  const double width = 2 * middle(p);
  for (Vec3& x : p.x) {
    const double slice = std::floor(10 * x[0] / width);
    x += slice * Vec3(0, 0.2, 0.2);
  }
  return work;
}

Workload one_flies_off(std::uint64_t seed) {
  Workload work = elastic(seed);
  work.state.particles.x.back() += Vec3::Constant(3);
  return work;
}

/// Half of the particles are of a second material, the same snow by another name.
Workload two_materials(std::uint64_t seed) {
  Workload work = elastic(seed);
  work.scene.materials.push_back(work.scene.materials.front());
  Particles& p = work.state.particles;
  const double border = middle(p);
  for (std::size_t i = 0; i < p.size(); ++i) p.material[i] = p.x[i][0] < border ? 0 : 1;
  return work;
}

}  // namespace

const std::vector<SkipCase>& skip_cases() {
  static const std::vector<Situation> little_flow = {
      {"elastic", elastic}, {"a tenth yields", tenth_plastic}, {"half yields", half_plastic}};
  static const std::vector<Situation> anything = {
      {"elastic", elastic}, {"plastic", plastic}, {"around a ball", around_smooth_ball}};
  static const std::vector<Situation> all_flow = {{"plastic", plastic}};
  static const std::vector<SkipCase> cases = {
      {"box", little_flow, all_flow},
      {"hardening", little_flow, all_flow},
      {"plastic", little_flow, all_flow},
      {"contact",
       {{"over a floor", over_floor},
        {"plastic, over a floor", plastic_over_floor},
        {"among four colliders", among_four}},
       {{"inside a solid", in_rough_solid}}},
      {"friction",
       {{"inside a smooth solid", in_smooth_solid},
        {"plastic, inside a smooth solid", plastic_in_smooth_solid},
        {"around a smooth ball", around_smooth_ball}},
       {{"inside a rough solid", in_rough_solid}}},
      {"rest",
       {{"at rest", at_rest},
        {"half at rest", half_at_rest},
        {"at rest on a floor", rest_on_floor}},
       {{"elastic", elastic}}},
      {"empty",
       {{"two blocks", two_blocks}, {"staircase", staircase}, {"one flies off", one_flies_off}},
       {{"elastic", elastic}}},
      {"material", anything, {{"two materials", two_materials}}},
      {"volumes", anything, {}},
      {"fields", anything, {}},
      {"all", anything, {}},
  };
  return cases;
}

}  // namespace firn::bench
