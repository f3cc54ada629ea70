// SPDX-License-Identifier: BSD-3-Clause
/// Mistakes of the program around the stages: what it keeps, swallows and chooses.

#include <algorithm>
#include <cmath>
#include <memory>

#include "reference/failure.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// Node masses and momenta are added to those of the last step. The memory is the solver's own:
/// each patch() makes a new one.
void grid_not_cleared(Stages& stages) {
  const auto last = std::make_shared<Grid>();
  after(Stage::rasterize, [last](const Step& s) {
    Grid& grid = s.grid;
    const Grid now = grid;
    for (std::size_t i = 0, j = 0; i < grid.size(); ++i) {
      while (j < last->size() && last->node[j] < grid.node[i]) ++j;
      if (j == last->size() || !(last->node[j] == grid.node[i]) || grid.m[i] == 0) continue;
      const double m = grid.m[i] + last->m[j];
      grid.v[i] = (grid.m[i] * grid.v[i] + last->m[j] * last->v[j]) / m;
      grid.m[i] = m;
    }
    *last = now;
  })(stages);
}

/// Non-finite velocities become zero instead of an error.
void nan_swallowed(Stages& stages) {
  around(Stage::rasterize, [](const StageFunction& right, const Step& s) {
    for (Vec3& v : s.particles.v)
      if (!reference::finite(v)) v.setZero();
    right(s);
  })(stages);
}

/// A particle that would leave the domain stays where it is.
void leaving_ignored(Stages& stages) {
  stages[Stage::positions] = [](const Step& s) {
    for (std::size_t p = 0; p < s.particles.size(); ++p) {
      const Vec3 x = s.scene.wrap(s.particles.x[p] + s.dt * s.particles.v[p]);
      if (reference::inside_domain(s.scene.grid, x)) s.particles.x[p] = x;
    }
  };
}

/// step() leaves out the collisions of particles, the stages do not.
void fused_without_collisions(Stages& stages) {
  auto fused = std::make_shared<Stages>(stages);
  (*fused)[Stage::particle_collisions] = [](const Step&) {};
  stages.whole_step = fused;
}

TimeStep with_soft_snow(const Scene& scene, const Particles& particles) {
  Particles fresh = particles;
  for (Mat3& F_P : fresh.F_P) F_P.setIdentity();
  return reference_stages().choose_time_step(scene, fresh);
}

}  // namespace

void add_program_mutants(std::vector<Mutant>& list) {
  Adder add(list, Stage::rasterize);
  add("grid_not_cleared", "masses and momenta of the last step are still in the grid",
      "memory that is allocated once", grid_not_cleared)
      .several = true;
  Mutant& nan = add("nan_swallowed", "a velocity that is not finite becomes zero, silently",
                    "a guard added after a crash", nan_swallowed);
  nan.needs = "a NaN in the state";
  nan.check_sees_it = false;
  Mutant& fused =
      add("fused_step_without_collisions", "the fast path of whole steps leaves out step 9",
          "two paths, one of them changed", fused_without_collisions);
  fused.several = true;
  fused.stage = Stage::particle_collisions;
  Mutant& leaving = add("leaving_ignored", "a particle that would leave the domain stays, silently",
                        "a clamp added after a crash", leaving_ignored);
  leaving.stage = Stage::positions;
  leaving.needs = "a particle that leaves the domain";
  leaving.check_sees_it = false;
  Mutant& soft = add(
      "time_step_without_hardening", "the elastic limit of Δt uses the sound speed of fresh snow",
      "hardening came later", [](Stages& stages) { stages.choose_time_step = with_soft_snow; });
  soft.several = true;
  soft.needs = "an adaptive time step and hardened snow";
}

}  // namespace firn::mutants
