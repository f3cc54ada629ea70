// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/windows.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace firn {

namespace {

/// Particles whose features are counted, all in all: some two seconds of work.
constexpr double particles_looked_at = 2e6;

/// Steps that the scene has, if none is shorter than its longest.
double expected_steps(const Scene& scene) {
  const double dt = scene.time.adaptive ? scene.time.max_step : scene.time.step;
  return std::max(1.0, std::ceil(scene.time.end / dt));
}

/// One step stage by stage, counting; leaves the solver after it.
void step_and_count(const Scene& scene, Solver& solver, const TimeStep& chosen, State& before,
                    State& after, Exercised& exercised) {
  solver.store(before);
  exercised.add_step(chosen.bound);
  for (const Stage stage : all_stages) {
    const StepReport told = solver.advance_through(stage, chosen.dt);
    solver.store(after);
    exercised.add(scene, stage, before, after, told);
    std::swap(before, after);
  }
}

/// The scene from its start, one step of the scene's rule after the other.
class Scout {
 public:
  Scout(const Scene& scene, const State& initial, Solver& solver)
      : scene_(scene), solver_(solver), step_(initial.step), time_(initial.time) {
    solver.load(scene, initial);
  }

  /// The last step may end a rounding before the scene's end.
  bool at_end() const { return time_ >= scene_.time.end * (1 - 1e-12); }
  std::int64_t step() const { return step_; }
  double share() const { return scene_.time.end > 0 ? std::min(1.0, time_ / scene_.time.end) : 1; }

  void advance(Exercised* exercised) {
    const TimeStep chosen = solver_.choose_time_step();
    if (exercised != nullptr)
      step_and_count(scene_, solver_, chosen, before_, after_, *exercised);
    else
      solver_.step(chosen.dt);
    time_ += chosen.dt;
    ++step_;
  }

 private:
  const Scene& scene_;
  Solver& solver_;
  State before_, after_;
  std::int64_t step_;
  double time_;
};

}  // namespace

std::vector<std::int64_t> choose_steps(const std::vector<Sighting>& sightings, std::int64_t steps) {
  std::set<std::size_t> chosen;
  std::set<Feature> covered;
  const auto wanted = std::min<std::size_t>(static_cast<std::size_t>(steps), sightings.size());
  Exercised all;
  for (const Sighting& s : sightings) all.add(s.exercised);
  while (chosen.size() < wanted) {
    std::size_t best = sightings.size();
    int best_new = 0;
    double best_share = 0;
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      int fresh = 0;
      double share = 0;
      for (const FeatureName& name : feature_names()) {
        const std::int64_t count = sightings[k].exercised[name.feature];
        if (count == 0 || covered.count(name.feature) > 0) continue;
        ++fresh;
        share += static_cast<double>(count) / static_cast<double>(all[name.feature]);
      }
      if (fresh > best_new || (fresh == best_new && fresh > 0 && share > best_share)) {
        best = k;
        best_new = fresh;
        best_share = share;
      }
    }
    if (best == sightings.size()) break;  // every feature is covered
    chosen.insert(best);
    for (const FeatureName& name : feature_names())
      if (sightings[best].exercised[name.feature] > 0) covered.insert(name.feature);
  }
  // What is left goes into the middle of the longest gaps.
  while (chosen.size() < wanted) {
    std::size_t best = 0, longest = 0;
    std::size_t from = 0;
    std::set<std::size_t> ends = chosen;
    ends.insert(sightings.size());
    for (const std::size_t end : ends) {
      if (end - from > longest) {
        longest = end - from;
        best = from + (end - from) / 2;
      }
      from = end + 1;
    }
    chosen.insert(best);
  }
  std::vector<std::int64_t> result;
  for (const std::size_t k : chosen) result.push_back(sightings[k].step);
  return result;
}

WindowPlan plan_windows(const Scene& scene, const State& initial, Solver& scout,
                        const WindowOptions& options) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  WindowPlan plan;
  const double particles = static_cast<double>(initial.particles.size());
  const auto stride = static_cast<std::int64_t>(
      std::max(1.0, std::ceil(expected_steps(scene) * particles / particles_looked_at)));

  std::vector<Sighting> sightings;
  Scout first(scene, initial, scout);
  while (!first.at_end()) {
    // The second pass takes part of the time, too.
    if (seconds() > 0.7 * options.budget) break;
    if (options.progress && !options.progress(0.7 * first.share())) {
      plan.interrupted = true;
      break;
    }
    const bool look = plan.passed % stride == 0;
    if (look) sightings.push_back({first.step(), {}});
    first.advance(look ? &sightings.back().exercised : nullptr);
    ++plan.passed;
  }
  plan.complete = first.at_end();
  plan.looked_at = static_cast<std::int64_t>(sightings.size());
  for (const Sighting& s : sightings) plan.seen.add(s.exercised);

  Scout second(scene, initial, scout);
  for (const std::int64_t step : choose_steps(sightings, options.steps)) {
    while (second.step() < step) {
      if (options.progress && !options.progress(0.7 + 0.3 * second.share())) {
        plan.interrupted = true;
        return plan;
      }
      second.advance(nullptr);
    }
    CheckWindow window;
    scout.store(window.start);
    window.start.grid.clear();
    plan.windows.push_back(std::move(window));
  }
  return plan;
}

}  // namespace firn
