// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The scenes of the kill test, the same for the program that is killed and for
/// the one that judges.

#include <string>

#include "verification/support/scenes.hpp"

namespace firn::fixtures {

/// "fixed": 12 steps, 4 frames. "adaptive": 3 frames, Δt falls to a tenth, so that the
/// file has to grow for the rows and shrink in the end.
inline Scene kill_scene(const std::string& kind) {
  if (kind == "fixed") {
    Scene scene = tiny_scene(3);
    scene.time.end = 0.012;
    return scene;
  }
  Scene scene = adaptive_scene(3);
  scene.gravity *= 1000;
  scene.time.end = 0.01;
  scene.time.cfl = 0.12;
  scene.time.frames_per_second = 200;
  return scene;
}

}  // namespace firn::fixtures
