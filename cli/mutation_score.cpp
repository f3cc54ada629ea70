// SPDX-License-Identifier: BSD-3-Clause
#include "cli/mutation_score.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/verbs.hpp"
#include "firn/error.hpp"
#include "firn/machine.hpp"
#include "io/results/machine_facts.hpp"
#include "io/results/results_file.hpp"
#include "solvers/solvers.hpp"
#include "verification/check/check.hpp"
#include "verification/mutants/mutants.hpp"
#include "verification/suite/run.hpp"
#include "verification/suite/subject.hpp"
#include "verification/support/snow_cases.hpp"

namespace firn::cli {

namespace {

suite::Subject subject_of(const std::string& solver, const Registry& registry) {
  suite::Subject subject;
  subject.solver = solver;
  subject.command = "firn verify --solver " + solver;
  subject.create = [solver, &registry](int threads) {
    SolverOptions options;
    options.threads = threads;
    return registry.create(solver, options);
  };
  subject.create_reference = [&registry] { return registry.create(reference_name, {}); };
  return subject;
}

/// What a function says in a process of its own: a mutant may do anything, and GoogleTest runs
/// once per process.
class Worker {
 public:
  template <class Say>
  explicit Worker(const Say& say) {
    int ends[2];
    if (pipe(ends) != 0)
      throw InputError("--mutants", "pipe", std::strerror(errno), "two descriptors");
    std::fflush(nullptr);
    pid_ = fork();
    if (pid_ < 0)
      throw InputError("--mutants", "process", std::strerror(errno), "one more process");
    if (pid_ == 0) {
      close(ends[0]);
      const std::string text = say();
      const ssize_t written = write(ends[1], text.data(), text.size());
      _exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
    }
    close(ends[1]);
    end_ = ends[0];
  }

