// SPDX-License-Identifier: BSD-3-Clause
/// firn check: a solver against the reference, stage by stage.

#include "verification/check/check.hpp"

#include <fmt/core.h>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/verbs.hpp"
#include "firn/error.hpp"

namespace firn::cli {

namespace {

struct CheckArguments {
  std::shared_ptr<SceneOption> scene;
  std::shared_ptr<SolverOption> solver;
  std::string against = reference_name;
  std::int64_t steps = 10;
  std::int64_t start_step = 0;
  std::string mode = "lockstep";
  bool json = false;
};

CheckMode mode_from_name(const std::string& name) {
  if (name == "lockstep") return CheckMode::lockstep;
  if (name == "free") return CheckMode::free_running;
  throw InputError("--mode", "unknown mode", name, "lockstep or free");
}

int run_check_verb(const CheckArguments& arguments, Context& context) {
  if (arguments.steps < 1)
    throw InputError("--steps", "number of steps", std::to_string(arguments.steps), "at least 1");
  if (arguments.start_step < 0)
    throw InputError("--start-step", "step to start from", std::to_string(arguments.start_step),
                     "at least 0");
  CheckOptions options;
  options.mode = mode_from_name(arguments.mode);
  options.steps = arguments.steps;
  options.start_step = arguments.start_step;
  const Scene scene = arguments.scene->read();
  const std::size_t particles = sample_bodies(scene).size();
  const auto subject = arguments.solver->create(context.registry, particles);
  SolverOptions reference_options;
  reference_options.threads = arguments.solver->settings(particles).threads;
  const auto reference = context.registry.create(arguments.against, reference_options);

  ProgressBar progress("checking " + scene.name);
  options.progress = [&](std::int64_t done) {
    progress.show(static_cast<double>(done) / static_cast<double>(arguments.steps),
                  fmt::format("step {} of {}", done, arguments.steps));
    return !context.stop.load();
  };
  const CheckReport report = run_check(scene, *reference, *subject, options);
  progress.finish();
  fmt::print("{}\n", arguments.json ? to_json(report) : to_table(report));
  if (context.stop.load()) return exit_interrupted;
  return report.valid() ? exit_done : exit_failed;
}

}  // namespace

void add_check(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("check",
                                      "compares a solver with the reference, stage by stage, and "
                                      "names the first stage that differs");
  auto arguments = std::make_shared<CheckArguments>();
  arguments->scene = add_scene_option(*verb);
  arguments->solver = add_solver_option(*verb, context.registry, "optimized");
  verb->add_option("--against", arguments->against, "the solver that is taken as right")
      ->capture_default_str();
  verb->add_option("--steps", arguments->steps, "steps to compare")->capture_default_str();
  verb->add_option("--start-step", arguments->start_step,
                   "steps that the reference takes alone before the comparison")
      ->capture_default_str();
  verb->add_option("--mode", arguments->mode,
                   "lockstep: each stage starts from the reference's input; free: each solver runs "
                   "on from its own results")
      ->capture_default_str();
  verb->add_flag("--json", arguments->json, "print JSON");
  verb->callback([arguments, &context] { context.exit = run_check_verb(*arguments, context); });
}

}  // namespace firn::cli
