// SPDX-License-Identifier: BSD-3-Clause
/// How a run of `firn bench` goes: plan, skip what the file has, measure, judge, append.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <exception>
#include <string_view>

#include "bench/bench.hpp"
#include "bench/probes.hpp"
#include "bench/statistics.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"
#include "firn/interruption.hpp"
#include "firn/memory.hpp"
#include "io/output_path.hpp"
#include "io/results/machine_facts.hpp"
#include "io/results/results_file.hpp"

namespace firn::bench {

namespace {

volatile std::sig_atomic_t stop_asked = 0;

/// The program ends itself after a signal; a test that raises one does not.
bool ends_program = false;

void stop_or_end(int /*signal*/) {
  if (stop_asked != 0) interruption::end_now();
  stop_asked = 1;
  if (ends_program) interruption::end_soon();
}

/// For the time of a run, SIGINT and SIGTERM ask for a stop between repetitions. A repetition
/// that takes longer is given up: every finished case is in the file.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_asked = 0;
    before_int_ = std::signal(SIGINT, stop_or_end);
    before_term_ = std::signal(SIGTERM, stop_or_end);
    ends_program = before_int_ != SIG_DFL;
  }
  ~StopOnSignal() {
    interruption::ended_in_order();
    std::signal(SIGINT, before_int_);
    std::signal(SIGTERM, before_term_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  void (*before_int_)(int);
  void (*before_term_)(int);
};

std::string command_of(const results::Case& result, const Options& options,
                       const Registry& registry) {
  std::string text = "firn bench '" + result.suite + "/" + result.name + "'";
  for (const auto& [fact, value] : result.parameters)
    if (const auto* solver = std::get_if<std::string>(&value); fact == "solver" && solver)
      if (registry.find(*solver) == nullptr) text += " --solver '" + *solver + "'";
  if (options.seed != 1) text += " --seed " + std::to_string(options.seed);
  return text;
}

/// Named as SUITE/CASE: whoever names one case wants to see it measured.
bool named(const Options& options, const results::Case& result) {
  const auto& names = options.suites;
  return std::find(names.begin(), names.end(), result.suite + "/" + result.name) != names.end();
}

/// Whether `text` is `pattern`, in which each * stands for anything.
bool matches(std::string_view pattern, std::string_view text) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  if (text.substr(0, star) != pattern.substr(0, star)) return false;
  for (std::size_t from = star; from <= text.size(); ++from)
    if (matches(pattern.substr(star + 1), text.substr(from))) return true;
  return false;
}

/// A suite name, SUITE/CASE, or a pattern of it.
bool asked_for(const Options& options, const CasePlan& plan) {
  if (options.suites.empty()) return !options.quick || plan.quick;
  const std::string full = plan.description.suite + "/" + plan.description.name;
  for (const std::string& wanted : options.suites) {
    if (wanted == full) return true;
    if (wanted == plan.description.suite || matches(wanted, full))
      return !options.quick || plan.quick;
  }
  return false;
}

std::vector<CasePlan> plans(const Registry& registry, const Options& options) {
  std::vector<CasePlan> all, chosen;
  for (const SuiteEntry& suite : suites()) suite.plan(registry, options, all);
  for (CasePlan& plan : all)
    if (asked_for(options, plan)) chosen.push_back(std::move(plan));
  // What an interrupted run leaves behind should be the whole in small.
  std::stable_partition(chosen.begin(), chosen.end(), [](const CasePlan& p) { return p.quick; });
  if (chosen.empty() && !options.suites.empty()) {
    std::string names;
    for (const SuiteEntry& suite : suites()) names += (names.empty() ? "" : ", ") + suite.name;
    throw InputError("firn bench", "suite", options.suites.front(),
                     names + ", or SUITE/CASE, in which * stands for anything");
  }
  return chosen;
}

/// Timings whose median is not known well enough say so instead of giving a number.
void judge(results::Case& result) {
  for (const results::Quantity& quantity : result.quantities) {
    if (!quantity.timed || quantity.values.size() < 3) continue;
    const double error = median_error(quantity.values);
    if (error <= largest_median_error) continue;
    result.status = results::Status::noisy;
    result.message = quantity.name + ": " + std::to_string(quantity.values.size()) +
                     " repetitions, half of them within " +
                     percent(relative_spread(quantity.values)) +
                     ", leave the median uncertain by " + percent(error) + ", allowed " +
                     percent(largest_median_error);
  }
}

/// InputError if the case has more particles than fit into memory.
void require_memory_for(const results::Case& result, const Registry& registry) {
  const double* particles = nullptr;
  std::string solver, precision;
  for (const auto& [fact, value] : result.parameters) {
    if (fact == "particles") particles = std::get_if<double>(&value);
    const auto* text = std::get_if<std::string>(&value);
    if (text != nullptr && fact == "solver") solver = *text;
    if (text != nullptr && fact == "precision") precision = *text;
  }
  if (particles == nullptr) return;
  const bool is_ours = registry.find(solver) != nullptr;
  const Pace pace = is_ours ? registry.traits(solver).pace : Pace::process;
  require_memory(
      result.suite + "/" + result.name, *particles,
      run_bytes_per_particle(pace, precision == "float" ? Precision::float32 : Precision::float64));
}

/// Runs the case and judges it.
void run_once(const CasePlan& plan, results::Case& result, const Registry& registry) {
  try {
    require_memory_for(result, registry);
    plan.run(result);
    if (result.status == results::Status::measured) judge(result);
  } catch (const std::exception& error) {
    result.status = results::Status::failed;
    result.message = error.what();
  }
}

/// Adds the repetitions of another run of the same case; what went wrong there went wrong.
void add_repetitions(const results::Case& again, results::Case& result) {
  if (again.status == results::Status::invalid || again.status == results::Status::failed) {
    result = again;
    return;
  }
  for (const results::Quantity& more : again.quantities)
    for (results::Quantity& quantity : result.quantities)
      if (quantity.name == more.name)
        quantity.values.insert(quantity.values.end(), more.values.begin(), more.values.end());
  result.status = results::Status::measured;
  result.message.clear();
  judge(result);
}

/// A case that comes out noisy is run again, all repetitions kept, up to so many times in
/// all and as long as it has not taken so long [s]: a disturbance of some seconds passes.
struct Patience {
  int runs;
  double seconds;
};
constexpr Patience full_patience{4, 20}, quick_patience{2, 1};

void measure(CasePlan& plan, const Patience& patience, const Registry& registry) {
  const results::Case fresh = plan.description;
  results::Case& result = plan.description;
  const double start = seconds_now(), processor_start = processor_seconds();
  std::vector<double> calibration;
  const auto calibrate = [&] {
    for (int i = 0; i < 3; ++i) calibration.push_back(calibration_loop());
  };
  calibrate();
  run_once(plan, result, registry);
  for (int runs = 1; runs < patience.runs && result.status == results::Status::noisy &&
                     seconds_now() - start < patience.seconds;
       ++runs) {
    results::Case again = fresh;
    run_once(plan, again, registry);
    add_repetitions(again, result);
  }
  // A number that failed its validation is not kept, so that nobody quotes it.
  if (result.status == results::Status::invalid || result.status == results::Status::failed)
    result.quantities.clear();
  calibrate();
  result.calibration = calibration;
  result.wall_seconds = seconds_now() - start;
  result.processor_seconds = processor_seconds() - processor_start;
}

/// "time 0.25 ns (spread 3 %)".
std::string text_of(const results::Quantity& quantity) {
  std::string text = quantity.name + " " + to_text(three_digits(median(quantity.values))) +
                     (quantity.units == "1" ? "" : " " + quantity.units);
  if (quantity.timed) text += " (spread " + percent(relative_spread(quantity.values)) + ")";
  return text;
}

/// The first quantity of a case, or why there is none.
std::string outcome(const results::Case& result) {
  if (result.status != results::Status::measured)
    return std::string(results::name(result.status)) + ": " + result.message;
  if (result.quantities.empty()) return "measured";
  return text_of(result.quantities.front());
}

/// How long the rest will take, from what cases usually take (SuiteEntry) and by how much
/// those so far were slower. Before the first case the usual time is all there is.
class TimeLeft {
 public:
  void expect(const CasePlan& plan) { ahead_ += usual(plan); }
  void done(const CasePlan& plan, double seconds) {
    ahead_ -= usual(plan), usual_ += usual(plan), taken_ += seconds;
  }
  /// "about 12 min left", "about 40 s left".
  std::string text() const {
    // A minute of what is usual beside it: the first few cases are no measure of the machine.
    const double pace = (taken_ + 60) / (usual_ + 60), left = std::max(0.0, ahead_ * pace);
    if (left >= 90) return "about " + std::to_string(std::lround(left / 60)) + " min left";
    return "about " + std::to_string(std::lround(left)) + " s left";
  }

