// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A solver that is a command: it reads a trajectory, takes steps, writes a trajectory.

#include <filesystem>
#include <string>
#include <vector>

#include "firn/registry.hpp"

namespace firn::guest {

/// The exit status by which a command says that it does not do what the scene asks for.
inline constexpr int unsupported_status = 77;

/// Each call runs the command once: {in} is a trajectory whose last frame is the
/// state and whose attribute `scene` states a fixed step (the Δt to take), {out}
/// the file to write, {steps} how many steps to take. Stops only between steps. The
/// file is read in a separate process, because HDF5 may crash on invalid bytes.
/// Exit status `unsupported_status` is Unsupported, with the last line printed as the reason.
class CommandSolver : public Solver {
 public:
  CommandSolver(const std::string& command, const SolverOptions& options);
  ~CommandSolver() override;

  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override;
  TimeStep choose_time_step() override;
  StepReport advance_through(Stage last, double dt) override;
  StepReport step(double dt) override { return steps(1, dt); }
  StepReport steps(std::int64_t count, double dt) override;
  void store(State& state) const override { state = state_; }
  Diagnostics diagnostics(const Scene& scene) const override;

 private:
  void write_input(double dt) const;
  void run_command(std::int64_t steps) const;
  void read_output(std::int64_t steps, double dt);
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
