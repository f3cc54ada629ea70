// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How solvers are timed: loaded, warmed up, stepped a chosen number of times per repetition.

#include <memory>
#include <string>
#include <vector>

#include "bench/bench.hpp"
#include "bench/workload.hpp"

namespace firn::bench {

/// A solver under test, by what the registry calls it.
struct Subject {
  std::string solver;
  Precision precision = Precision::float64;
  int threads = 1;
  SolverTraits traits = {};  ///< of that solver
  double time_limit = 60;    ///< for each of its answers, if it runs in another process [s]

  bool slow() const { return traits.pace != Pace::fast; }
  std::string label() const;  ///< the solver's name as part of a case's name
  std::string text() const;   ///< "optimized,float,2T"
  std::unique_ptr<Solver> create(const Registry& registry) const;
  void describe(results::Case& result) const;  ///< adds the three parameters
};

/// Every solver and precision that the options ask for, one thread; and with
/// `all_thread_counts` also 2, 4, … up to the machine's, except for those that a second
/// thread does not help. Throws InputError for a solver that does not exist.
std::vector<Subject> subjects(const Registry& registry, const Options& options,
                              bool all_thread_counts);

/// "100000" → "100 k".
std::string short_count(std::size_t particles);

double seconds_now();        ///< monotonic
double processor_seconds();  ///< processor time of all threads of this process

/// A solver that is stepped through one workload; load() again when its promise runs out.
class Timed {
 public:
  Timed(const Registry& registry, const Subject& subject, const Workload& work);

  /// Seconds of one step, averaged over one repetition of about `least` seconds.
  /// Throws Interrupted.
  double repetition(double least);

  /// The three parts of a repetition, for whoever starts several at once: how many steps take
  /// about `least` seconds (throws Interrupted); loading again unless so many are left; and
  /// taking them, which returns the seconds of one.
  int steps_for(double least) const;
  void reload_unless(int steps_are_left);
  double take(int steps);

  Solver& solver() { return *solver_; }

 private:
  void reload();

  const Workload* work_;
  std::unique_ptr<Solver> solver_;
  int steps_left_ = 0;
  double last_step_ = 0;  ///< [s]
};

/// One step of `subject` against one of the reference from the same state. Returns
/// what came nearest to its bound and the share of particles that yielded, as one
/// line; sets `result.status` to invalid if a bound is broken or the workload does
/// not deform as promised.
void validate(const Registry& registry, const Subject& subject, Deformation deformation,
              std::uint64_t seed, results::Case& result);

}  // namespace firn::bench
