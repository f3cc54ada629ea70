// SPDX-License-Identifier: BSD-3-Clause
/// The efficiency of threads is what it is of solvers whose efficiency is known: they sleep.

#include <atomic>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <thread>

#include "bench/statistics.hpp"
#include "bench/thread_efficiency.hpp"

namespace firn::bench {
namespace {

TEST(GainOverNeighbours, AnEvenDriftCancels) {
  // The machine slows down by 10 % of the start per repetition; the other is twice as fast.
  const auto at = [](double place) { return 1 + 0.1 * place; };
  EXPECT_NEAR(gain_over_neighbours({at(0), at(2), at(4), at(6)}, {at(1) / 2, at(3) / 2, at(5) / 2}),
              2, 1e-15);
}

TEST(GainOverNeighbours, OneDisturbedRepetitionOfThreeDoesNotMoveIt) {
  EXPECT_EQ(gain_over_neighbours({3, 3, 3, 3}, {2, 9, 2}), 1.5);
  EXPECT_EQ(gain_over_neighbours({9, 3, 3, 3}, {2, 2, 2}), 1.5);
}

/// Sleeps so long per step [s], its threads sharing the work but for `serial` of it.
/// With `in_turns` the machine gives each only its share: whoever steps beside k others takes
/// k + 1 times as long.
class Sleeper : public Solver {
 public:
  Sleeper(double seconds, double serial, bool in_turns, int threads)
      : seconds_(seconds * (serial + (1 - serial) / threads)), in_turns_(in_turns) {
    ++made;
  }
  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene&, const State&) override {}
  TimeStep choose_time_step() override { return {}; }
  StepReport advance_through(Stage, double) override {
    const int at_once = ++stepping;
    std::this_thread::sleep_for(
        std::chrono::duration<double>(seconds_ * (in_turns_ ? at_once : 1)));
    --stepping;
    return {};
  }
  void store(State&) const override {}

  static inline std::atomic<int> stepping = 0, made = 0;

 private:
  double seconds_;
  bool in_turns_;
  SolverTraits traits_;
};

std::vector<results::Quantity> measure_sleepers(double seconds, double serial, bool in_turns,
                                                Rounds rounds) {
  Registry registry;
  registry.add(
      {"sleeper", "", {Precision::float64}, [=](const SolverOptions& o) -> std::unique_ptr<Solver> {
         return std::make_unique<Sleeper>(seconds, serial, in_turns, o.threads);
       }});
  const Workload work = block(8, Deformation::elastic, 1);
  return measure_efficiency(registry, {"sleeper", Precision::float64, 2}, work, rounds);
}

// A sleep lasts 0.1 ms too long, on a busy machine 1 ms: of 20 and 12.5 ms that makes 3 % of
// their ratio. The medians are far from 0.5 and 1, which a factor forgotten would give. When
// the machine stands still for a moment a measurement is spoilt, but not five of them.
constexpr double slack = 0.1;
constexpr int attempts = 5;

TEST(ThreadEfficiency, IsThatOfASolverWithASerialQuarter) {
  const double efficiency = 1 / (2 * (0.25 + 0.75 / 2)), copies = 1, nanoseconds = 2e7 / 8;
  const auto near = [](const results::Quantity& q, double expected) {
    return std::abs(median(q.values) / expected - 1) <= slack;
  };
  std::vector<results::Quantity> q;
  bool good = false;
  for (int i = 0; i < attempts && !good; ++i) {
    Sleeper::made = 0;
    q = measure_sleepers(0.02, 0.25, false, {5, 3, 0.02});
    ASSERT_EQ(q.size(), 6u);
    good = near(q[0], efficiency) && near(q[1], copies) && near(q[2], efficiency) &&
           near(q[4], nanoseconds);
  }
  EXPECT_EQ(q[0].name, "efficiency");
  EXPECT_EQ(q[1].name, "efficiency of independent copies");
  EXPECT_EQ(q[2].name, "efficiency over that of copies");
  EXPECT_TRUE(good) << median(q[0].values) << ", " << median(q[1].values) << ", "
                    << median(q[2].values) << ", " << median(q[4].values) << " ns";
  // One independent value per round, each of solvers made anew: one with two threads, two copies.
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(q[i].values.size(), 5u) << q[i].name;
  EXPECT_EQ(Sleeper::made, 5 * 3);
  // The times keep every repetition.
  EXPECT_EQ(q[3].values.size(), 5u * 3);
  EXPECT_EQ(q[4].values.size(), 5u * 4);
  EXPECT_EQ(q[5].values.size(), 5u * 3);
}

/// Copies step at the same time: where the machine gives two of them no more than one, each
/// takes twice as long. (The last one steps alone for a moment.)
TEST(ThreadEfficiency, CopiesStepAtTheSameTime) {
  double copies = 0;
  for (int i = 0; i < attempts && !(copies > 0.4 && copies < 0.7); ++i)
    copies = median(measure_sleepers(0.003, 0, true, {3, 3, 0.045})[1].values);
  EXPECT_GT(copies, 0.4);
  EXPECT_LT(copies, 0.7);
}

/// So many copies as a machine with many processors would need are not made.
TEST(ThreadEfficiency, TooManyParticlesForCopiesLeaveThemOut) {
  Sleeper::made = 0;
  const std::vector<results::Quantity> q = measure_sleepers(1e-3, 0, false, {3, 3, 1e-3, 15});
  ASSERT_EQ(q.size(), 3u);  // two copies of 8 particles are one too many
  EXPECT_EQ(q[0].name, "efficiency");
  EXPECT_EQ(q[0].values.size(), 3u);
  EXPECT_EQ(q[1].name, "time");
  EXPECT_EQ(q[2].name, "time of one thread");
  EXPECT_EQ(Sleeper::made, 3 * 2);
}

/// Threads that wait busily for their next work are not measured with what comes next.
TEST(WaitForRest, ReturnsWhenABusyThreadIsDone) {
  bool waited = false;
  // Where others use all processors, a busy thread may rest as long as one that is done.
  for (int i = 0; i < attempts && !waited; ++i) {
    std::atomic<bool> started = false, done = false;
    std::thread busy([&] {
      started = true;
      const double start = seconds_now();
      while (seconds_now() - start < 0.05) {
      }
      done = true;
    });
    while (!started) std::this_thread::yield();
    wait_for_rest();
    waited = done;
    busy.join();
  }
  EXPECT_TRUE(waited);
}

}  // namespace
}  // namespace firn::bench
