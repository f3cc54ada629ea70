// SPDX-License-Identifier: BSD-3-Clause
#include "guests/library_solver.hpp"

#include <cmath>
#include <filesystem>

#include "firn/error.hpp"
#include "guests/finite.hpp"
#include "guests/time_step.hpp"
#include "io/one_line.hpp"
#include "io/scene/scene_file.hpp"

namespace firn::guest {

namespace {

/// Sizes that Firn relies on; what is in the arrays is for `check` to judge.
void require_shape(const State& state, std::size_t particles, std::size_t materials,
                   const std::string& who) {
  const Particles& p = state.particles;
  const Grid& g = state.grid;
  const auto require = [&](bool right, const char* what) {
    if (!right) throw ChannelError(ChannelError::Reason::malformed, who + " gave " + what);
  };
  for_each_field(
      [&](const char*, const auto& array) {
        require(array.size() == particles, "particle arrays of the wrong length");
      },
      p);
  for_each_field(
      [&](const char*, const auto& array) {
        require(array.empty() || array.size() == g.size(), "node arrays of different lengths");
      },
      g);
  for (const std::int32_t material : p.material)
    require(material >= 0 && static_cast<std::size_t>(material) < materials,
            "a particle a material that does not exist");
}

}  // namespace

LibrarySolver::LibrarySolver(std::string path, const SolverOptions& options)
    : path_(std::filesystem::absolute(path).string()), options_(options) {
  if (!std::filesystem::is_regular_file(path_))
    throw InputError("--solver", "shared library", path, "an existing file");
  start();
}

LibrarySolver::~LibrarySolver() = default;

void LibrarySolver::start() {
  process_ = RunnerProcess({path_, options_.precision == Precision::float32 ? "float" : "double",
                            std::to_string(options_.threads)});
  try {
    take_traits(ask(Packet(Kind::traits), Stage::rasterize));
  } catch (const SimulationError& error) {
    throw InputError(std::string("--solver: ") + error.what());
  } catch (const ChannelError& error) {
    throw InputError("--solver: guest " + path_ + ": " + error.what());
  }
}

void LibrarySolver::take_traits(Packet answer) {
  SolverTraits traits;
  traits.name = one_line(answer.get_text(), 80);
  traits.precision = options_.precision;
  const bool supports_float = answer.get<std::int32_t>() != 0;
  traits.semi_implicit = answer.get<std::int32_t>() != 0;
  chooses_time_step_ = answer.get<std::int32_t>() != 0;
  std::vector<std::int32_t> stops;
  answer.get_all(stops);
  answer.expect_end();
  if (traits.precision == Precision::float32 && !supports_float)
    throw InputError("--precision", "not supported by guest " + traits.name, "float", "double");
  for (const std::int32_t stop : stops) {
    const bool ascending = traits.stops.empty() || number(traits.stops.back()) < stop;
    if (stop < 1 || stop > stage_count || !ascending)
      throw InputError("guest " + path_, "list of stops", std::to_string(stop),
                       "stages 1 to 10, ascending");
    traits.stops.push_back(static_cast<Stage>(stop));
  }
  if (traits.stops.empty() || traits.stops.back() != Stage::positions)
    throw InputError("guest " + path_, "last stop",
                     traits.stops.empty() ? "none" : std::string(name(traits.stops.back())),
                     "positions");
  traits_ = traits;
}

void LibrarySolver::load(const Scene& scene, const State& state) {
  if (scene.semi_implicit() && !traits_.semi_implicit)
    throw Unsupported("integrator.type", "not supported by guest " + traits_.name, "semi-implicit",
                      "explicit");
  if (!process_.running()) start();  // after a failure: a new one, with nothing of the old
  scene_ = &scene;
  particles_ = state.particles.size();
  next_ = state.next;
  Packet question(Kind::load);
  // Scenes need not come from a file.
  question.put(scene.toml.empty() ? resolved_toml(scene) : scene.toml);
  put_state(question, state);
  ask(question, state.next).expect_end();
}

TimeStep LibrarySolver::choose_time_step() {
  TimeStep chosen;
  if (!scene_->time.adaptive) {
    chosen.dt = scene_->time.step;
    return chosen;
  }
  if (!chooses_time_step_) {
    State state;
    store(state);
    return guest::choose_time_step(*scene_, state.particles);
  }
  try {
    Packet answer = ask(Packet(Kind::choose_time_step), Stage::rasterize);
    chosen.dt = answer.get<double>();
    answer.expect_end();
  } catch (const ChannelError& error) {
    blame(error, Stage::rasterize);
  }
  if (!(chosen.dt > 0) || !std::isfinite(chosen.dt))
    fail(Stage::rasterize, "chose the time step " + to_text(chosen.dt) + " s");
  chosen.bound = TimeStepBound::max_step;
  if (chosen.dt < scene_->time.max_step) chosen.bound = TimeStepBound::cfl;
  return chosen;
}

StepReport LibrarySolver::advance_through(Stage last, double dt) {
  Packet question(Kind::advance);
  question.put(static_cast<std::int32_t>(number(last)));
  question.put(dt);
  StepReport report;
  try {
    Packet answer = ask(question, last);
    report.grid_nodes = answer.get<std::int64_t>();
    report.solver_iterations = answer.get<std::int64_t>();
    report.solver_residual = answer.get<double>();
    report.solver_indefinite = answer.get<std::int32_t>() != 0;
    answer.expect_end();
  } catch (const ChannelError& error) {
    blame(error, last);
  }
  report.dt = dt;
  next_ = next(last);
  return report;
}

void LibrarySolver::store(State& state) const {
  try {
    Packet answer = ask(Packet(Kind::store), next_);
    state = get_state(answer);
    answer.expect_end();
    require_shape(state, particles_, scene_->materials.size(), "it");
  } catch (const ChannelError& error) {
    blame(error, next_);
  }
}

Diagnostics LibrarySolver::diagnostics(const Scene& scene) const {
  State state;
  store(state);
  if (const auto fault = not_finite(state.particles)) fail(Stage::positions, *fault);
  return measure(scene, state);
}

Packet LibrarySolver::ask(const Packet& question, Stage stage) const {
  if (!process_.running()) fail(stage, "is not running any more");
  try {
    Packet answer = process_.ask(question, options_.time_limit, largest_packet(particles_));
    if (answer.kind == Kind::failure)  // it said so itself; its process is sound
      throw SimulationError(stage, SimulationError::Subject::solver, -1,
                            "guest " + path_ + ": " + one_line(answer.get_text(), 500));
    return answer;
  } catch (const ChannelError& error) {
    blame(error, stage);
  }
}

void LibrarySolver::blame(const ChannelError& error, Stage stage) const {
  fail(stage, process_.what_happened(error, options_.time_limit));
}

void LibrarySolver::fail(Stage stage, const std::string& what) const {
  process_.stop();
  throw SimulationError(stage, SimulationError::Subject::solver, -1, "guest " + path_ + " " + what);
}

}  // namespace firn::guest
