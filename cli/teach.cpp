// SPDX-License-Identifier: BSD-3-Clause
/// firn teach: records one step of the reference, checks the optimized solver on it, and hands
/// both to the Python package in teach/, which makes the pages.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/python.hpp"
#include "cli/verbs.hpp"
#include "firn/build_info.hpp"
#include "firn/error.hpp"
#include "firn/machine.hpp"
#include "io/output_path.hpp"
#include "teach/exercises.hpp"
#include "teach/lesson_json.hpp"
#include "verification/check/check.hpp"
#include "verification/mutants/mutants.hpp"

namespace firn::cli {

namespace {

struct TeachArguments {
  std::shared_ptr<SceneOption> scene;
  std::string out = "lesson";
  std::optional<std::int64_t> step, particle;
  std::string node;
  bool force = false;
};

/// All of a step goes into a page's data: more particles than a reader could look at.
constexpr std::size_t most_particles = 50000;

NodeIndex node_from_text(const std::string& text) {
  NodeIndex n;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d,%d%c", &n.i, &n.j, &n.k, &rest) != 3)
    throw InputError("--node", "i,j,k", text, "three integers with commas between them");
  return n;
}

/// The optimized solver against the reference on the very step that the lesson shows.
nlohmann::ordered_json checks(const teach::Lesson& lesson, const Registry& registry) {
  auto list = nlohmann::ordered_json::array();
  const SolverEntry* entry = registry.find("optimized");
  if (entry == nullptr) return list;
  const State& start = lesson.record.after[0];
  CheckOptions one_step;
  one_step.steps = 1;
  const auto add = [&](const Scene& scene, Precision precision) {
    SolverOptions options;
    options.precision = precision;
    const auto subject = entry->create(options);
    const auto reference = registry.create(reference_name, {});
    const CheckReport report = run_check(scene, start, *reference, *subject, one_step);
    list.push_back(nlohmann::ordered_json::parse(to_json(report)));
    list.back()["semi_implicit"] = scene.semi_implicit();
  };
  Scene semi_implicit = lesson.scene;
  semi_implicit.integrator.type = IntegratorType::semi_implicit;
  const bool implicit = registry.traits("optimized").semi_implicit;
  for (const Precision precision : entry->precisions) {
    if (implicit || !lesson.scene.semi_implicit()) add(lesson.scene, precision);
    if (implicit && !lesson.scene.semi_implicit()) add(semi_implicit, precision);
  }
  return list;
}

/// The answers, as the mutants tell them.
nlohmann::ordered_json exercises_json() {
  auto list = nlohmann::ordered_json::array();
  for (const teach::Exercise& exercise : teach::exercises())
    for (const Mutant& mutant : all_mutants())
      if (mutant.name == exercise.mutant)
        list.push_back({{"mutant", mutant.name},
                        {"scene", exercise.scene},
                        {"stage", name(mutant.stage)},
                        {"mistake", mutant.mistake},
                        {"origin", mutant.origin}});
  return list;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file)
    throw InputError(path.string(), "file", "cannot be written", "a folder that can be written to");
}

/// The reference compiled to WebAssembly, where the build made one.
std::string web_module() {
  if (const char* path = std::getenv("FIRN_WEB_MODULE"); path != nullptr && *path != '\0')
    return path;
  return FIRN_WEB_MODULE_DEFAULT;
}

int run_teach(const TeachArguments& arguments, Context& context) {
  const Scene scene = arguments.scene->read();
  const std::filesystem::path folder = arguments.out, data = folder / "lesson.json";
  require_no_input(data, scene.files);
  require_replaceable(data, OutputKind::lesson, arguments.force);
  const std::size_t particles = sample_bodies(scene).size();
  if (particles > most_particles)
    throw InputError(arguments.scene->name, "number of particles", std::to_string(particles),
                     "at most " + std::to_string(most_particles) + " on a page");
  teach::LessonOptions options;
  options.step = arguments.step;
  options.particle = arguments.particle;
  if (!arguments.node.empty()) options.node = node_from_text(arguments.node);
  std::optional<Waiting> waiting("recording the lesson");
  const teach::Lesson lesson = teach::make_lesson(scene, options);

  nlohmann::ordered_json json = teach::to_json(lesson);
  json["argument"] = arguments.scene->name;
  json["firn"] = {{"version", build_info().version},
                  {"program", std::filesystem::read_symlink("/proc/self/exe").string()},
                  {"processor", processor_name()}};
  json["checks"] = checks(lesson, context.registry);
  json["exercises"] = exercises_json();

  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw InputError(folder.string(), "folder for the pages", error.message(),
                     "a folder that can be made");
  waiting.reset();
  const bool is_new = !std::filesystem::exists(data, error);
  write_text(data, json.dump());
  std::vector<std::string> words = {"firn_teach",    data.string(),  "-o",
                                    folder.string(), "--web-module", web_module()};
  for (const std::string& file : scene.files) words.insert(words.end(), {"--input", file});
  if (arguments.force) words.push_back("--force");
  const int status = run_python_module(words);
  if (status == exit_bad_input && is_new) std::filesystem::remove(data, error);
  return status;
}

}  // namespace

void add_teach(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "teach",
      "makes HTML pages that explain one time step, stage by stage, on this scene's numbers");
  auto arguments = std::make_shared<TeachArguments>();
  arguments->scene = add_scene_option(*verb);
  arguments->scene->name = "tiny_impact";
  verb->get_option("SCENE")->required(false)->capture_default_str();
  verb->add_option("-o,--out", arguments->out, "folder for the pages")->capture_default_str();
  verb->add_option("--step", arguments->step,
                   "the step to show, counted from 0; default: one with contact and yielding");
  verb->add_option("--particle", arguments->particle, "id of the particle to follow");
  verb->add_option("--node", arguments->node, "node i,j,k to follow");
  add_force_option(*verb, arguments->force);
  verb->callback([arguments, &context] { context.exit = run_teach(*arguments, context); });
}

}  // namespace firn::cli
