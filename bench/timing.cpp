// SPDX-License-Identifier: BSD-3-Clause
#include "bench/timing.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>

#include "firn/error.hpp"
#include "firn/machine.hpp"

namespace firn::bench {

std::string Subject::label() const {
  // A library is known by its file; what else a name has must fit into the group of a results
  // file and the word of a command line.
  const bool is_file = solver.find(':') == std::string::npos;
  std::string label = is_file ? solver.substr(solver.rfind('/') + 1) : solver;
  for (char& c : label)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.' && c != ':' &&
        c != '-')
      c = '_';
  return label;
}

std::string Subject::text() const {
  return label() + "," + std::string(name(precision)) + "," + std::to_string(threads) + "T";
}

std::unique_ptr<Solver> Subject::create(const Registry& registry) const {
  return registry.create(solver, SolverOptions{precision, threads, time_limit});
}

void Subject::describe(results::Case& result) const {
  result.parameters.emplace_back("solver", solver);
  result.parameters.emplace_back("precision", std::string(name(precision)));
  result.parameters.emplace_back("threads", static_cast<double>(threads));
}

namespace {

/// A precision that a solver out of a family lacks is told by its refusal.
std::optional<SolverTraits> traits_of(const Registry& registry, const std::string& solver,
                                      Precision precision) {
  const SolverEntry* entry = registry.find(solver);
  if (entry == nullptr && precision != Precision::float64) {
    try {
      return registry.create(solver, {precision})->traits();
    } catch (const InputError&) {
      return {};
    }
  }
  if (entry != nullptr && std::find(entry->precisions.begin(), entry->precisions.end(),
                                    precision) == entry->precisions.end())
    return {};
  return registry.create(solver, {precision})->traits();
}

}  // namespace

std::vector<Subject> subjects(const Registry& registry, const Options& options,
                              bool all_thread_counts) {
  const int most = options.max_threads > 0 ? options.max_threads : available_processors();
  std::vector<std::string> solvers = options.solvers;
  if (solvers.empty())
    for (const SolverEntry& entry : registry.entries()) solvers.push_back(entry.name);
  std::vector<Subject> result;
  for (const std::string& solver : solvers)
    for (const Precision precision : {Precision::float64, Precision::float32})
      if (const auto traits = traits_of(registry, solver, precision))
        for (int threads = 1; threads <= most; threads *= 2) {
          if (threads > 1 && (!all_thread_counts || traits->pace != Pace::fast)) break;
          result.push_back({solver, precision, threads, *traits, options.time_limit});
        }
  return result;
}

std::string short_count(std::size_t particles) {
  if (particles >= 1'000'000) return to_text(static_cast<double>(particles) / 1e6) + " M";
  return to_text(static_cast<double>(particles) / 1e3) + " k";
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Timed::Timed(const Registry& registry, const Subject& subject, const Workload& work)
    : work_(&work), solver_(subject.create(registry)) {
  reload();
}

void Timed::reload() {
  solver_->load(work_->scene, work_->state);
  steps_left_ = work_->steps_allowed;
  // The first step allocates and sorts; it is paid once per simulation and not timed.
  for (int warm = 0; warm < 2; ++warm) take(1);
}

int Timed::steps_for(double least) const {
  if (interrupted()) throw Interrupted{};
  const int most = work_->steps_allowed / 4;
  return std::clamp(static_cast<int>(std::ceil(least / last_step_)), 1, most);
}

void Timed::reload_unless(int steps_are_left) {
  if (steps_left_ < steps_are_left) reload();
}

double Timed::take(int steps) {
  const double start = seconds_now();
  for (int i = 0; i < steps; ++i) solver_->step(work_->scene.time.step);
  last_step_ = (seconds_now() - start) / steps;
  steps_left_ -= steps;
  return last_step_;
}

double Timed::repetition(double least) {
  const int steps = steps_for(least);
  reload_unless(steps);
  return take(steps);
}

namespace {

struct Largest {
  double value = 0;
  const char* what = "nothing";
  void take(double error, const char* name) {
    if (!(error <= value)) value = error, what = name;  // NaN is taken, too
  }
};

}  // namespace

void validate(const Registry& registry, const Subject& subject, Deformation deformation,
              std::uint64_t seed, results::Case& result) {
  const Workload work = block(8000, deformation, seed);
  const Subject plain{reference_name};
  State mine, theirs;
  for (auto [who, state] : {std::pair{&subject, &mine}, std::pair{&plain, &theirs}}) {
    const auto solver = who->create(registry);
    solver->load(work.scene, work.state);
    solver->step(work.scene.time.step);
    solver->store(*state);
  }
  // Every value is a sum over ≤ 64 nodes of sums over ≤ 512 particles, and momentum is
  // divided by masses that cancel nothing: √(64·512) ≈ 200 roundoffs, allowed 1000.
  const double eps = subject.precision == Precision::float32 ? 0x1p-23 : 0x1p-52;
  const double h = work.scene.grid.spacing;
  double v_max = 0;
  for (const Vec3& v : theirs.particles.v) v_max = std::max(v_max, v.norm());
  Largest worst;
  std::size_t yielded = 0;
  for (std::size_t p = 0; p < theirs.particles.size(); ++p) {
    const Particles &a = mine.particles, &b = theirs.particles;
    worst.take((a.x[p] - b.x[p]).norm() / h, "x/h");
    worst.take((a.v[p] - b.v[p]).norm() / v_max, "v/v_max");
    worst.take((a.F_E[p] - b.F_E[p]).norm(), "F_E");
    worst.take((a.F_P[p] - b.F_P[p]).norm(), "F_P");
    // Clamping shifts F_P by the strain of one step; roundoff by far less.
    yielded += (b.F_P[p] - work.state.particles.F_P[p]).norm() > 1e-5;
  }
  const double share = static_cast<double>(yielded) / static_cast<double>(theirs.particles.size());
  const bool as_promised = deformation == Deformation::elastic ? share == 0 : share == 1;
  const bool agrees = worst.value <= 1000 * eps;
  result.validation = "one step against the reference: largest difference " +
                      to_text(worst.value / eps) + " eps in " + worst.what +
                      ", allowed 1000; share of particles that yielded " + to_text(share);
  if (agrees && as_promised) return;
  result.status = results::Status::invalid;
  result.message = agrees ? "the block does not deform as promised" : "differs from the reference";
}

}  // namespace firn::bench
