// SPDX-License-Identifier: BSD-3-Clause
/// firn check: a solver against the reference, stage by stage.

#include "verification/check/check.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/core.h>
#include <unistd.h>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/verbs.hpp"
#include "firn/error.hpp"
#include "io/output_path.hpp"
#include "io/trajectory/point_frames.hpp"
#include "verification/check/check_set.hpp"
#include "verification/check/error_map.hpp"
#include "verification/check/windows.hpp"
#include "verification/studies/standard_set.hpp"

namespace firn::cli {

namespace {

struct CheckArguments {
  std::shared_ptr<SceneOption> scene;
  std::shared_ptr<SolverOption> solver;
  std::string against = reference_name;
  std::int64_t steps = 10;
  std::int64_t start_step = -1;  ///< −1: steps are chosen
  double budget = 30;
  std::string mode = "lockstep";
  std::vector<std::string> require;
  std::string dump;
  bool json = false, all = false, force = false;
};

CheckMode mode_from_name(const std::string& name) {
  if (name == "lockstep") return CheckMode::lockstep;
  if (name == "free") return CheckMode::free_running;
  throw InputError("--mode", "unknown mode", name, "lockstep or free");
}

/// What is compared: a scene and the states to start from.
struct Subject {
  Scene scene;
  std::vector<CheckWindow> windows;
  bool interrupted = false;
};

class CheckVerb {
 public:
  CheckVerb(const CheckArguments& arguments, Context& context)
      : arguments_(arguments), context_(context) {
    if (arguments.steps < 1)
      throw InputError("--steps", "number of steps", std::to_string(arguments.steps), "at least 1");
    if (arguments.start_step < -1)
      throw InputError("--start-step", "step to start from", std::to_string(arguments.start_step),
                       "at least 0");
    if (!(arguments.budget > 0))
      throw InputError("--budget", "seconds", fmt::format("{}", arguments.budget), "above 0");
    options_.mode = mode_from_name(arguments.mode);
    for (const std::string& key : arguments.require) requirement_of(key);
    if (!arguments.dump.empty()) {
      if (arguments.scene->name.empty())
        throw InputError("--dump", "scene of the map", "none", "SCENE");
      if (options_.mode != CheckMode::lockstep)
        throw InputError("--dump", "mode", arguments.mode, "lockstep");
      options_.error_map = &map_;
    }
  }

  int run() {
    if (arguments_.scene->name.empty()) return run_standard_set();
    const Subject subject = named_subject();
    if (!arguments_.dump.empty()) require_safe_dump(subject.scene);
    CheckReport report;
    if (subject.interrupted) {
      report.scene = subject.scene.name;
      report.interrupted = true;
    } else {
      report = check(subject);
    }
    report.command = command(arguments_.scene->name);
    if (!map_.frames().empty()) write_map();
    fmt::print("{}\n", arguments_.json ? to_json(report) : to_table(report, style()));
    return status(report.valid(), report.interrupted, report.exercised);
  }

 private:
  int run_standard_set() {
    CheckSet set;
    for (studies::StandardCase& each : studies::standard_set()) {
      if (context_.stop.load()) break;
      try {
        set.reports.push_back(check({std::move(each.scene), std::move(each.windows)}));
        set.reports.back().scene = each.name;
        set.reports.back().command = command(each.name);
      } catch (const InputError& error) {
        // A guest need not take every kind of scene; a wrong option would fail with every one.
        set.does_not_apply.push_back({each.name, error.what()});
      }
    }
    set.interrupted = context_.stop.load();
    set.command = command("");
    if (set.reports.empty() && !set.does_not_apply.empty())
      throw InputError("--solver", "takes no scene of the standard set", arguments_.solver->name,
                       set.does_not_apply.front().reason);
    fmt::print("{}\n", arguments_.json ? to_json(set) : to_table(set, style()));
    return status(set.valid(), set.interrupted, set.exercised());
  }

  /// The scene or standard case of the command line, and the steps to compare.
  Subject named_subject() {
    for (studies::StandardCase& each : studies::candidates())
      if (each.name == arguments_.scene->name) {
        each.scene.name = each.name;
        return {std::move(each.scene), std::move(each.windows)};
      }
    Subject subject{arguments_.scene->read(), {}};
    const State initial = initial_state(subject.scene);
    if (options_.mode == CheckMode::free_running || arguments_.start_step >= 0)
      add_given_window(subject, initial);
    else
      add_chosen_windows(subject, initial);
    return subject;
  }

