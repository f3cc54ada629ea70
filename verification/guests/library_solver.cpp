#include "verification/guests/library_solver.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <sys/socket.h>
#include <unistd.h>

#include "firn/error.hpp"

namespace firn::guest {

namespace {

Clock::time_point deadline_after(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

SolverTraits read_traits(Packet& answer, Precision precision) {
  SolverTraits traits;
  traits.name = answer.get_text();
  traits.precision = precision;
  const bool supports_float = answer.get<std::int32_t>() != 0;
  traits.semi_implicit = answer.get<std::int32_t>() != 0;
  std::vector<std::int32_t> stops;
  answer.get_all(stops);
  answer.expect_end();
  if (precision == Precision::float32 && !supports_float)
    throw InputError("--precision", "not supported by guest " + traits.name, "float", "double");
  for (const std::int32_t stop : stops) {
    const bool ascending = traits.stops.empty() || number(traits.stops.back()) < stop;
    if (stop < 1 || stop > stage_count || !ascending)
      throw InputError("guest " + traits.name, "list of stops", std::to_string(stop),
                       "stages 1 to 10, ascending");
    traits.stops.push_back(static_cast<Stage>(stop));
  }
  if (traits.stops.empty() || traits.stops.back() != Stage::positions)
    throw InputError("guest " + traits.name, "last stop",
                     traits.stops.empty() ? "none" : std::string(name(traits.stops.back())),
                     "positions");
  return traits;
}

/// Sizes that Firn relies on; what is in the arrays is for `check` to judge.
void require_shape(const State& state, std::size_t particles, const std::string& who) {
  const Particles& p = state.particles;
  const Grid& g = state.grid;
  const auto require = [&](bool right, const char* what) {
    if (!right) throw ChannelError(ChannelError::Reason::malformed, who + " gave " + what);
  };
  require(p.x.size() == particles && p.v.size() == particles && p.m.size() == particles &&
              p.V_0.size() == particles && p.F_E.size() == particles && p.F_P.size() == particles &&
              p.id.size() == particles && p.material.size() == particles,
          "particle arrays of the wrong length");
  const auto fits = [&](std::size_t size) { return size == 0 || size == g.size(); };
  require(fits(g.m.size()) && fits(g.v.size()) && fits(g.f.size()) && fits(g.v_star.size()) &&
              fits(g.free_directions.size()) && fits(g.v_new.size()),
          "node arrays of different lengths");
}

}  // namespace

std::string runner_path() {
  if (const char* path = std::getenv("FIRN_GUEST_RUNNER"); path != nullptr && *path != '\0')
    return path;
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (error ? std::filesystem::path(".") : self.parent_path()) / "firn-guest";
}

LibrarySolver::LibrarySolver(std::string path, const SolverOptions& options,
                             const GuestOptions& guest_options)
    : path_(std::filesystem::absolute(path).string()),
      options_(options),
      guest_options_(guest_options) {
  if (!std::filesystem::is_regular_file(path_))
    throw InputError("--solver", "shared library", path, "an existing file");
  start();
}

LibrarySolver::~LibrarySolver() { stop(); }

void LibrarySolver::start() {
  stop();
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw InputError("--solver", "socket pair", std::strerror(errno), "room for two descriptors");
  socket_ = ends[0];
  try {
    process_ = ChildProcess(
        {runner_path(), path_, options_.precision == Precision::float32 ? "float" : "double",
         std::to_string(options_.threads)},
        ends[1]);
  } catch (...) {
    close(ends[1]);
    stop();
    throw;
  }
  close(ends[1]);
  try {
    Packet answer = ask(Packet(Kind::traits), Stage::rasterize);
    traits_ = read_traits(answer, options_.precision);
  } catch (const SimulationError& error) {
    throw InputError(std::string("--solver: ") + error.what());
  } catch (const ChannelError& error) {
    throw InputError("--solver: guest " + path_ + ": " + error.what());
  }
}

void LibrarySolver::stop() const {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
  process_.kill_group();
}

void LibrarySolver::load(const Scene& scene, const State& state) {
  if (scene.semi_implicit() && !traits_.semi_implicit)
    throw InputError("integrator.type", "not supported by guest " + traits_.name, "semi-implicit",
                     "explicit");
  if (!process_.running()) start();  // after a failure: a new one, with nothing of the old
  scene_ = &scene;
  particles_ = state.particles.size();
  next_ = state.next;
  Packet question(Kind::load);
  question.put(scene.toml);
  put_state(question, state);
  ask(question, state.next).expect_end();
}

TimeStep LibrarySolver::choose_time_step() {
  TimeStep chosen;
  if (!scene_->time.adaptive) {
    chosen.dt = scene_->time.step;
    return chosen;
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
    require_shape(state, particles_, "it");
  } catch (const ChannelError& error) {
    blame(error, next_);
  }
}

Packet LibrarySolver::ask(const Packet& question, Stage stage) const {
  if (socket_ < 0) fail(stage, "is not running any more");
  try {
    const Clock::time_point deadline = deadline_after(guest_options_.time_limit);
    send(socket_, question, deadline);
    Packet answer = receive(socket_, deadline);
    if (answer.kind == Kind::failure) {
      // It said so itself; its process is sound and may be loaded again.
      throw SimulationError(stage, SimulationError::Subject::solver, -1,
                            "guest " + path_ + ": " + answer.get_text());
    }
    if (answer.kind != Kind::answer)
      throw ChannelError(ChannelError::Reason::malformed, "an answer of no known kind");
    return answer;
  } catch (const ChannelError& error) {
    blame(error, stage);
  }
}

void LibrarySolver::blame(const ChannelError& error, Stage stage) const {
  if (error.reason == ChannelError::Reason::timeout)
    fail(stage, "gave no answer within " + to_text(guest_options_.time_limit) + " s");
  if (error.reason == ChannelError::Reason::closed && process_.wait_until(deadline_after(5)))
    fail(stage, "ended: " + process_.how_it_ended());
  fail(stage, std::string("broke the protocol: ") + error.what());
}

void LibrarySolver::fail(Stage stage, const std::string& what) const {
  stop();
  throw SimulationError(stage, SimulationError::Subject::solver, -1, "guest " + path_ + " " + what);
}

}  // namespace firn::guest
