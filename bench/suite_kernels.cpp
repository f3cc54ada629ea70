// SPDX-License-Identifier: BSD-3-Clause
/// The suite `kernels`: first those below the interface of solvers (bench/kernels), then
/// single stages as kernels: particles that stay in the cache, every instruction set.
/// Each is judged by the lockstep check, with its derived bounds, before it is timed.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>

#include "bench/kernels/kernel_case.hpp"
#include "bench/suites.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"
#include "verification/check/check.hpp"

namespace firn::bench {

namespace {

struct StageKernel {
  const char* name;
  Stage stage;
};

constexpr StageKernel stage_kernels[] = {
    {"P2G, mass and momentum", Stage::rasterize}, {"P2G, forces", Stage::grid_forces},
    {"grid update", Stage::grid_velocities},      {"collision", Stage::grid_collisions},
    {"G2P, gradient and F", Stage::deformation},  {"G2P, velocities", Stage::particle_velocities},
    {"positions and movers", Stage::positions},
};

/// 4096 particles in 512 cells, 0.6 MB in float, all yielding, around a ball that
/// reaches a third of the nodes.
Workload small_block(std::uint64_t seed) {
  Workload work = block(4096, Deformation::plastic, seed);
  work.scene.colliders.push_back(Collider{});
  Collider& ball = work.scene.colliders.back();
  ball.shape = Sphere{Vec3(0.2, 0.2, 0.2), 0.15};
  ball.friction = 0.3;
  ball.velocity = work.state.particles.v.front();
  return work;
}

/// False, and the case invalid, unless every stage of two steps agrees with the reference.
bool agrees(const Registry& registry, const Subject& subject, const Workload& work,
            results::Case& result) {
  const auto reference = registry.create(reference_name, {}), solver = subject.create(registry);
  CheckOptions options;
  options.steps = 2;
  const CheckReport report = run_check(work.scene, work.state, *reference, *solver, options);
  result.validation = "lockstep with the reference, 2 steps: " + std::to_string(report.compared()) +
                      " numbers, largest error " + to_text(report.largest_in_bounds()) +
                      " of its bound";
  if (report.valid()) return true;
  result.status = results::Status::invalid;
  result.message = report.first_divergence->message;
  return false;
}

/// Runs whole steps stage by stage; only the stage in question counts.
void time_stage(const Registry& registry, const Subject& subject, Stage stage, std::uint64_t seed,
                results::Case& result) {
  const Workload work = small_block(seed);
  if (!agrees(registry, subject, work, result)) return;
  const auto solver = subject.create(registry);
  const std::vector<Stage>& stops = solver->traits().stops;
  int left = 0;
  const double dt = work.scene.time.step;
  time_part(
      [&] {
        if (left-- == 0) {
          solver->load(work.scene, work.state);
          solver->step(dt);
          left = work.steps_allowed - 2;
        }
        double seconds = 0;
        for (const Stage stop : stops) {
          const double start = seconds_now();
          solver->advance_through(stop, dt);
          if (stop == stage) seconds = seconds_now() - start;
        }
        return seconds;
      },
      work.state.particles.size(), result);
}

/// The same particles in random order.
Workload shuffled(std::uint64_t seed) {
  Workload work = block(32'768, Deformation::elastic, seed);
  Particles& p = work.state.particles;
  std::mt19937_64 engine(seed);
  for (std::size_t at = p.size(); at > 1; --at) {
    const auto other = static_cast<std::size_t>(engine() % at);
    std::swap(p.x[at - 1], p.x[other]);
    std::swap(p.v[at - 1], p.v[other]);
    std::swap(p.F_E[at - 1], p.F_E[other]);
  }
  return work;
}

/// load(): particles in any order go into blocks, and every number changes its layout.
void time_sort_of(const Registry& registry, const Subject& subject, std::uint64_t seed,
                  results::Case& result) {
  const Workload work = shuffled(seed);
  const auto solver = subject.create(registry);
  solver->load(work.scene, work.state);
  State back;
  solver->store(back);
  const double eps = subject.precision == Precision::float32 ? 0x1p-23 : 0x1p-52;
  const double h = work.scene.grid.spacing;
  double worst = 0;
  for (std::size_t at = 0; at < back.particles.size(); ++at)
    worst = std::max(worst, (back.particles.x[at] - work.state.particles.x[at]).norm() / h / eps);
  // Into the units of a block and back: two roundings of positions up to 40 h away.
  if (!judge(result, "every particle comes back to its place, off by", worst, 160)) return;
  time_body([&] { solver->load(work.scene, work.state); }, work.state.particles.size(), result);
}

/// What a plain code would do: sort (cell, particle) and carry the particles over.
void time_plain_sort(std::uint64_t seed, results::Case& result) {
  const Workload work = shuffled(seed);
  const Particles& p = work.state.particles;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(p.size());
  Particles sorted = p;
  const auto sort = [&] {
    for (std::size_t at = 0; at < p.size(); ++at) {
      const Vec3 cell = p.x[at] / work.scene.grid.spacing;
      const auto index = [&](int axis) {
        return static_cast<std::uint64_t>(std::floor(cell[axis]) + 1024);
      };
      keys[at] = {index(0) << 40 | index(1) << 20 | index(2), static_cast<std::uint32_t>(at)};
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t at = 0; at < p.size(); ++at) {
      const std::size_t from = keys[at].second;
      sorted.x[at] = p.x[from], sorted.v[at] = p.v[from], sorted.m[at] = p.m[from];
      sorted.V_0[at] = p.V_0[from], sorted.F_E[at] = p.F_E[from], sorted.F_P[at] = p.F_P[from];
    }
  };
  sort();
  std::size_t descents = 0;
  for (std::size_t at = 1; at < p.size(); ++at) descents += keys[at].first < keys[at - 1].first;
  result.validation = "places where the cells descend: " + std::to_string(descents) + ", allowed 0";
  if (descents > 0) {
    result.status = results::Status::invalid;
    result.message = result.validation;
    return;
  }
  time_body(sort, p.size(), result);
}

}  // namespace

void plan_kernels_suite(const Registry& registry, const Options& options,
                        std::vector<CasePlan>& plans) {
  const std::uint64_t seed = options.seed;
  plan_weights(seed, plans);
  plan_decompositions(seed, plans);
  plan_constitutive(seed, plans);
  for (const Subject& subject : subjects(registry, options, false)) {
    if (subject.traits.stops.size() < all_stages.size()) continue;  // a guest of whole steps
    const bool has_targets = subject.solver == "optimized";
    const std::string precision(name(subject.precision));
    const std::vector<std::string> targets =
        has_targets ? kernel_targets() : std::vector<std::string>{""};
    for (const std::string& target : targets) {
      for (const StageKernel& kernel : stage_kernels)
        plan_kernel(
            kernel.name, subject.label(), precision, target,
            [=, &registry, stage = kernel.stage](results::Case& r) {
              time_stage(registry, subject, stage, seed, r);
            },
            plans);
    }
    if (has_targets)
      plan_kernel(
          "sort into blocks", subject.label(), precision, "",
          [=, &registry](results::Case& r) { time_sort_of(registry, subject, seed, r); }, plans);
  }
  plan_kernel(
      "sort into blocks", "std::sort by cell", "double", "",
      [=](results::Case& r) { time_plain_sort(seed, r); }, plans);
}

}  // namespace firn::bench
