// SPDX-License-Identifier: BSD-3-Clause
/// A few steps of a benchmark block and nothing else, to be counted or profiled from outside:
///
///   cmake --build --preset release --target firn_step_loop
///   FIRN_TARGET=avx2 valgrind --tool=callgrind --toggle-collect='*OptimizedSolver*::step(double)'
///     build/release/bin/firn_step_loop double plastic 64000 6

#include <cstdlib>
#include <iostream>
#include <string>

#include "bench/landing_block.hpp"
#include "bench/workload.hpp"
#include "solvers/solvers.hpp"

int main(int argc, char** argv) {
  using namespace firn;
  const std::string what = argc > 2 ? argv[2] : "";
  if (argc != 5 && !(what == "landing" && argc == 6)) {
    std::cerr
        << "usage: firn_step_loop float|double elastic|plastic PARTICLES STEPS\n"
           "       firn_step_loop float|double landing CELLS STEPS [TOLERANCE]\n"
           "landing: the block of firn bench implicit, E = 1e6, CELLS along an edge; explicit,\n"
           "or with a TOLERANCE semi-implicit in 10 times the steps\n";
    return 2;
  }
  Registry registry;
  register_solvers(registry);
  SolverOptions options;
  options.precision = std::string(argv[1]) == "float" ? Precision::float32 : Precision::float64;

  bench::Workload work;
  if (what == "landing") {
    work.scene = bench::landing_block(1e6, std::atof(argv[3]), 1);
    if (argc == 6) work.scene = bench::in_large_steps(work.scene, 10, std::atof(argv[5]));
    work.state = initial_state(work.scene);
  } else {
    work = bench::block(
        std::strtoul(argv[3], nullptr, 10),
        what == "elastic" ? bench::Deformation::elastic : bench::Deformation::plastic, 1);
  }
  const auto solver = registry.create("optimized", options);
  solver->load(work.scene, work.state);
  std::int64_t iterations = 0;
  for (int i = 0; i < std::atoi(argv[4]); ++i)
    iterations += solver->step(work.scene.time.step).solver_iterations;
  std::cout << work.state.particles.size() << " particles, " << iterations << " iterations\n";
}
