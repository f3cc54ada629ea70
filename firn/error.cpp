// SPDX-License-Identifier: BSD-3-Clause
#include "firn/error.hpp"

#include <cstdio>
#include <cstdlib>

namespace firn {

InputError::InputError(const std::string& where, const std::string& what, const std::string& value,
                       const std::string& allowed)
    : std::runtime_error(where + ": " + what + ": got " + value + ", allowed: " + allowed) {}

namespace {

std::string describe(Stage stage, SimulationError::Subject subject, std::int64_t index,
                     const std::string& what) {
  std::string text =
      "stage " + std::to_string(number(stage)) + " (" + std::string(name(stage)) + ")";
  if (subject == SimulationError::Subject::particle && index >= 0)
    text += ", particle " + std::to_string(index);
  if (subject == SimulationError::Subject::node && index >= 0)
    text += ", node " + std::to_string(index);
  return text + ": " + what;
}

}  // namespace

SimulationError::SimulationError(Stage stage, Subject subject, std::int64_t index,
                                 const std::string& what)
    : std::runtime_error(describe(stage, subject, index, what)),
      stage_(stage),
      subject_(subject),
      index_(index) {}

std::string to_text(double value) {
  char buffer[32];
  for (int digits = 6; digits <= 17; ++digits) {
    (void)std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);  // 32 characters are enough
    if (std::strtod(buffer, nullptr) == value) break;
  }
  return buffer;
}

}  // namespace firn
