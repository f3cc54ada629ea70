// SPDX-License-Identifier: BSD-3-Clause
#include "firn/solver.hpp"

namespace firn {

Diagnostics Solver::diagnostics(const Scene& scene) const {
  State state;
  store(state);
  return measure(scene, state);
}

}  // namespace firn