  void add_given_window(Subject& subject, const State& initial) {
    const auto reference = make_reference(initial.particles.size());
    State start = initial;
    ProgressBar progress("running " + subject.scene.name);
    reference->load(subject.scene, initial);
    for (std::int64_t n = 0; n < arguments_.start_step; ++n) {
      progress.show(static_cast<double>(n) / static_cast<double>(arguments_.start_step),
                    fmt::format("step {} of {}", n, arguments_.start_step));
      if (context_.stop.load()) {
        subject.interrupted = true;
        return;
      }
      reference->step(reference->choose_time_step().dt);
    }
    if (arguments_.start_step > 0) reference->store(start);
    start.grid.clear();
    subject.windows.push_back({std::move(start), arguments_.steps});
  }

  void add_chosen_windows(Subject& subject, const State& initial) {
    ProgressBar progress("looking through " + subject.scene.name);
    WindowOptions options;
    options.steps = arguments_.steps;
    options.budget = arguments_.budget;
    options.progress = [&](double done) {
      progress.show(done, "for what happens in it");
      return !context_.stop.load();
    };
    WindowPlan plan =
        plan_windows(subject.scene, initial, *make_scout(subject.scene, initial), options);
    subject.windows = std::move(plan.windows);
    subject.interrupted = plan.interrupted;
    if (!plan.complete && !plan.interrupted)
      fmt::print(stderr,
                 "firn: chose among the first {} steps of {}: the rest did not fit into {} s "
                 "(--budget)\n",
                 plan.passed, subject.scene.name, arguments_.budget);
  }

  CheckReport check(const Subject& subject) {
    const std::size_t particles = subject.windows.front().start.particles.size();
    const auto solver = arguments_.solver->create(context_.registry, particles);
    const auto reference = make_reference(particles);
    std::int64_t steps = 0;
    for (const CheckWindow& window : subject.windows) steps += window.steps;
    ProgressBar progress("checking " + subject.scene.name);
    options_.progress = [&](std::int64_t done) {
      progress.show(static_cast<double>(done) / static_cast<double>(steps),
                    fmt::format("step {} of {}", done, steps));
      return !context_.stop.load();
    };
    return run_check(subject.scene, subject.windows, *reference, *solver, options_);
  }

  void require_safe_dump(const Scene& scene) const {
    std::vector<std::string> inputs = files_of_solver(arguments_.solver->name);
    inputs.insert(inputs.end(), scene.files.begin(), scene.files.end());
    require_no_input(arguments_.dump, inputs);
    require_replaceable(arguments_.dump, OutputKind::error_map, arguments_.force);
  }

  void write_map() const {
    std::vector<PointFrame> frames;
    for (const ErrorFrame& each : map_.frames()) {
      PointFrame frame{each.time, each.point, {}};
      PointArray id{"id", 1, {}}, node{"node", 3, {}}, worst{"worst", 1, {}};
      for (const std::int64_t value : each.id) id.values.push_back(static_cast<float>(value));
      for (const NodeIndex& n : each.node)
        for (const std::int32_t index : {n.i, n.j, n.k})
          node.values.push_back(static_cast<float>(index));
      worst.values.resize(each.point.size());
      frame.arrays = {id, node};
      for (const ErrorColumn& column : each.columns) {
        for (std::size_t k = 0; k < worst.values.size(); ++k)
          worst.values[k] = std::max(worst.values[k], column.in_bounds[k]);
        frame.arrays.push_back({column.name, 1, column.in_bounds});
      }
      frame.arrays.push_back(worst);
      // A step in which the subject failed lacks the rows behind the failure.
      if (frames.empty() || frame.arrays.size() == frames.front().arrays.size())
        frames.push_back(std::move(frame));
    }
    write_point_frames(arguments_.dump, "firn-errors", frames);
    fmt::print(stderr, "firn: {}: errors of {} steps, in units of the bound\n", arguments_.dump,
               frames.size());
  }

  std::unique_ptr<Solver> make_reference(std::size_t particles) const {
    SolverOptions options;
    options.threads = arguments_.solver->settings(particles).threads;
    return context_.registry.create(arguments_.against, options);
  }

