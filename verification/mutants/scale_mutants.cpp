// SPDX-License-Identifier: BSD-3-Clause
/// Mistakes that nobody sees in a small scene that runs for a few steps: numbers too short for
/// many particles, steps, materials or colliders, and short cuts for them.

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "firn/error.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// Step 1 sees the first `most` particles of each cell.
void rasterize_few_per_cell(const StageFunction& right, const Step& s, int most) {
  std::map<NodeIndex, int> in_cell;
  Particles some = s.particles;
  for (std::size_t p = 0; p < some.size(); ++p) {
    const Vec3 X = (some.x[p] - s.scene.grid.origin) / s.scene.grid.spacing;
    const auto cell = [&](int a) { return static_cast<std::int32_t>(std::floor(X[a])); };
    if (++in_cell[{cell(0), cell(1), cell(2)}] > most) some.m[p] = 0;
  }
  right({s.scene, s.time, s.dt, s.threads, some, s.stencils, s.grid, s.report});
}

/// The last n mod 8 particles of many are not deformed.
void deform_all_but_the_rest(const StageFunction& right, const Step& s) {
  const Particles before = s.particles;
  right(s);
  const std::size_t n = before.size(), rest = n < 10000 ? 0 : n % 8;
  for (std::size_t p = n - rest; p < n; ++p) {
    s.particles.F_E[p] = before.F_E[p];
    s.particles.F_P[p] = before.F_P[p];
  }
}

/// Counts steps in `bits` bits; where the count is 0 again it is a first step once more, and the
/// volumes are estimated. The memory is the solver's own: each patch() makes a new one.
Patch with_step_counter(int bits) {
  return [=](Stages& stages) {
    const auto steps = std::make_shared<std::uint64_t>(0);
    around(Stage::volumes, [=](const StageFunction& right, const Step& s) {
      const bool again = *steps > 0 && (*steps & ((std::uint64_t{1} << bits) - 1)) == 0;
      ++*steps;
      if (again) std::fill(s.particles.V_0.begin(), s.particles.V_0.end(), 0.0);
      right(s);
    })(stages);
  };
}

/// Every 500 steps the positions pass through single precision.
void sorts_in_float(Stages& stages) {
  const auto steps = std::make_shared<int>(0);
  after(Stage::positions, [=](const Step& s) {
    if (++*steps % 500 == 0)
      for (Vec3& x : s.particles.x) x = x.cast<float>().cast<double>();
  })(stages);
}

/// Colliders are where they were 2^32 ns ago, and as often as that again.
Patch with_clock_in_32_bits(Stage stage) {
  return around(stage, [](const StageFunction& right, const Step& s) {
    const double time = std::fmod(s.time, 0x1p32 * 1e-9);
    right({s.scene, time, s.dt, s.threads, s.particles, s.stencils, s.grid, s.report});
  });
}

/// Gives up after 100 iterations, takes what it has and says that all is well.
void solves_in_100_iterations(const StageFunction& right, const Step& s) {
  Scene other = s.scene;
  other.integrator.max_iterations = std::min(other.integrator.max_iterations, 100);
  for (;;) try {
      right({other, s.time, s.dt, s.threads, s.particles, s.stencils, s.grid, s.report});
      break;
    } catch (const SimulationError&) {
      if (other.integrator.max_iterations == s.scene.integrator.max_iterations ||
          other.integrator.tolerance > 1)
        throw;
      other.integrator.tolerance *= 2;
    }
  s.report.solver_residual = std::min(s.report.solver_residual, s.scene.integrator.tolerance);
}

