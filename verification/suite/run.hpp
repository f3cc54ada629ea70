// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Runs the suites on the subject and sums up.

#include <string>
#include <vector>

#include "verification/suite/ledger.hpp"

namespace firn::suite {

/// A topic of the verdict: one GoogleTest suite.
struct Topic {
  const char* name;   ///< "Conservation"
  const char* title;  ///< "conservation"
};
const std::vector<Topic>& topics();

struct RunOptions {
  std::string filter;         ///< of GoogleTest: "Conservation.*", "*momentum*"; empty: all
  bool long_studies = false;  ///< also the tests whose name begins with long_
  bool fail_fast = false;
  std::string junit;   ///< file for JUnit XML; empty: none
  bool quiet = false;  ///< no progress, no messages
};

struct TestResult {
  std::string topic, name;
  bool failed = false, skipped = false;
  std::string message;  ///< why it was skipped, or the first failure
  double seconds = 0;
};

struct Verdict {
  std::vector<TestResult> tests;
  double seconds = 0;
  bool valid() const;
  std::int64_t numbers() const;
};

/// GoogleTest's own command line plays no part. May be called once per process.
Verdict run(const RunOptions& options);

/// Names of the tests, "Topic.name".
std::vector<std::string> test_names();

/// The table by topic, the failures with the commands that repeat them, the verdict last.
std::string to_table(const Verdict& verdict);
std::string to_json(const Verdict& verdict);

/// The command that repeats one test.
std::string command_of(const std::string& topic, const std::string& test);

}  // namespace firn::suite