  /// The solver that looks through a scene: a quick one that takes it.
  std::unique_ptr<Solver> make_scout(const Scene& scene, const State& initial) const {
    SolverOptions options;
    options.threads = threads_worth_having(initial.particles.size());
    for (const SolverEntry& entry : context_.registry.entries()) {
      auto solver = entry.create(options);
      const SolverTraits& traits = solver->traits();
      if (traits.pace == Pace::fast && traits.precision == Precision::float64 &&
          (scene.semi_implicit() ? traits.semi_implicit : traits.explicit_euler))
        return solver;
    }
    return context_.registry.create(reference_name, options);
  }

  /// What repeats this check, with the options that matter.
  std::string command(const std::string& scene) const {
    const SolverOption& solver = *arguments_.solver;
    std::string text = "firn check";
    const auto add = [&](const std::string& words) { text.append(" ").append(words); };
    if (!scene.empty()) add(shell_word(scene));
    if (arguments_.scene->scale != 1) add(fmt::format("--scale {}", arguments_.scene->scale));
    add("--solver " + shell_word(solver.name));
    if (solver.precision != "double") add("--precision " + solver.precision);
    if (arguments_.against != reference_name) add("--against " + shell_word(arguments_.against));
    if (scene.empty()) return text;
    add(fmt::format("--steps {}", arguments_.steps));
    if (arguments_.start_step >= 0) add(fmt::format("--start-step {}", arguments_.start_step));
    if (arguments_.mode != "lockstep") add("--mode " + arguments_.mode);
    return text;
  }

  TableStyle style() const {
    const char* no_colour = std::getenv("NO_COLOR");
    const bool colour = isatty(STDOUT_FILENO) != 0 && (no_colour == nullptr || *no_colour == '\0');
    return {arguments_.all, colour};
  }

  int status(bool valid, bool interrupted, const Exercised& exercised) const {
    if (interrupted) return exit_interrupted;
    bool lacks = false;
    for (const std::string& key : arguments_.require)
      if (!met(requirement_of(key), exercised)) {
        fmt::print(stderr, "firn: --require {}: no compared step has it\n", key);
        lacks = true;
      }
    return valid && !lacks ? exit_done : exit_failed;
  }

  const CheckArguments& arguments_;
  Context& context_;
  CheckOptions options_;
  ErrorMap map_;
};

}  // namespace

void add_check(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "check",
      "compares a solver with the reference, stage by stage, and names the first stage that "
      "differs; without SCENE in the standard set of small states, in which every stage has work "
      "to do");
  auto arguments = std::make_shared<CheckArguments>();
  arguments->scene = add_scene_option(*verb);
  verb->get_option("SCENE")->required(false);
  arguments->solver = add_solver_option(*verb, context.registry, "optimized");
  verb->add_option("--against", arguments->against, "the solver that is taken as right")
      ->capture_default_str();
  verb->add_option("--steps", arguments->steps,
                   "steps to compare; without --start-step they are chosen from the whole scene, "
                   "so that everything that happens in it is compared once")
      ->capture_default_str();
  verb->add_option("--start-step", arguments->start_step,
                   "compare from this step on, to which the reference runs alone");
  verb->add_option("--budget", arguments->budget, "seconds for choosing the steps")
      ->capture_default_str();
  verb->add_option("--require", arguments->require,
                   "comma-separated: exit 1 unless a compared step has it, such as plastic, "
                   "contact, friction, turning, periodic, materials, volumes, solve")
      ->delimiter(',');
  verb->add_option("--mode", arguments->mode,
                   "lockstep: each stage starts from the reference's input; free: each solver runs "
                   "on from its own results")
      ->capture_default_str();
  verb->add_option("--dump", arguments->dump,
                   "write the error of every particle and node, in units of its bound, to this "
                   "file for ParaView (.vtkhdf) and for `firn report`");
  add_force_option(*verb, arguments->force);
  verb->add_flag("--all", arguments->all, "show every row of the table");
  verb->add_flag("--json", arguments->json, "print JSON");
  verb->callback([arguments, &context] { context.exit = CheckVerb(*arguments, context).run(); });
}

}  // namespace firn::cli
