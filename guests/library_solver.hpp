// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Firn's side of a shared library that runs in the process of `firn-guest`.

#include <memory>
#include <string>

#include "firn/registry.hpp"
#include "guests/runner_process.hpp"

namespace firn::guest {

class LibrarySolver : public Solver {
 public:
  LibrarySolver(std::string path, const SolverOptions& options);
  ~LibrarySolver() override;

  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene& scene, const State& state) override;
  TimeStep choose_time_step() override;
  StepReport advance_through(Stage last, double dt) override;
  void store(State& state) const override;
  Diagnostics diagnostics(const Scene& scene) const override;

 private:
  void start();
  void take_traits(Packet answer);
  Packet ask(const Packet& question, Stage stage) const;
  [[noreturn]] void blame(const ChannelError& error, Stage stage) const;
  [[noreturn]] void fail(Stage stage, const std::string& what) const;

  std::string path_;
  SolverOptions options_;
  SolverTraits traits_;
  const Scene* scene_ = nullptr;
  std::size_t particles_ = 0;
  Stage next_ = Stage::rasterize;
  bool chooses_time_step_ = false;
  // A guest that misbehaves is ended at once, also from store().
  mutable RunnerProcess process_;
};

}  // namespace firn::guest
