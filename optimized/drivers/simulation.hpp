// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// One simulation in blocks: all data of the optimized solver, and no code. The two drivers are
/// fused_step() and run_stage(); the other files of this folder each do one thing for both.

#include <vector>

#include "firn/registry.hpp"
#include "optimized/implicit/memory.hpp"
#include "optimized/implicit/solve.hpp"
#include "optimized/passes/contact.hpp"
#include "optimized/passes/kernel_table.hpp"
#include "optimized/skips.hpp"
#include "optimized/store/node_store.hpp"
#include "optimized/store/particle_store.hpp"
#include "optimized/store/thread_memory.hpp"

namespace firn::optimized {

/// What is known of the particles' V_p0. `unknown`: some are 0. `estimated`: by stage 2 of the
/// step under way.
enum class Volumes { known, unknown, estimated };

// clang-format off
/// Three members say that something else is out of date:
///
///   member       | becomes      | where
///   -------------+--------------+-----------------------------------------------------------------
///   stress_stale | true         | load(); load_restart() in step 0; stage 2 estimating V_p0
///                | false        | refresh_stress(); stage 7; load_restart() after step 0
///                | read by      | refresh_stress(), diagnostics()
///   -------------+--------------+-----------------------------------------------------------------
///   volumes      | unknown      | load(), if some V_p0 is 0
///                | estimated    | stage 2, if they are unknown
///                | known        | load(); finish_step(), if they are estimated
///                | read by      | step(): unknown volumes need the staged driver
///                |              | stage 2: estimates them if they are unknown
///                |              | stage 3: fills the tiles again if they are estimated
///                |              | a step that fails: the state is not intact if they are estimated
///   -------------+--------------+-----------------------------------------------------------------
///   entered      | State::next  | load()
///                | rasterize    | finish_step(); a step that fails
///                | read by      | stage 3: fills the tiles unless stage 1 has run here
///                |              | stages 7, 8: pack what they gather unless stage 6 has run here
///
/// The node blocks need no such member: NodeStore::follow() compares generations.
// clang-format on
template <class T>
struct Simulation {
  // Chosen when the solver is made.
  SkipSet skips;
  int threads;
  const KernelTable<T>& kernels;
  ImplicitKernels<T> implicit_kernels;

  // Of the scene, which outlives the simulation.
  const Scene* scene = nullptr;
  std::vector<MaterialConstants<T>> materials{};

  // The state between two stages.
  double time = 0;                ///< start of the step [s]
  double dt = 0;                  ///< of the step under way [s], 0 between steps
  std::int64_t step = 0;          ///< steps completed
  Stage next = Stage::rasterize;  ///< the stage that comes next
  ParticleStore<T> particles{};
  NodeStore<T> nodes{};

  // Of the step under way.
  StepConstants<T> constants{};
  Contacts contacts{};
  ImplicitMemory<T> implicit{};  ///< step 6 of semi-implicit scenes
  SolveReport solved{};          ///< what it took
  std::vector<ThreadMemory<T>> memory{};

  // See the table.
  bool stress_stale = true;
  Volumes volumes = Volumes::known;
  Stage entered = Stage::rasterize;  ///< the first stage of this step that ran here

  bool semi_implicit() const { return scene->semi_implicit(); }
};

}  // namespace firn::optimized
