// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Solvers by name: the one door to every solver. Nothing registers itself: the composition
/// root (solvers/solvers.cpp) names those that come with Firn, a third party adds its own by
/// one explicit call.

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firn/solver.hpp"

namespace firn {

struct SolverOptions {
  Precision precision = Precision::float64;
  int threads = 1;         ///< ≥ 1; the result does not depend on it
  double time_limit = 60;  ///< for each answer of a solver in a process of its own [s], > 0
};

/// One solver.
struct SolverEntry {
  std::string name;
  std::string description;            ///< one line
  std::vector<Precision> precisions;  ///< those that it supports
  std::function<std::unique_ptr<Solver>(const SolverOptions&)> create;
};

/// The name of the solver that others are judged against.
inline constexpr const char* reference_name = "reference";

/// Solvers that are made from what their name says: "mutant:NAME", "./LIBRARY.so".
struct SolverFamily {
  std::string form;         ///< as messages and help print it: "mutant:NAME"
  std::string description;  ///< one line
  std::function<bool(const std::string& name)> has;
  /// Throws InputError for a name or options that do not exist in the family.
  std::function<std::unique_ptr<Solver>(const std::string& name, const SolverOptions&)> create;
};

/// For SolverFamily::has.
std::function<bool(const std::string&)> begins_with(std::string prefix);

class Registry {
 public:
  /// Throws std::logic_error if the name is taken.
  void add(SolverEntry entry);

  /// Registered names come first, then families in the order in which they were added.
  void add_family(SolverFamily family);

  const std::vector<SolverEntry>& entries() const { return entries_; }
  const std::vector<SolverFamily>& families() const { return families_; }

  /// Null if no single solver has that name; families are not searched.
  const SolverEntry* find(std::string_view name) const;

  /// By name or by family. Throws InputError for an unknown name or a precision that the
  /// solver lacks.
  std::unique_ptr<Solver> create(const std::string& name, const SolverOptions& options) const;

  /// What create() would make, in the first precision that it supports.
  SolverTraits traits(const std::string& name) const;

 private:
  std::vector<SolverEntry> entries_;
  std::vector<SolverFamily> families_;
};

std::string_view name(Precision precision);  ///< "double" or "float"

}  // namespace firn
