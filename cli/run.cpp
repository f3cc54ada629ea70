// SPDX-License-Identifier: BSD-3-Clause
/// firn run: simulates a scene and writes a trajectory.

#include <filesystem>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/verbs.hpp"
#include "firn/error.hpp"
#include "firn/interruption.hpp"
#include "firn/machine.hpp"
#include "firn/sampling.hpp"
#include "io/one_line.hpp"
#include "simulation/simulate.hpp"
#include "simulation/start_notes.hpp"

namespace firn::cli {

namespace {

struct RunArguments {
  std::shared_ptr<SceneOption> scene;
  std::shared_ptr<SolverOption> solver;
  std::string out, resume;
  std::optional<double> until, frames_per_second;
  std::optional<std::int64_t> steps, resume_frame;
  bool json = false, force = false;
};

/// -o, else the file resumed from, else NAME.vtkhdf in the current folder.
std::filesystem::path output_path(const RunArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  if (!arguments.resume.empty()) return arguments.resume;
  return std::filesystem::path(arguments.scene->name).stem().string() + ".vtkhdf";
}

void check_ranges(const RunArguments& arguments) {
  if (arguments.steps && *arguments.steps < 0)
    throw InputError("--steps", "number of steps", std::to_string(*arguments.steps), "at least 0");
  if (arguments.until && !(*arguments.until >= 0 && *arguments.until < 1e300))
    throw InputError("--until", "end time in s", to_text(*arguments.until), "finite, at least 0");
  if (arguments.frames_per_second &&
      !(*arguments.frames_per_second > 0 && *arguments.frames_per_second < 1e300))
    throw InputError("--frames-per-second", "rate in 1/s", to_text(*arguments.frames_per_second),
                     "finite, above 0");
  if (arguments.resume_frame && arguments.resume.empty())
    throw InputError("--resume-frame", "frame", std::to_string(*arguments.resume_frame),
                     "only together with --resume FILE");
}

RunOptions run_options(const RunArguments& arguments, std::size_t particles, Context& context) {
  RunOptions options;
  options.output = output_path(arguments);
  options.steps = arguments.steps;
  options.until = arguments.until;
  options.frames_per_second = arguments.frames_per_second;
  options.resume = arguments.resume;
  options.resume_frame = arguments.resume_frame;
  options.inputs = files_of_solver(arguments.solver->name);
  options.force = arguments.force;
  options.threads = arguments.solver->settings(particles).threads;
  options.processor = processor_name();
  options.stop = &context.stop;
  return options;
}

std::string_view status_text(RunStatus status) {
  switch (status) {
    case RunStatus::completed: return "completed";
    case RunStatus::interrupted: return "interrupted";
    case RunStatus::failed: return "failed";
  }
  return "";
}

double particle_steps_per_second(const RunResult& result, std::int64_t particles) {
  return result.seconds > 0 ? static_cast<double>(particles) *
                                  static_cast<double>(result.steps_run) / result.seconds
                            : 0;
}

nlohmann::ordered_json bounds_that_held(const RunResult& result) {
  nlohmann::ordered_json object;
  for (std::size_t i = 0; i < result.steps_by_bound.size(); ++i)
    if (result.steps_by_bound[i] > 0)
      object[std::string(name(static_cast<TimeStepBound>(i)))] = result.steps_by_bound[i];
  return object;
}

void print_json(const RunResult& result, const std::filesystem::path& out, std::int64_t particles) {
  const DiagnosticsRow& d = result.diagnostics;
  const auto vec = [](const Vec3& v) { return nlohmann::json{v[0], v[1], v[2]}; };
  nlohmann::ordered_json object = {
      {"status", status_text(result.status)},
      {"message", result.message},
      {"file", one_line(out.string())},
      {"particles", particles},
      {"step", result.step},
      {"time", result.time},
      {"frames", result.frames},
      {"steps_run", result.steps_run},
      {"steps_by_bound", bounds_that_held(result)},
      {"retries", result.retries},
      {"seconds", result.seconds},
      {"particle_steps_per_second", particle_steps_per_second(result, particles)},
      {"diagnostics",
       {{"mass", d.mass},
        {"momentum", vec(d.momentum)},
        {"angular_momentum", vec(d.angular_momentum)},
        {"kinetic_energy", d.kinetic_energy},
        {"elastic_energy", d.elastic_energy},
        {"gravitational_energy", d.gravitational_energy},
        {"center_of_mass", vec(d.center_of_mass)},
        {"max_speed", d.max_speed},
        {"min_J_E", d.min_J_E},
        {"max_J_E", d.max_J_E},
        {"grid_nodes", d.grid_nodes},
        {"solver_iterations", d.solver_iterations},
        {"solver_residual", d.solver_residual}}}};
  fmt::print("{}\n", object.dump(2));
}

void print_summary(const RunResult& result, const std::filesystem::path& out,
                   std::int64_t particles) {
  const DiagnosticsRow& d = result.diagnostics;
  std::string bounds;
  const nlohmann::ordered_json held = bounds_that_held(result);
  for (const auto& [bound, count] : held.items())
    bounds += fmt::format("{}{} {}", bounds.empty() ? "" : ", ", bound, count.get<std::int64_t>());
  fmt::print("{} at step {}, t = {:.6g} s: {} frames in {}\n", status_text(result.status),
             result.step, result.time, result.frames, one_line(out.string()));
  fmt::print(
      "{} particles, {} steps in {:.2f} s, {:.3f} million particle-steps/s; time step by {}\n",
      particles, result.steps_run, result.seconds,
      1e-6 * particle_steps_per_second(result, particles), bounds.empty() ? "-" : bounds);
  fmt::print(
      "mass {:.9g} kg; momentum ({:.6g}, {:.6g}, {:.6g}) kg m/s; energy kinetic {:.6g}, elastic "
      "{:.6g}, gravitational {:.6g} J\n",
      d.mass, d.momentum[0], d.momentum[1], d.momentum[2], d.kinetic_energy, d.elastic_energy,
      d.gravitational_energy);
}

/// The particles at t = 0; a run that begins there tells what is odd about them.
std::size_t count_particles(const Scene& scene, const RunArguments& arguments) {
  std::vector<std::size_t> counts;
  const Particles particles = sample_bodies(scene, counts);
  if (arguments.resume.empty())
    for (const std::string& note : start_notes(scene, particles, counts))
      fmt::print(stderr, "firn: note: {}\n", note);
  return particles.size();
}

int run_run(const RunArguments& arguments, Context& context) {
  check_ranges(arguments);
  std::optional<Waiting> waiting("reading " + one_line(arguments.scene->name, 80));
  const Scene scene =
      arguments.scene->read(arguments.solver->run_bytes_per_particle(context.registry));
  const std::size_t count = count_particles(scene, arguments);
  RunOptions options = run_options(arguments, count, context);
  const auto solver = arguments.solver->create(context.registry, count);

  ProgressBar bar(scene.name);
  const auto particles = static_cast<std::int64_t>(count);
  std::optional<interruption::StepWorthKeeping> keep;
  std::int64_t last_frame_step = -1;
  options.on_frame = [&](const FrameReport& frame) {
    interruption::set_unfinished_file("");
    last_frame_step = frame.step;
  };
  options.on_step = [&](const Progress& p) {
    waiting.reset();
    interruption::set_unfinished_file("");
    // What is in the file cannot be lost.
    if (p.step == last_frame_step)
      keep.reset();
    else if (!keep)
      keep.emplace();
    bar.show(p.fraction, fmt::format("t = {:.4f} s, {:.0f} steps/s", p.time, p.steps_per_second));
  };
  options.on_retry = [&](const Retry& r) {
    bar.finish();
    fmt::print(stderr, "step {} at t = {:.6g} s: {}; attempt {} with dt = {:.3g} s\n", r.step,
               r.time, r.message, r.attempt, r.next_dt);
  };
  interruption::set_unfinished_file(options.output.string() + ".partial");
  const RunResult result = simulate(scene, *solver, options);
  waiting.reset();
  bar.finish();
  if (arguments.json)
    print_json(result, options.output, particles);
  else
    print_summary(result, options.output, particles);
  if (result.status == RunStatus::failed) fmt::print(stderr, "firn: {}\n", result.message);
  return result.exit_status();
}

}  // namespace

void add_run(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("run", "simulates a scene and writes a trajectory");
  auto arguments = std::make_shared<RunArguments>();
  arguments->scene = add_scene_option(*verb);
  verb->add_option("-o,--out", arguments->out,
                   "trajectory to write; default: SCENE.vtkhdf, or the file resumed from");
  arguments->solver = add_solver_option(*verb, context.registry, "optimized");
  verb->add_option("--until", arguments->until, "end at this time [s] instead of the scene's");
  verb->add_option("--steps", arguments->steps,
                   "stop after this many steps; 0: the initial state only");
  verb->add_option("--frames-per-second", arguments->frames_per_second,
                   "frame rate [1/s] instead of the scene's");
  verb->add_option("--resume", arguments->resume,
                   "continue from the last frame of this trajectory; the result equals an "
                   "uninterrupted run bit for bit");
  verb->add_option("--resume-frame", arguments->resume_frame,
                   "continue from this frame instead of the last, counted from 0");
  add_force_option(*verb, arguments->force);
  verb->add_flag("--json", arguments->json, "print the summary as JSON");
  verb->callback([arguments, &context] { context.exit = run_run(*arguments, context); });
}

}  // namespace firn::cli
