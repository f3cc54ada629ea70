// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How much of n processors n threads use, as a figure that another run reproduces.

#include <vector>

#include "bench/bench.hpp"
#include "bench/step_case.hpp"

namespace firn::bench {

/// What two processors give is not constant: on a virtual machine one of them may have a busy
/// neighbour for seconds. And a solver may owe some of its speed to where its memory happens to
/// lie, for as long as it lives (twins with the same work differed by 1 %). So an efficiency
/// comes from several rounds, each with solvers made anew; in a round one thread, all threads
/// and independent copies take turns, briefly, and each is judged by its neighbours in time.
///
/// Repetitions in one round share their memory and their second: together they are one draw.
/// The case's value is therefore one per round, the median of its repetitions, and the spread
/// by which the case is judged is that between rounds. All repetitions thrown together would
/// claim an error too small by up to the root of their number in a round. What lasts longer
/// than the case, its rounds share, too: it shows in the copies, and cancels in the efficiency
/// over theirs.
struct Rounds {
  int rounds;
  int repetitions;  ///< of each in a round
  double seconds;   ///< of one repetition, at least
  /// Particles of all copies together, at most; beyond, none are made but the one that runs
  /// alone, and what they would tell is left out. 16 M fill some 5 GB (double), which has to
  /// be loaded anew in every round; 64 copies of a large block would fill a machine.
  std::size_t most_copied = 16'000'000;
};

/// Seconds of one step in one round: alone[k] ran before, alone[k + 1] after all[k] and
/// copies[k].
struct Round {
  std::vector<double> alone, all, copies;
};

/// Median over k of (alone[k] + alone[k + 1]) / 2 over other[k]: what drifts evenly cancels,
/// and one disturbed repetition of three or more does not move it.
double gain_over_neighbours(const std::vector<double>& alone, const std::vector<double>& other);

/// Waits until no thread of this process uses a processor, at most a second. Threads that
/// shared a loop wait for the next one for a while before they sleep (libgomp some ms, libomp
/// 200 ms), and would take their processors from whoever is measured next.
void wait_for_rest();

/// One round of `subject` with its threads, of as many copies of it with one thread each, and
/// of one such copy alone.
Round measure_round(const Registry& registry, const Subject& subject, const Workload& work,
                    const Rounds& rounds);

/// The quantities of `rounds` such rounds.
std::vector<results::Quantity> measure_efficiency(const Registry& registry, const Subject& subject,
                                                  const Workload& work, const Rounds& rounds);

}  // namespace firn::bench
