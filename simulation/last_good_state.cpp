// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/last_good_state.hpp"

namespace firn {

void LastGoodState::take(const Solver& solver, std::int64_t step, double time) {
  solver.store(state);
  state.step = step;
  state.time = time;
  state.grid.clear();
  restart.resize(solver.restart_size());
  if (!restart.empty()) solver.store_restart(restart);
  dts.clear();
}

void LastGoodState::load_into(Solver& solver, const Scene& scene) const {
  solver.load(scene, state);
  if (!restart.empty()) solver.load_restart(restart);
}

void LastGoodState::repeat_on(Solver& solver, const Scene& scene) const {
  load_into(solver, scene);
  for (const double dt : dts) solver.step(dt);
}

}  // namespace firn
