// SPDX-License-Identifier: BSD-3-Clause
#include "bench/thread_efficiency.hpp"

#include <chrono>
#include <thread>

#include "bench/copies.hpp"
#include "bench/statistics.hpp"

namespace firn::bench {

using results::Quantity;

double gain_over_neighbours(const std::vector<double>& alone, const std::vector<double>& other) {
  std::vector<double> gains;
  for (std::size_t k = 0; k < other.size(); ++k)
    gains.push_back(0.5 * (alone[k] + alone[k + 1]) / other[k]);
  return median(gains);
}

namespace {

bool has_copies(const Subject& subject, const Workload& work, const Rounds& rounds) {
  return static_cast<std::size_t>(subject.threads) * work.state.particles.size() <=
         rounds.most_copied;
}

}  // namespace

void wait_for_rest() {
  // [s]; whoever computes uses all of it, whoever sleeps some µs. On a busy machine a thread
  // that computes may get nothing for some ms.
  constexpr double look = 5e-3;
  for (int i = 0; i < 200; ++i) {
    const double before = processor_seconds();
    std::this_thread::sleep_for(std::chrono::duration<double>(look));
    if (processor_seconds() - before < 0.2 * look) return;
  }
}

Round measure_round(const Registry& registry, const Subject& subject, const Workload& work,
                    const Rounds& rounds) {
  Timed timed(registry, subject, work);
  const bool several = has_copies(subject, work, rounds);
  Copies copies(registry, subject, work, several ? subject.threads : 1);
  Round round;
  const auto all = [&] {
    round.all.push_back(timed.repetition(rounds.seconds));
    wait_for_rest();
  };
  const auto together = [&] {
    if (several) round.copies.push_back(copies.together(rounds.seconds));
  };
  wait_for_rest();
  round.alone.push_back(copies.alone(0, rounds.seconds));
  for (int k = 0; k < rounds.repetitions; ++k) {
    // In turns the first, so that neither is always the farther from its neighbours' middle.
    if (k % 2 == 0)
      all(), together();
    else
      together(), all();
    round.alone.push_back(copies.alone(k + 1, rounds.seconds));
  }
  return round;
}

std::vector<Quantity> measure_efficiency(const Registry& registry, const Subject& subject,
                                         const Workload& work, const Rounds& rounds) {
  Quantity efficiency{"efficiency",
                      "1",
                      "time of one thread over (threads times the time of all); one value per "
                      "round, in which every solver lies in fresh memory",
                      Quantity::Better::higher,
                      {},
                      true};
  Quantity machine{"efficiency of independent copies",
                   "1",
                   "what the machine gives: the rate of as many one-thread solvers that share "
                   "nothing over (threads times the rate of one alone); one value per round",
                   Quantity::Better::neither,
                   {},
                   true};
  Quantity share{"efficiency over that of copies",
                 "1",
                 "what the solver makes of what the machine gives: the first over the second, "
                 "round by round",
                 Quantity::Better::higher,
                 {},
                 true};
  Quantity all = nanoseconds("time", "wall time per particle and step, all threads");
  Quantity alone = nanoseconds("time of one thread", "the same, one thread, alone");
  Quantity copy = nanoseconds("time of one of several copies",
                              "the same, one thread beside others that do the same");
  all.timed = alone.timed = copy.timed = false;  // the ratios are what this case is about
  const double nanoseconds_per_particle = 1e9 / static_cast<double>(work.state.particles.size());
  const auto keep = [&](Quantity& quantity, const std::vector<double>& seconds) {
    for (const double s : seconds) quantity.values.push_back(nanoseconds_per_particle * s);
  };
  for (int i = 0; i < rounds.rounds; ++i) {
    const Round round = measure_round(registry, subject, work, rounds);
    efficiency.values.push_back(gain_over_neighbours(round.alone, round.all) / subject.threads);
    keep(all, round.all), keep(alone, round.alone), keep(copy, round.copies);
    if (round.copies.empty()) continue;
    machine.values.push_back(gain_over_neighbours(round.alone, round.copies));
    share.values.push_back(efficiency.values.back() / machine.values.back());
  }
  if (copy.values.empty()) return {efficiency, all, alone};
  return {efficiency, machine, share, all, alone, copy};
}

}  // namespace firn::bench
