// SPDX-License-Identifier: BSD-3-Clause
#include "web/session.hpp"

#include <Eigen/LU>
#include <cstring>

#include "firn/error.hpp"
#include "reference/reference_solver.hpp"
#include "reference/svd.hpp"

namespace firn::web {

namespace {

Body snowball(const Vec3& center, double radius, std::uint64_t seed) {
  Body body;
  body.shape = Sphere{center, radius};
  body.sampling = Sampling::jittered;
  body.particles_per_cell = 8;
  body.seed = seed;
  body.volumes = VolumeSource::estimated;
  return body;
}

std::array<double, parameter_count> parameters_of(const Scene& scene, double speed) {
  const Material& m = scene.materials.front();
  return {m.youngs_modulus,
          m.poisson_ratio,
          m.density,
          m.hardening,
          m.critical_compression,
          m.critical_stretch,
          scene.flip,
          0,
          scene.time.step,
          -scene.gravity[2],
          scene.colliders.empty() ? 0 : scene.colliders.front().friction,
          scene.grid.spacing,
          speed};
}

}  // namespace

Scene preset_scene(Preset preset) {
  Scene scene;
  scene.grid.spacing = 0.04;
  scene.time.step = 2e-4;
  scene.time.frames_per_second = 250;
  scene.flip = 0.99;
  Material snow;
  snow.name = "snow";
  snow.critical_compression = 5e-2;
  scene.materials = {snow};
  if (preset == Preset::impact) {
    scene.name = "tiny impact";
    scene.time.end = 0.06;
    scene.gravity = Vec3(0, 0, -9.81);
    scene.bodies = {snowball(Vec3(0, 0, 0.2), 0.1, 9)};
    scene.bodies[0].velocity = Vec3(1, 0, -6);
    Collider ground;
    ground.shape = HalfSpace{Vec3(0, 0, 0.007), Vec3::UnitZ()};
    ground.friction = 0.3;
    scene.colliders = {ground};
  } else {
    scene.name = "tiny collision";
    scene.time.end = 0.06;
    scene.bodies = {snowball(Vec3(-0.1, 0, 0.15), 0.07, 1), snowball(Vec3(0.1, 0, 0.18), 0.07, 2)};
    scene.bodies[0].velocity = Vec3(3, 0, 0);
    scene.bodies[1].velocity = Vec3(-3, 0, 0);
  }
  return scene;
}

Session::Session(Preset preset)
    : preset_(preset),
      parameters_(parameters_of(preset_scene(preset), preset == Preset::impact ? 6 : 3)) {
  restart();
}

void Session::set(Parameter parameter, double value) {
  parameters_[static_cast<std::size_t>(parameter)] = value;
}

double Session::get(Parameter parameter) const {
  return parameters_[static_cast<std::size_t>(parameter)];
}

void Session::apply_parameters() {
  Material& m = scene_.materials.front();
  m.youngs_modulus = get(Parameter::youngs_modulus);
  m.poisson_ratio = get(Parameter::poisson_ratio);
  m.hardening = get(Parameter::hardening);
  m.critical_compression = get(Parameter::critical_compression);
  m.critical_stretch = get(Parameter::critical_stretch);
  scene_.flip = get(Parameter::flip);
  scene_.integrator.implicitness = get(Parameter::implicitness);
  scene_.integrator.type = get(Parameter::implicitness) > 0 ? IntegratorType::semi_implicit
                                                            : IntegratorType::explicit_euler;
  scene_.time.step = get(Parameter::time_step);
  scene_.gravity = Vec3(0, 0, -get(Parameter::gravity));
  for (Collider& collider : scene_.colliders) collider.friction = get(Parameter::friction);
}

void Session::restart() {
  scene_ = preset_scene(preset_);
  apply_parameters();
  scene_.materials.front().density = get(Parameter::density);
  scene_.grid.spacing = get(Parameter::spacing);
  const double speed = get(Parameter::speed);
  if (preset_ == Preset::impact) {
    scene_.bodies[0].velocity[2] = -speed;
  } else {
    scene_.bodies[0].velocity[0] = speed;
    scene_.bodies[1].velocity[0] = -speed;
  }
  state_ = initial_state(scene_);
  solver_ = make_reference_solver({});
  solver_->load(scene_, state_);
  error_.clear();
}

bool Session::advance() {
  error_.clear();
  if (state_.next == Stage::rasterize) apply_parameters();
  const double dt = state_.next == Stage::rasterize ? get(Parameter::time_step) : state_.dt;
  bool done = true;
  try {
    solver_->advance_through(state_.next, dt);
  } catch (const SimulationError& failure) {
    error_ = failure.what();
    done = false;
  } catch (const InputError& failure) {
    error_ = failure.what();
    done = false;
  }
  solver_->store(state_);
  return done;
}

Invariants Session::invariants() const {
  Invariants sum;
  const Diagnostics d = measure(scene_, state_);
  sum.mass = d.mass;
  sum.momentum = d.momentum;
  sum.kinetic = d.kinetic_energy;
  sum.elastic = d.elastic_energy;
  sum.gravitational = d.gravitational_energy;
  const Grid& grid = state_.grid;
  const std::vector<Vec3>& v = !grid.v_new.empty()    ? grid.v_new
                               : !grid.v_star.empty() ? grid.v_star
                                                      : grid.v;
  for (std::size_t i = 0; i < v.size(); ++i) {
    sum.grid_mass += grid.m[i];
    sum.grid_momentum += grid.m[i] * v[i];
    sum.grid_kinetic += 0.5 * grid.m[i] * v[i].squaredNorm();
  }
  return sum;
}

std::vector<Strain> Session::strains() const {
  const Particles& p = state_.particles;
  std::vector<Strain> list;
  list.reserve(p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3 sigma = reference::svd(p.F_E[k]).sigma;
    list.push_back({p.F_E[k].determinant(), p.F_P[k].determinant(), sigma[2], sigma[0]});
  }
  return list;
}

std::uint64_t Session::hash() const {
  std::uint64_t h = 0xcbf29ce484222325u;
  const auto add = [&h](const double* values, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, values + k, sizeof bits);
      for (int byte = 0; byte < 8; ++byte) {
        h ^= (bits >> (8 * byte)) & 0xff;
        h *= 0x100000001b3u;
      }
    }
  };
  const Particles& p = state_.particles;
  add(&state_.time, 1);
  for (const Vec3& x : p.x) add(x.data(), 3);
  for (const Vec3& v : p.v) add(v.data(), 3);
  add(p.V_0.data(), p.V_0.size());
  for (const Mat3& F : p.F_E) add(F.data(), 9);
  for (const Mat3& F : p.F_P) add(F.data(), 9);
  return h;
}

}  // namespace firn::web
