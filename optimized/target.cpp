// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/target.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <hwy/targets.h>

#include "firn/error.hpp"
#include "optimized/implicit/kernel_table.hpp"
#include "optimized/optimized_solver.hpp"
#include "optimized/passes/kernel_table.hpp"

namespace firn {

namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + lower(name);
  return text;
}

}  // namespace

std::vector<std::string> optimized_targets() {
  hwy::SetSupportedTargetsForTest(0);  // all that the processor has
  std::vector<std::string> names;
  for (const auto target : hwy::SupportedAndGeneratedTargets())
    names.push_back(hwy::TargetName(target));
  return names;
}

std::string optimized_target_name() {
  optimized::select_target_from_environment();
  return optimized::float_kernels().target;
}

namespace optimized {

void select_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  if (name.empty()) return;
  for (const auto target : hwy::SupportedAndGeneratedTargets())
    if (lower(hwy::TargetName(target)) == lower(name)) {
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      return;
    }
  throw InputError("FIRN_TARGET", "instruction set", name, list(optimized_targets()));
}

std::vector<std::string> dispatched_targets() {
  return {float_kernels().target, double_kernels().target, setup_kernels_float().target,
          setup_kernels_double().target};
}

void select_target_from_environment() {
  const char* name = std::getenv("FIRN_TARGET");
  select_target(name == nullptr ? "" : name);
}

}  // namespace optimized
}  // namespace firn
