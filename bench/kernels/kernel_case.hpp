// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What all kernel rows share: how they are named, judged and timed.

#include <functional>
#include <string>
#include <vector>

#include "bench/bench.hpp"

namespace firn::bench {

template <class T>
inline constexpr double eps_of = sizeof(T) == 4 ? 0x1p-23 : 0x1p-52;
template <class T>
inline constexpr const char* name_of = sizeof(T) == 4 ? "float" : "double";

/// One row: `kernel` done by `code` on instruction set `target` ("": only one is built).
void plan_kernel(const std::string& kernel, const std::string& code, const std::string& precision,
                 const std::string& target, std::function<void(results::Case&)> run,
                 std::vector<CasePlan>& plans);

/// States what was compared. False, and the case invalid, if `worst` exceeds `allowed`
/// (both in eps) or is not a number.
bool judge(results::Case& result, const std::string& what, double worst, double allowed);

/// Nanoseconds per item of `body`, which treats `items` items, by Google Benchmark: nine
/// repetitions.
void time_body(const std::function<void()>& body, std::size_t items, results::Case& result);

/// The same of a body that says itself how many seconds of it count.
void time_part(const std::function<double()>& seconds, std::size_t items, results::Case& result);

/// Makes an instruction set that of the kernels and of new solvers until it ends, by
/// FIRN_TARGET.
class TargetScope {
 public:
  explicit TargetScope(const std::string& target);
  ~TargetScope();
  TargetScope(const TargetScope&) = delete;
  TargetScope& operator=(const TargetScope&) = delete;

 private:
  std::string before_;
  bool had_ = false;
};

/// The instruction sets of this processor that were built, in lower case, best first.
std::vector<std::string> kernel_targets();

void plan_decompositions(std::uint64_t seed, std::vector<CasePlan>& plans);
void plan_constitutive(std::uint64_t seed, std::vector<CasePlan>& plans);
void plan_weights(std::uint64_t seed, std::vector<CasePlan>& plans);

}  // namespace firn::bench
