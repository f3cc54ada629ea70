// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The two ways in which Firn fails: invalid input (exit 2, nothing written) and a
/// failed simulation (exit 3, last good state kept). io/output_error.hpp has a third. A solver
/// that does not do what a scene asks for says so by Unsupported.

#include <cstdint>
#include <stdexcept>
#include <string>

#include "firn/stage.hpp"

namespace firn {

/// Invalid input or usage. what() is one line: where, what, the value, the allowed range.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// "WHERE: WHAT: got VALUE, allowed: RANGE"
  InputError(const std::string& where, const std::string& what, const std::string& value,
             const std::string& allowed);
};

/// The solver does not do what the scene asks for, by its traits or in its own words. No fault
/// of either: where many scenes are tried, this one does not apply; a single one is the user's
/// mistake (exit 2).
class Unsupported : public InputError {
 public:
  using InputError::InputError;
};

/// A step that could not be completed: a non-finite value, a solver that did
/// not converge, a particle outside the representable domain.
class SimulationError : public std::runtime_error {
 public:
  enum class Subject { particle, node, solver };

  /// `index`: particle index in the caller's order, or the place of the node in
  /// the sorted node list; −1 where neither applies.
  SimulationError(Stage stage, Subject subject, std::int64_t index, const std::string& what);

  Stage stage() const { return stage_; }
  Subject subject() const { return subject_; }
  std::int64_t index() const { return index_; }

  /// True: the solver still holds the state from before the failed step, and
  /// store() gives it. False: the solver must be loaded again.
  bool state_intact = false;

 private:
  Stage stage_;
  Subject subject_;
  std::int64_t index_;
};

/// Shortest decimal text that reads back as the same double.
std::string to_text(double value);

}  // namespace firn