  /// Waits for it; nothing if it crashed.
  std::optional<std::string> answer() {
    std::string text;
    char buffer[256];
    for (ssize_t n; (n = read(end_, buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<std::size_t>(n));
    close(end_);
    int status = 0;
    waitpid(pid_, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return {};
    return text;
  }

 private:
  pid_t pid_ = -1;
  int end_ = -1;
};

/// The first test that fails with this filter; "" if all pass.
std::string first_failure(const std::string& solver, const std::string& filter,
                          const Registry& registry) {
  Worker worker([&] {
    suite::set_subject(subject_of(solver, registry));
    suite::RunOptions options;
    options.filter = filter;
    options.fail_fast = true;
    options.quiet = true;
    for (const suite::TestResult& test : suite::run(options).tests)
      if (test.failed) return test.topic + "." + test.name;
    return std::string();
  });
  return worker.answer().value_or("a crash");
}

/// What lockstep says first, over all cases.
std::optional<Divergence> named_by_check(const std::string& solver, const Registry& registry) {
  for (const fixtures::Case& c : fixtures::snow_cases()) {
    const auto reference = registry.create(reference_name, {});
    const auto subject = subject_of(solver, registry).create(1);
    const CheckReport report =
        run_check(c.scene, c.state, *reference, *subject, {.steps = c.steps});
    if (!report.valid()) return report.first_divergence;
  }
  return {};
}

struct Score {
  const Mutant* mutant = nullptr;
  std::string by_properties;  ///< first failure of the suites that know no other solver
  std::string caught_by;      ///< that, or the first of those that compare with the reference
  std::string named;          ///< stages that check names
  bool stage_right = false;
};

/// The suites that compare with the reference come later: what the properties of the method
/// catch is worth more. Waves and limits of stability, which take longest, come last. Ladders of
/// size take longer than the other properties and see what these do not.
constexpr const char* properties =
    "*-Scale.*:Lockstep.*:FreeRunning.*:Dynamics.*:Stability.bulk*:Stability.lone*";
constexpr const char* ladders = "Scale.*";
constexpr const char* comparisons = "Lockstep.*:FreeRunning.*";
constexpr const char* the_rest = "Dynamics.*:Stability.*";

Score score_of(const Mutant& mutant, const Registry& registry) {
  Score score;
  score.mutant = &mutant;
  const std::string solver = "mutant:" + mutant.name;
  score.by_properties = first_failure(solver, properties, registry);
  if (score.by_properties.empty()) score.by_properties = first_failure(solver, ladders, registry);
  score.caught_by = score.by_properties;
  if (score.caught_by.empty()) score.caught_by = first_failure(solver, comparisons, registry);
  if (score.caught_by.empty()) score.caught_by = first_failure(solver, the_rest, registry);
  const std::optional<Divergence> first = named_by_check(solver, registry);
  if (first) {
    score.named = stage_range(first->from, first->through);
    const bool pinned = first->from == first->through;
    score.stage_right =
        first->from <= mutant.stage && mutant.stage <= first->through && (mutant.several || pinned);
  } else {
    score.stage_right = !mutant.check_sees_it;
  }
  return score;
}

std::string stage_of(const Mutant& mutant) {
  return mutant.several ? "several" : stage_range(mutant.stage, mutant.stage);
}

/// As many at a time as there are processors.
std::vector<Score> all_scores(const Registry& registry) {
  const auto score_as_text = [&](const Mutant& mutant) {
    const Score s = score_of(mutant, registry);
    return fmt::format("{}\n{}\n{}\n{}\n", s.by_properties, s.caught_by, s.named,
                       s.stage_right ? 1 : 0);
  };
  const std::vector<Mutant>& mutants = all_mutants();
  const auto width = static_cast<std::size_t>(available_processors());
  std::deque<Worker> running;
  std::vector<Score> scores;
  for (std::size_t next = 0; scores.size() < mutants.size();) {
    for (; next < mutants.size() && running.size() < width; ++next)
      running.emplace_back([&] { return score_as_text(mutants[next]); });
    std::istringstream answer(running.front().answer().value_or("a crash\na crash\n\n0\n"));
    running.pop_front();
    Score s;
    s.mutant = &mutants[scores.size()];
    std::string right;
    std::getline(answer, s.by_properties);
    std::getline(answer, s.caught_by);
    std::getline(answer, s.named);
    std::getline(answer, right);
    s.stage_right = right == "1";
    std::fprintf(stderr, "%3zu/%zu %-34s %s\n", scores.size() + 1, mutants.size(),
                 s.mutant->name.c_str(), s.caught_by.empty() ? "SURVIVED" : s.caught_by.c_str());
    scores.push_back(std::move(s));
  }
  return scores;
}

void write(const std::string& path, const std::vector<Score>& scores, bool force) {
  results::ResultsFile file(path, results::machine_facts(0, instruction_set()),
                            results::comparable_facts(), force);
  std::vector<results::Mutant> rows;
  for (const Score& s : scores)
    rows.push_back({s.mutant->name, s.mutant->mistake, stage_of(*s.mutant), s.named, s.caught_by,
                    !s.caught_by.empty()});
  file.append_mutants("firn verify --mutants", rows);
}

}  // namespace

int run_mutation_score(const Registry& registry, const std::string& results, bool json,
                       bool force) {
  const std::string unmutated = first_failure(reference_name, "", registry);
  const std::vector<Score> scores = all_scores(registry);
  if (!results.empty()) write(results, scores, force);
  const auto count = [&](auto holds) { return std::count_if(scores.begin(), scores.end(), holds); };
  const auto caught = count([](const Score& s) { return !s.caught_by.empty(); });
  const auto by_properties = count([](const Score& s) { return !s.by_properties.empty(); });
  const auto single =
      count([](const Score& s) { return !s.mutant->several && s.mutant->check_sees_it; });
  const auto named = count([](const Score& s) {
    return !s.mutant->several && s.mutant->check_sees_it && s.stage_right;
  });
  const auto right = count([](const Score& s) { return s.stage_right; });
  const auto all = static_cast<std::ptrdiff_t>(scores.size());
  const bool valid = unmutated.empty() && caught == all && right == all;
  if (json) {
    nlohmann::json list = nlohmann::json::array();
    for (const Score& s : scores)
      list.push_back({{"name", s.mutant->name},
                      {"patch", s.mutant->mistake},
                      {"stage", stage_of(*s.mutant)},
                      {"named_stage", s.named},
                      {"stage_right", s.stage_right},
                      {"caught_by", s.caught_by},
                      {"caught_without_reference", !s.by_properties.empty()}});
    const nlohmann::json report = {{"verdict", valid ? "VALID" : "INVALID"},
                                   {"unmutated_fails", unmutated},
                                   {"caught", caught},
                                   {"mutants", list}};
    fmt::print("{}\n", report.dump(2));
  } else {
    fmt::print("{:<34} {:<28} {:<28} {}\n", "mutant", "lives in", "check names", "caught by");
    for (const Score& s : scores)
      fmt::print("{:<34} {:<28} {:<28} {}{}\n", s.mutant->name, stage_of(*s.mutant),
                 s.named.empty() ? "-" : s.named, s.caught_by.empty() ? "SURVIVED" : s.caught_by,
                 s.stage_right ? "" : "  WRONG STAGE");
    fmt::print(
        "\n{}: {} of {} mutants caught, {} of them without a comparison with the reference; check "
        "names the stage of {} of {} that live in one; the un-mutated solver {}\n",
        valid ? "VALID" : "INVALID", caught, all, by_properties, named, single,
        unmutated.empty() ? "passes" : "FAILS " + unmutated);
  }
  return valid ? exit_done : exit_failed;
}

}  // namespace firn::cli
