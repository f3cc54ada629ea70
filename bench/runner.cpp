/// How a run of `firn bench` goes: plan, skip what the file has, measure, judge, append.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <ctime>
#include <exception>

#include "bench/bench.hpp"
#include "bench/machine_facts.hpp"
#include "bench/results_file.hpp"
#include "bench/statistics.hpp"
#include "bench/timing.hpp"
#include "firn/error.hpp"

namespace firn::bench {

namespace {

volatile std::sig_atomic_t stop_asked = 0;

/// For the time of a run, SIGINT and SIGTERM ask for a stop between repetitions.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_asked = 0;
    before_int_ = std::signal(SIGINT, [](int) { stop_asked = 1; });
    before_term_ = std::signal(SIGTERM, [](int) { stop_asked = 1; });
  }
  ~StopOnSignal() {
    std::signal(SIGINT, before_int_);
    std::signal(SIGTERM, before_term_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  void (*before_int_)(int);
  void (*before_term_)(int);
};

std::string command_of(const results::Case& result, const Options& options) {
  std::string text = "firn bench '" + result.suite + "/" + result.name + "'";
  if (options.seed != 1) text += " --seed " + std::to_string(options.seed);
  return text;
}

/// A suite name, SUITE/CASE, or SUITE/PREFIX*.
bool asked_for(const Options& options, const CasePlan& plan) {
  if (options.suites.empty()) return !options.quick || plan.quick;
  const std::string full = plan.description.suite + "/" + plan.description.name;
  for (const std::string& wanted : options.suites) {
    if (wanted == full) return true;
    const bool prefix =
        wanted.back() == '*' && full.rfind(wanted.substr(0, wanted.size() - 1), 0) == 0;
    if (prefix || wanted == plan.description.suite) return !options.quick || plan.quick;
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
    throw InputError("firn bench", "suite", options.suites.front(), names + ", or SUITE/CASE");
  }
  return chosen;
}

/// Timings that spread too widely say so instead of giving a number.
void judge(results::Case& result) {
  for (const results::Quantity& quantity : result.quantities) {
    if (!quantity.timed || quantity.values.size() < 3) continue;
    const double spread = relative_spread(quantity.values);
    if (spread <= widest_spread) continue;
    result.status = results::Status::noisy;
    result.message = quantity.name + ": half of the repetitions spread over " + percent(spread) +
                     " of the median, allowed " + percent(widest_spread);
  }
}

/// Processor time of all threads of this process [s].
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void measure(CasePlan& plan) {
  results::Case& result = plan.description;
  const double start = seconds_now(), processor_start = processor_seconds();
  for (int i = 0; i < 3; ++i) result.calibration.push_back(calibration_loop());
  try {
    plan.run(result);
    if (result.status == results::Status::measured) judge(result);
  } catch (const std::exception& error) {
    result.status = results::Status::failed;
    result.message = error.what();
  }
  // A number that failed its validation is not kept, so that nobody quotes it.
  if (result.status == results::Status::invalid || result.status == results::Status::failed)
    result.quantities.clear();
  for (int i = 0; i < 3; ++i) result.calibration.push_back(calibration_loop());
  result.wall_seconds = seconds_now() - start;
  result.processor_seconds = processor_seconds() - processor_start;
}

/// "0.25 ns (± 3 %)" of the first quantity, or why there is none.
std::string outcome(const results::Case& result) {
  if (result.status != results::Status::measured)
    return std::string(results::name(result.status)) + ": " + result.message;
  if (result.quantities.empty()) return "measured";
  const results::Quantity& first = result.quantities.front();
  std::string text =
      first.name + " " + to_text(three_digits(median(first.values))) + " " + first.units;
  if (first.timed) text += " (spread " + percent(relative_spread(first.values)) + ")";
  return text;
}

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
  results::Facts facts = machine_facts(options.seed);
  facts.emplace_back("cases_asked_for", static_cast<double>(chosen.size()));
  results::ResultsFile file(options.output, facts, comparable_facts());
  const StopOnSignal stop;
  std::size_t number = 0, wrong = 0, measured = 0;
  double seconds = 0;
  for (CasePlan& plan : chosen) {
    ++number;
    results::Case& result = plan.description;
    if (file.has(result.suite, result.name)) continue;
    result.command = command_of(result, options);
    log << "[" << number << "/" << chosen.size() << "] " << result.suite << "/" << result.name
        << ": " << std::flush;
    try {
      measure(plan);
      if (interrupted()) throw Interrupted{};
    } catch (const Interrupted&) {
      log << "interrupted; " << file.path() << " holds every finished case\n";
      return 130;
    }
    wrong += result.status == results::Status::invalid || result.status == results::Status::failed;
    file.append(result);
    log << outcome(result) << "  [" << three_digits(result.wall_seconds) << " s]\n";
    seconds += result.wall_seconds;
    ++measured;
    plan.run = nullptr;  // frees what the case held
  }
  log << file.path() << ": " << chosen.size() << " cases asked for, " << measured
      << " measured now in " << std::lround(seconds) << " s, " << wrong
      << " of them invalid or failed\n";
  return wrong == 0 ? 0 : 1;
}

}  // namespace firn::bench
