// SPDX-License-Identifier: BSD-3-Clause
#include "verification/suite/run.hpp"

#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/suite/subject.hpp"

namespace firn::suite {

const std::vector<Topic>& topics() {
  static const std::vector<Topic> all = {
      {"Kernel", "kernel"},
      {"Svd", "SVD and polar"},
      {"Constitutive", "constitutive"},
      {"Conservation", "conservation"},
      {"Collisions", "collisions"},
      {"SemiImplicit", "semi-implicit"},
      {"StressList", "stress list"},
      {"Scale", "scale"},
      {"Lockstep", "lockstep"},
      {"FreeRunning", "free running"},
      {"Determinism", "determinism"},
      {"Dynamics", "dynamics"},
      {"Stability", "stability"},
  };
  return all;
}

bool Verdict::valid() const {
  bool any = false;
  for (const TestResult& test : tests) {
    if (test.failed) return false;
    any = any || !test.skipped;
  }
  return any;
}

std::int64_t Verdict::numbers() const {
  std::int64_t sum = 0;
  for (const Row& row : rows()) sum += row.numbers;
  return sum;
}

namespace {

/// Tells of progress and failures on stderr, keeps what the verdict needs.
class Listener final : public testing::EmptyTestEventListener {
 public:
  Listener(Verdict& verdict, bool quiet) : verdict_(verdict), quiet_(quiet) {}

  void OnTestStart(const testing::TestInfo& info) override {
    if (quiet_) return;
    std::fprintf(stderr, "%-14s %-60s", info.test_suite_name(), info.name());
    std::fflush(stderr);
  }

  void OnTestEnd(const testing::TestInfo& info) override {
    const testing::TestResult& result = *info.result();
    TestResult test{
        info.test_suite_name(), info.name(), result.Failed(),
        result.Skipped(),       "",          1e-3 * static_cast<double>(result.elapsed_time())};
    for (int i = 0; i < result.total_part_count(); ++i) {
      const testing::TestPartResult& part = result.GetTestPartResult(i);
      if (test.message.empty() && !part.passed()) test.message = first_line(part.message());
    }
    // An exception or a plain assertion leaves no row of its own.
    bool told = !test.failed;
    for (const Row& row : rows())
      told = told || (row.topic == test.topic && row.test == test.name && !row.valid);
    if (!told) add_failure(test.topic, test.name, test.message);
    if (!quiet_) {
      std::fprintf(stderr, "%8.2f s  %s\n", test.seconds,
                   test.failed    ? "FAILED"
                   : test.skipped ? "does not apply"
                                  : "ok");
      if (test.failed || test.skipped) std::fprintf(stderr, "    %s\n", test.message.c_str());
    }
    verdict_.tests.push_back(std::move(test));
  }

 private:
  static std::string first_line(const char* message) {
    std::string text = message;
    if (text.rfind("Failed\n", 0) == 0) text.erase(0, 7);
    for (const char* wrapping :
         {"C++ exception with description \"", "\" thrown in the test body."})
      if (const auto at = text.find(wrapping); at != std::string::npos)
        text.erase(at, std::string(wrapping).size());
    while (!text.empty() && text.back() == '\n') text.pop_back();
    for (char& c : text)
      if (c == '\n') c = ' ';
    return text;
  }

  Verdict& verdict_;
  bool quiet_;
};

}  // namespace

Verdict run(const RunOptions& options) {
  std::string filter = options.filter.empty() ? "*" : options.filter;
  if (!options.long_studies) {
    const bool has_negative = filter.find('-') != std::string::npos;
    filter += has_negative ? ":*.long_*" : "-*.long_*";
  }
  GTEST_FLAG_SET(filter, filter);
  GTEST_FLAG_SET(fail_fast, options.fail_fast);
  GTEST_FLAG_SET(catch_exceptions, true);
  GTEST_FLAG_SET(output, options.junit.empty() ? "" : "xml:" + options.junit);
  // Its own command line is empty; the XML printer is set up here, from the flag above.
  int argc = 1;
  char name[] = "firn-verify";
  char* argv[] = {name, nullptr};
  testing::InitGoogleTest(&argc, argv);
  Verdict verdict;
  testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
  delete listeners.Release(listeners.default_result_printer());
  listeners.Append(new Listener(verdict, options.quiet));  // owned by GoogleTest
  const auto start = std::chrono::steady_clock::now();
  const int failed = RUN_ALL_TESTS();
  verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (failed != 0 && verdict.valid())
    verdict.tests.push_back({"", "", true, false, "GoogleTest", 0});
  return verdict;
}

std::vector<std::string> test_names() {
  std::vector<std::string> names;
  const testing::UnitTest& unit = *testing::UnitTest::GetInstance();
  for (int s = 0; s < unit.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *unit.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t)
      names.push_back(fmt::format("{}.{}", suite.name(), suite.GetTestInfo(t)->name()));
  }
  return names;
}

std::string command_of(const std::string& topic, const std::string& test) {
  return fmt::format("{}{} --filter {}.{}", subject().command,
                     test.rfind("long_", 0) == 0 ? " --long" : "", topic, test);
}

}  // namespace firn::suite
