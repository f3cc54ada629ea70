// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A solver that is a command: it reads a trajectory, takes steps, writes a trajectory.

#include <filesystem>
#include <string>
#include <vector>

#include "firn/registry.hpp"

namespace firn::guest {

/// Each step runs the command once: {in} is a trajectory whose last frame is the
/// state and whose attribute `scene` states a fixed step (the Δt to take), {out}
/// the file to write, {steps} how many steps (1). Stops only between steps. The
/// file is read in a separate process, because HDF5 may crash on invalid bytes.
class CommandSolver : public Solver {
 public:
  CommandSolver(const std::string& command, const SolverOptions& options);
  ~CommandSolver() override;

  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override;
  TimeStep choose_time_step() override;
  StepReport advance_through(Stage last, double dt) override;
  void store(State& state) const override { state = state_; }
  Diagnostics diagnostics(const Scene& scene) const override;

 private:
  void write_input(double dt) const;
  void run_command() const;
  void read_output(double dt);
  State read_trajectory(const std::filesystem::path& path) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::vector<std::string> words_;
  double time_limit_;  ///< for one answer [s]
  SolverTraits traits_;
  const Scene* scene_ = nullptr;
  State state_;
  std::filesystem::path folder_;  ///< of its own, removed at the end
};

/// The words of a command, separated by blanks; single or double quotes keep blanks in a word.
/// Throws InputError if a quote is not closed.
std::vector<std::string> split_command(const std::string& command);

}  // namespace firn::guest
