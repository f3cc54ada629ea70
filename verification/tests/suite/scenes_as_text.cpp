// SPDX-License-Identifier: BSD-3-Clause
/// Every scene that the suite hands over can be written down and read again: a guest is given the
/// scene's text, and its own parser may refuse what Firn's refuses. Fails naming the first scene
/// that does not read back.

#include <cstdio>
#include <set>
#include <string>

#include "firn/error.hpp"
#include "io/scene/scene_file.hpp"
#include "solvers/solvers.hpp"
#include "verification/suite/run.hpp"
#include "verification/suite/subject.hpp"

namespace {

using namespace firn;

struct Scenes {
  std::set<std::string> seen;
  std::string first_fault;
} scenes;

/// A solver whose scenes are noted on their way in.
class Noting final : public Solver {
 public:
  explicit Noting(std::unique_ptr<Solver> solver) : solver_(std::move(solver)) {}
  const SolverTraits& traits() const override { return solver_->traits(); }
  void load(const Scene& scene, const State& state) override {
    std::string text;
    try {
      text = resolved_toml(scene);
      if (scenes.seen.insert(text).second) parse_scene(text, "scene", ".");
    } catch (const InputError& error) {
      if (scenes.first_fault.empty()) scenes.first_fault = error.what() + ("\n" + text);
    }
    solver_->load(scene, state);
  }
  TimeStep choose_time_step() override { return solver_->choose_time_step(); }
  StepReport advance_through(Stage last, double dt) override {
    return solver_->advance_through(last, dt);
  }
  StepReport step(double dt) override { return solver_->step(dt); }
  void store(State& state) const override { solver_->store(state); }
  std::size_t restart_size() const override { return solver_->restart_size(); }
  void store_restart(std::span<std::byte> bytes) const override { solver_->store_restart(bytes); }
  void load_restart(std::span<const std::byte> bytes) override { solver_->load_restart(bytes); }

 private:
  std::unique_ptr<Solver> solver_;
};

}  // namespace

int main() {
  Registry registry;
  register_solvers(registry);
  suite::Subject subject;
  subject.solver = "optimized";
  subject.create = [&](int) { return std::make_unique<Noting>(registry.create("optimized", {})); };
  subject.create_reference = [&] { return registry.create(reference_name, {}); };
  suite::set_subject(subject);
  suite::RunOptions options;
  options.quiet = true;
  suite::run(options);
  std::printf("%zu scenes\n", scenes.seen.size());
  if (!scenes.first_fault.empty()) std::printf("%s\n", scenes.first_fault.c_str());
  return scenes.seen.size() > 50 && scenes.first_fault.empty() ? 0 : 1;
}
