// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A built-in scene run on the reference.

#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "io/scene/scene_file.hpp"
#include "verification/support/builtin_registry.hpp"

namespace firn {

struct SceneRun {
  Scene scene;
  State state;
  std::unique_ptr<Solver> solver;
  double time = 0;  ///< [s]
  std::int64_t steps = 0;

  explicit SceneRun(const std::string& name)
      : scene(find_scene(name)), state(initial_state(scene)) {
    solver = fixtures::make_reference();
    solver->load(scene, state);
  }

  /// Steps until `end`, at most `most_steps` of them.
  void run(double end, std::int64_t most_steps) {
    // A time that sums n rounded steps is off by n·eps at most: half a step is far from it.
    for (; most_steps > 0; --most_steps) {
      const double dt = solver->choose_time_step().dt;
      if (time + dt / 2 >= end) break;
      solver->step(dt);
      time += dt;
      ++steps;
    }
    solver->store(state);
  }
  void run() { run(scene.time.end, 1 << 30); }

  Diagnostics measure() const { return firn::measure(scene, state); }
};

}  // namespace firn