 private:
  static double usual(const CasePlan& plan) {
    for (const SuiteEntry& suite : suites())
      if (suite.name == plan.description.suite)
        return plan.quick ? suite.usual_seconds_quick : suite.usual_seconds;
    return 1;
  }
  double ahead_ = 0, usual_ = 0, taken_ = 0;
};

}  // namespace

bool interrupted() { return stop_asked != 0; }

int run(const Registry& registry, const Options& options, std::ostream& out, std::ostream& log) {
  std::vector<CasePlan> chosen = plans(registry, options);
  if (options.list) {
    for (const CasePlan& plan : chosen)
      out << plan.description.suite << "/" << plan.description.name << "  "
          << plan.description.title << (plan.quick ? "  [quick]" : "") << "\n";
    return 0;
  }
  require_no_input(options.output, options.inputs);
  results::Facts facts = results::machine_facts(options.seed, instruction_set());
  facts.emplace_back("cases_asked_for", static_cast<double>(chosen.size()));
  results::ResultsFile file(options.output, facts, results::comparable_facts(), options.force);
  const StopOnSignal stop;
  std::size_t number = 0, wrong = 0, measured = 0;
  double seconds = 0;
  TimeLeft left;
  const auto skipped = [&](const results::Case& result) {
    return !options.again && !named(options, result) && file.has(result.suite, result.name);
  };
  std::size_t there = 0;
  for (const CasePlan& plan : chosen)
    if (skipped(plan.description))
      ++there;
    else
      left.expect(plan);
  log << file.path() << ": " << chosen.size() << " cases, " << left.text() << "\n";
  for (CasePlan& plan : chosen) {
    ++number;
    results::Case& result = plan.description;
    if (skipped(result)) continue;
    result.command = command_of(result, options, registry);
    if (named(options, result)) require_memory_for(result, registry);
    log << "[" << number << "/" << chosen.size() << "] " << result.suite << "/" << result.name
        << ": " << std::flush;
    try {
      measure(plan, options.quick ? quick_patience : full_patience, registry);
      if (interrupted()) throw Interrupted{};
    } catch (const Interrupted&) {
      log << "interrupted; " << file.path() << " holds every finished case\n";
      return 130;
    }
    wrong += result.status == results::Status::invalid || result.status == results::Status::failed;
    file.append(result);
    seconds += result.wall_seconds;
    left.done(plan, result.wall_seconds);
    log << outcome(result) << "  [" << three_digits(result.wall_seconds) << " s; " << left.text()
        << "]\n";
    if (named(options, result) && result.status == results::Status::measured) {
      for (const results::Quantity& quantity : result.quantities)
        log << "    " << text_of(quantity) << ": " << quantity.meaning << "\n";
      log << "    " << result.validation << "\n";
    }
    ++measured;
    plan.run = nullptr;  // frees what the case held
  }
  log << file.path() << ": " << chosen.size() << " cases asked for, " << measured
      << " measured now in " << std::lround(seconds) << " s, " << wrong
      << " of them invalid or failed"
      << (there > 0 ? ", " + std::to_string(there) + " were there (--again measures them anew)"
                    : "")
      << "\n";
  return wrong == 0 ? 0 : 1;
}

}  // namespace firn::bench