void add_many_particles(std::vector<Mutant>& list) {
  Adder add(list, Stage::rasterize);
  const auto needs = [](Mutant& mutant, const char* what) {
    mutant.needs = what;
    mutant.check_sees_it = false;
  };
  needs(add("particle_number_in_16_bits", "the loop of step 1 ends at particle 65 536",
            "a short index saves memory",
            from_other_particles(Stage::rasterize,
                                 [](Particles& p, const Step&) {
                                   p.resize(std::min<std::size_t>(p.size(), 1 << 16));
                                 })),
        "more than 65 536 particles");
  needs(add("cell_of_64_particles", "step 1 forgets what is more than 64 particles in a cell",
            "lists of a fixed length",
            around(Stage::rasterize,
                   [](const auto& right, const Step& s) { rasterize_few_per_cell(right, s, 64); })),
        "more than 64 particles in a cell");
  Mutant& rest =
      add("rest_of_the_blocks_forgotten",
          "from 10 000 particles on step 7 works in blocks of 8 and leaves out the rest",
          "a second path for large sets", around(Stage::deformation, deform_all_but_the_rest));
  rest.stage = Stage::deformation;
  needs(rest, "more than 10 000 particles, no multiple of 8");
  needs(add("large_sums_depend_on_threads",
            "from 4096 particles on the order of additions follows the number of threads",
            "small sets are not worth a thread",
            around(Stage::rasterize,
                   [](const StageFunction& right, const Step& s) {
                     right(s);
                     if (s.particles.size() >= 4096 && s.threads > 1) rasterize_by_threads(s);
                   })),
        "more than 4096 particles and several threads");
}

void add_many_steps(std::vector<Mutant>& list) {
  Adder add(list, Stage::volumes);
  for (const int bits : {8, 16}) {
    Mutant& first =
        add(bits == 8 ? "first_step_in_8_bits" : "first_step_in_16_bits",
            bits == 8 ? "step 2 estimates all volumes whenever a count of steps in 8 bits is 0"
                      : "step 2 estimates all volumes whenever a count of steps in 16 bits is 0",
            "a short counter tells the first step", with_step_counter(bits));
    first.needs = bits == 8 ? "257 steps" : "65 537 steps";
    first.check_sees_it = false;
  }
  Mutant& sorted = add("sorted_in_float", "every 500 steps positions pass through single precision",
                       "a sort for locality, taken from a graphics card", sorts_in_float);
  sorted.stage = Stage::positions;
  sorted.needs = "500 steps";
  sorted.check_sees_it = false;
  Mutant& clock = add("clock_in_32_bits", "colliders begin anew every 2^32 ns",
                      "time counted in nanoseconds", [](Stages& stages) {
                        with_clock_in_32_bits(Stage::grid_collisions)(stages);
                        with_clock_in_32_bits(Stage::particle_collisions)(stages);
                      });
  clock.stage = Stage::grid_collisions;
  clock.several = true;
  clock.needs = "a collider that moves, and a time beyond 4.3 s";
  clock.check_sees_it = false;
  Mutant& solve =
      add("solved_in_100_iterations",
          "step 6 gives up after 100 iterations and reports the residual that was asked",
          "a bound for the loop", around(Stage::integration, solves_in_100_iterations));
  solve.stage = Stage::integration;
  solve.needs = "a solve of more than 100 iterations";
  solve.check_sees_it = false;
}

void add_long_lists(std::vector<Mutant>& list) {
  Adder add(list, Stage::grid_forces);
  Mutant& materials = add("material_number_in_8_bits", "step 3 takes material 256 for material 0",
                          "a byte per particle is enough",
                          from_other_particles(Stage::grid_forces, [](Particles& p, const Step&) {
                            for (std::int32_t& m : p.material) m &= 0xFF;
                          }));
  materials.needs = "more than 256 materials";
  materials.check_sees_it = false;
  Mutant& colliders =
      add("colliders_in_a_mask", "step 5 knows the first 32 colliders", "a bit for each in a mask",
          in_other_scene(Stage::grid_collisions, [](Scene& scene, const Step&) {
            if (scene.colliders.size() > 32) scene.colliders.resize(32);
          }));
  colliders.stage = Stage::grid_collisions;
  colliders.needs = "more than 32 colliders";
  colliders.check_sees_it = false;
}

}  // namespace

void add_scale_mutants(std::vector<Mutant>& list) {
  add_many_particles(list);
  add_many_steps(list);
  add_long_lists(list);
}

}  // namespace firn::mutants
