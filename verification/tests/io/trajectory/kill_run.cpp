// SPDX-License-Identifier: BSD-3-Clause
/// The program that the kill test kills: runs a scene of the tests and says on
/// stdout, one write per frame, which frames are in the file.
///   kill_run fixed|adaptive OUTPUT [steps N] [resume FILE] [precision float]

#include <cstdio>
#include <string>
#include <unistd.h>

#include "simulation/simulate.hpp"
#include "verification/support/ballistic_solver.hpp"
#include "verification/tests/io/trajectory/kill_scenes.hpp"

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const firn::Scene scene = firn::fixtures::kill_scene(argv[1]);
  firn::Precision precision = firn::Precision::float64;
  firn::RunOptions options;
  options.output = argv[2];
  for (int i = 3; i + 1 < argc; i += 2) {
    if (argv[i] == std::string("steps")) options.steps = std::stol(argv[i + 1]);
    if (argv[i] == std::string("resume")) options.resume = argv[i + 1];
    if (argv[i] == std::string("precision")) precision = firn::Precision::float32;
  }
  options.on_frame = [](const firn::FrameReport& frame) {
    const std::string line = std::to_string(frame.frame) + " " + std::to_string(frame.step) + "\n";
    if (write(STDOUT_FILENO, line.data(), line.size()) < 0) _exit(1);
  };
  firn::fixtures::BallisticSolver solver(precision);
  const firn::RunResult result = firn::simulate(scene, solver, options);
  if (!result.message.empty()) std::fprintf(stderr, "%s\n", result.message.c_str());
  return result.exit_status();
}
