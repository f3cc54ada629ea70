// SPDX-License-Identifier: BSD-3-Clause
#include "bench/copies.hpp"

#include <algorithm>
#include <barrier>
#include <future>

namespace firn::bench {

Copies::Copies(const Registry& registry, Subject subject, const Workload& work, int n) {
  subject.threads = 1;
  copies_.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) copies_.emplace_back(registry, subject, work);
}

double Copies::alone(int i, double least) {
  return copies_[static_cast<std::size_t>(i) % copies_.size()].repetition(least);
}

double Copies::together(double least) {
  // Whatever has to be loaded again is loaded before any of them starts; and all take the same
  // number of steps, so that none steps alone for long.
  int steps = 1;
  for (Timed& copy : copies_) steps = std::max(steps, copy.steps_for(least));
  for (Timed& copy : copies_) copy.reload_unless(steps);
  std::barrier start(static_cast<std::ptrdiff_t>(copies_.size()));
  std::vector<std::future<double>> times;
  try {
    for (Timed& copy : copies_)
      times.push_back(std::async(std::launch::async, [&start, &copy, steps] {
        start.arrive_and_wait();
        return copy.take(steps);
      }));
  } catch (...) {  // the system gives no more threads: those that wait must not wait for them
    for (std::size_t i = times.size(); i < copies_.size(); ++i) start.arrive_and_drop();
    throw;
  }
  double rate = 0;
  for (std::future<double>& time : times) rate += 1 / time.get();
  return static_cast<double>(copies_.size()) / rate;
}

}  // namespace firn::bench
