// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What the machine itself gives to several threads: solvers that share nothing.

#include <vector>

#include "bench/timing.hpp"

namespace firn::bench {

/// n one-thread solvers with the same work, each in memory of its own. They share no data and
/// never wait for one another, so what they lose when all of them step at once, they lose to
/// the machine: to caches and memory that cores share, to the clock of several busy cores, to
/// whatever else the processors do.
class Copies {
 public:
  Copies(const Registry& registry, Subject subject, const Workload& work, int n);

  /// Seconds of one step of copy i mod n while the others rest. Throws Interrupted.
  double alone(int i, double least);

  /// Seconds of one step while all of them step, each on its own thread: n over the sum of
  /// their rates. Throws Interrupted.
  double together(double least);

 private:
  std::vector<Timed> copies_;
};

}  // namespace firn::bench
