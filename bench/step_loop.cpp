/// A few steps of a benchmark block and nothing else, to be counted or profiled from outside:
///
///   cmake --build --preset release --target firn_step_loop
///   FIRN_TARGET=avx2 valgrind --tool=callgrind --toggle-collect='*OptimizedSolver*::step(double)'
///     build/release/bin/firn_step_loop double plastic 64000 6

#include <cstdlib>
#include <iostream>
#include <string>

#include "bench/workload.hpp"
#include "cli/builtin_solvers.hpp"

int main(int argc, char** argv) {
  using namespace firn;
  if (argc != 5) {
    std::cerr << "usage: firn_step_loop float|double elastic|plastic PARTICLES STEPS\n";
    return 2;
  }
  Registry registry;
  cli::register_builtin_solvers(registry);
  SolverOptions options;
  options.precision = std::string(argv[1]) == "float" ? Precision::float32 : Precision::float64;
  const bench::Workload work = bench::block(
      std::strtoul(argv[3], nullptr, 10),
      std::string(argv[2]) == "elastic" ? bench::Deformation::elastic : bench::Deformation::plastic,
      1);
  const auto solver = registry.create("optimized", options);
  solver->load(work.scene, work.state);
  for (int i = 0; i < std::atoi(argv[4]); ++i) solver->step(work.scene.time.step);
  std::cout << work.state.particles.size() << " particles\n";
}
