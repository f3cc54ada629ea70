// SPDX-License-Identifier: BSD-3-Clause
#include "verification/studies/float_drift.hpp"

#include <algorithm>
#include <cmath>

#include "verification/support/scenes.hpp"

namespace firn::studies {

namespace {

void advance(const Subject& subject, Solver& solver, const Scene& scene, int steps) {
  for (int i = 0; i < steps; ++i) subject.step(solver, scene.time.step);
}

State after(const Subject& subject, const Scene& scene, const State& initial, int steps) {
  const auto solver = subject.create();
  solver->load(scene, initial);
  advance(subject, *solver, scene, steps);
  State state;
  solver->store(state);
  return state;
}

}  // namespace

Vec3 creep(const Subject& subject, const Scene& scene, State initial, const Vec3& v, int steps,
           double distance) {
  Particles& p = initial.particles;
  for (std::size_t at = 0; at < p.size(); ++at) {
    p.v[at] = v;
    p.F_E[at].setIdentity();
  }
  const State state = after(subject, scene, initial, steps);
  Vec3 moved = Vec3::Zero();
  for (std::size_t at = 0; at < p.size(); ++at) moved += state.particles.x[at] - p.x[at];
  Vec3 off = moved / static_cast<double>(p.size()) / distance;
  for (int axis = 0; axis < 3; ++axis)
    if (v[axis] != 0) off[axis] -= 1;
  return off;
}

double small_strain(const Subject& subject, const Scene& scene, const Stretch& stretch) {
  const int n = stretch.cells;
  const Vec3 middle = stretch.corner + Vec3::Constant(0.5 * n * scene.grid.spacing);
  State initial = fixtures::lattice_block(scene, {n, n, n}, stretch.corner);
  Particles& p = initial.particles;
  for (std::size_t at = 0; at < p.size(); ++at)
    p.v[at] = Vec3(stretch.rate * (p.x[at].x() - middle.x()), 0, 0);
  const State state = after(subject, scene, initial, stretch.steps);
  double strain = 0;
  int count = 0;
  for (std::size_t at = 0; at < p.size(); ++at) {
    if ((p.x[at] - middle).cwiseAbs().maxCoeff() > stretch.half_width) continue;
    strain += state.particles.F_E[at](0, 0) - 1;
    ++count;
  }
  const double exact = stretch.steps * (stretch.rate * scene.time.step);
  return std::abs(strain / count / exact - 1);
}

double far_away(const Subject& subject, Scene scene, State state, double distance) {
  const double scale = 0.0625 / scene.grid.spacing;
  scene.grid.spacing = 0.0625;
  State states[2];
  for (const int far : {0, 1}) {
    State initial = state;
    for (Vec3& x : initial.particles.x)
      for (int axis = 0; axis < 3; ++axis)
        x[axis] = std::round(scale * x[axis] * 0x1p24) * 0x1p-24 + far * distance;
    states[far] = after(subject, scene, initial, 100);
  }
  double worst = 0;
  for (std::size_t at = 0; at < state.particles.size(); ++at)
    worst = std::max(worst, (states[0].particles.F_E[at] - states[1].particles.F_E[at]).norm());
  return worst;
}

std::vector<std::pair<int, double>> drift(const Subject& subject, Solver& reference,
                                          const Scene& scene, const State& state) {
  const auto solver = subject.create();
  reference.load(scene, state);
  solver->load(scene, state);
  std::vector<std::pair<int, double>> drifted;
  State mine, theirs;
  int done = 0;
  for (const int steps : {10, 30, 100, 300, 1000}) {
    advance(subject, reference, scene, steps - done);
    advance(subject, *solver, scene, steps - done);
    done = steps;
    reference.store(theirs);
    solver->store(mine);
    double off = 0, size = 0;
    for (std::size_t at = 0; at < state.particles.size(); ++at) {
      off += (mine.particles.v[at] - theirs.particles.v[at]).squaredNorm();
      size += theirs.particles.v[at].squaredNorm();
    }
    drifted.emplace_back(steps, std::sqrt(off / size));
  }
  return drifted;
}

}  // namespace firn::studies
