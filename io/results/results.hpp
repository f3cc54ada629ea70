// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What `firn bench` and `firn verify` write and `firn report` reads; the file
/// format is documented in docs/results_schema.md.

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace firn::results {

/// Facts in the order in which they were stated: numbers or texts.
using Value = std::variant<double, std::string>;
using Facts = std::vector<std::pair<std::string, Value>>;

/// One measured quantity, every repetition of it.
struct Quantity {
  std::string name;     ///< "time_per_particle_step"
  std::string units;    ///< "ns", "1", "m"
  std::string meaning;  ///< one line
  enum class Better { lower, higher, neither } better = Better::neither;
  std::vector<double> values;
  bool timed = false;  ///< judged by its spread: a timing, not a computed number
};

enum class Status {
  measured,  ///< valid, and its spread is narrow enough to be quoted
  noisy,     ///< valid, but the repetitions spread too widely to quote a median
  invalid,   ///< validation failed: not timed
  failed,    ///< the solver threw; `message` says what
};
std::string_view name(Status status);

/// One case of one suite.
struct Case {
  std::string suite;    ///< "steps"
  std::string name;     ///< unique in its suite: "optimized,float,plastic,100000,1"
  std::string title;    ///< a title for readers
  std::string command;  ///< measures it again
  Status status = Status::measured;
  std::string message;     ///< why it is not `measured`
  std::string validation;  ///< what was compared before it was timed, and the largest error
  Facts parameters;        ///< solver, precision, threads, particles, …
  std::vector<Quantity> quantities;
  std::vector<double> calibration;  ///< the fixed loop, right before and right after [s]
  double wall_seconds = 0;          ///< what measuring this case took, validation included [s]
  double processor_seconds = 0;     ///< the same in processor time of all threads [s]
};

/// One row of a verification: what was compared and how it ended.
struct Check {
  std::string topic;    ///< "conservation"
  std::string name;     ///< "momentum of P2G"
  double error = 0;     ///< largest error in units of its bound
  std::string verdict;  ///< "VALID" or "INVALID"
  std::string command;  ///< repeats this check
};

/// One deliberately wrong solver and what caught it.
struct Mutant {
  std::string name, patch;  ///< what was done to which function
  std::string stage;        ///< the stage that is wrong, or "several"
  std::string named_stage;  ///< the stage that `check` named
  std::string caught_by;    ///< the first check that failed; empty: survived
  bool caught = false;
};

}  // namespace firn::results
