// SPDX-License-Identifier: BSD-3-Clause
/// Free running: both solvers start from the same state and go their own way with the
/// reference's Δt.
///
/// How far may they part? Each step adds roundoff of some eps to every quantity, and
/// the dynamics (contact, yielding, colliding lumps) amplify what is there. The
/// amplification is measured, not assumed: a twin of the reference starts with every
/// x_p, v_p and F_E moved by a random 1e-10 (in units of h, of the largest speed, and
/// of 1), and its distance D(t) from the reference gives the growth A(t) = D(t)/1e-10
/// of a perturbation put in at the start. Roundoff put in later has had less time to
/// grow, and the contributions of n steps add up like a random walk: √n A(t) eps for
/// one eps a step. The factor 100 is what a step does put in, the sum of the ten
/// stages' bounds (roundoff.hpp: 32 to 64 eps each, of which most particles see a
/// fraction), and the spread between one twin and another.
///
/// A perturbation that has had no time to grow, or that the dynamics damp, still counts
/// once in full: A ≥ 1 in units of the field's own size.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>

#include "verification/check/fields.hpp"
#include "verification/check/run.hpp"

namespace firn::check {

namespace {

constexpr double twin_perturbation = 1e-10;
constexpr double roundoff_per_step = 100;

/// A number in [−1, 1] from a counter (SplitMix64): the same on every machine.
double noise(std::uint64_t counter) {
  std::uint64_t z = (counter + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  return std::ldexp(static_cast<double>(z >> 11), -52) - 1;
}

double largest_speed(const Particles& particles) {
  double largest = 0;
  for (const Vec3& v : particles.v) largest = std::max(largest, v.norm());
  return largest;
}

State perturbed(const Scene& scene, State state, double dt) {
  Particles& p = state.particles;
  // A scene that starts at rest has the speed of its first step.
  const double speed = std::max(largest_speed(p), dt * scene.gravity.norm());
  for (std::size_t q = 0; q < p.size(); ++q)
    for (int a = 0; a < 3; ++a) {
      const std::uint64_t counter = 5 * (3 * q + static_cast<std::uint64_t>(a));
      p.x[q][a] += twin_perturbation * scene.grid.spacing * noise(counter);
      p.v[q][a] += twin_perturbation * speed * noise(counter + 1);
      for (int b = 0; b < 3; ++b)
        p.F_E[q](a, b) += twin_perturbation * noise(counter + 2 + static_cast<std::uint64_t>(b));
    }
  for (Vec3& x : p.x) x = scene.wrap(x);
  return state;
}

/// D(t)/1e-10 and the field's own size, whichever is larger; per axis for positions,
/// whose size is that of position_scale(). A solver may keep F as F − I, whose rounding is
/// that of a number of size 1.
double growth(const Scene& scene, const State& state, const State& twin, Field field) {
  const bool deformation = field == Field::particle_F_E || field == Field::particle_F_P;
  double distance = 0, size = deformation ? 1 : 0;
  for (std::size_t p = 0; p < length(state, field); ++p)
    for (int c = 0; c < components(field); ++c) {
      const double a = value(state, field, p, c);
      double difference = std::abs(value(twin, field, p, c) - a);
      const double period = field == Field::particle_position ? scene.grid.periodic[c] : 0;
      if (period > 0) difference = std::min(difference, std::abs(period - difference));
      distance = std::max(distance, difference);
      size = std::max(size, field == Field::particle_position
                                ? position_scale(scene, state.particles.x[p])[c]
                                : std::abs(a));
    }
  return std::max(distance / twin_perturbation, size);
}

/// Positions are rounded to 2 eps of their distance from the origin, the twin moved by
/// 1e-10 of h: beyond 50 cells from the origin the former is the larger.
double distance_factor(const Scene& scene, const State& state) {
  double cells = 0;
  for (const Vec3& x : state.particles.x)
    cells = std::max(cells, position_scale(scene, x).maxCoeff() / scene.grid.spacing);
  return std::max(1.0, cells / 50);
}

ErrorBounds uniform_bounds(const Scene& scene, const State& state, const State& twin, double n,
                           double eps) {
  const double allowed = roundoff_per_step * distance_factor(scene, state) * std::sqrt(n) * eps;
  const std::size_t size = state.particles.size();
  const auto all = [&](Field field) {
    return std::vector<double>(size, allowed * growth(scene, state, twin, field));
  };
  ErrorBounds bounds;
  bounds.particle_cause.assign(size, {Cause::Kind::chaos});
  bounds.x.assign(size,
                  Vec3::Constant(allowed * growth(scene, state, twin, Field::particle_position)));
  bounds.v = all(Field::particle_velocity);
  bounds.V_0 = all(Field::particle_volume);
  bounds.F_E = all(Field::particle_F_E);
  bounds.F_P = all(Field::particle_F_P);
  return bounds;
}

/// One step of the reference from a state, which a solver as a function of its state
/// allows at any time.
void advance(const Scene& scene, Solver& reference, State& state, double dt) {
  reference.load(scene, state);
  reference.step(dt);
  reference.store(state);
  state.grid.clear();
}

/// The same stage by stage, which gives the same bits, with the scene's Δt; returns Δt.
double advance_and_count(const Scene& scene, Solver& reference, State& state,
                         Exercised& exercised) {
  reference.load(scene, state);
  const TimeStep chosen = reference.choose_time_step();
  exercised.add_step(chosen.bound);
  State after;
  for (const Stage stage : all_stages) {
    const StepReport told = reference.advance_through(stage, chosen.dt);
    reference.store(after);
    exercised.add(scene, stage, state, after, told);
    std::swap(state, after);
  }
  state.grid.clear();
  return chosen.dt;
}

}  // namespace

void run_free(const Scene& scene, State state, Solver& reference, Solver& subject,
              const CheckOptions& options, Recorder& recorder) {
  const double eps = roundoff(subject.traits().precision).eps;
  recorder.set_step(state.step);
  if (!recorder.guard(Stage::rasterize, Stage::rasterize, [&] { subject.load(scene, state); }))
    return;
  reference.load(scene, state);
  const Stencils no_stencils;
  State twin = perturbed(scene, state, reference.choose_time_step().dt), theirs;
  for (std::int64_t n = 1; n <= options.steps; ++n) {
    recorder.set_step(state.step);
    const double dt = advance_and_count(scene, reference, state, recorder.exercised());
    advance(scene, reference, twin, dt);
    const bool done = recorder.guard(Stage::rasterize, Stage::positions, [&] {
      subject.step(dt);
      subject.store(theirs);
    });
    if (!done) return;
    const auto steps = static_cast<double>(n);
    // Times are sums of n equal roundings.
    if (const auto fault = shape_fault(state, theirs, steps * eps)) {
      recorder.diverged(Stage::rasterize, Stage::positions, {}, *fault);
      return;
    }
    const ErrorBounds bounds = uniform_bounds(scene, state, twin, steps, eps);
    for (const Field field : particle_fields)
      recorder.compare({scene, state, theirs, bounds, no_stencils, state.step - 1},
                       Stage::rasterize, Stage::positions, Stage::positions, field, false);
    recorder.step_done();
    if (options.progress && !options.progress(n)) return;
  }
}

}  // namespace firn::check
