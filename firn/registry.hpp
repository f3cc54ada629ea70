#pragma once
/// Solvers by name. Nothing registers itself: the composition root
/// (solvers/solvers.cpp) names the built-in ones, a third party adds its own
/// by one explicit call.

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firn/solver.hpp"

namespace firn {

struct SolverOptions {
  Precision precision = Precision::float64;
  int threads = 1;  ///< ≥ 1; the result does not depend on it
};

struct SolverEntry {
  std::string name;
  std::string description;            ///< one line
  std::vector<Precision> precisions;  ///< those that it supports
  bool semi_implicit = false;
  std::function<std::unique_ptr<Solver>(const SolverOptions&)> create;
};

class Registry {
 public:
  /// Throws std::logic_error if the name is taken.
  void add(SolverEntry entry);

  const std::vector<SolverEntry>& entries() const { return entries_; }

  /// Null if there is none of that name.
  const SolverEntry* find(std::string_view name) const;

  /// Throws InputError for an unknown name or a precision the solver lacks.
  std::unique_ptr<Solver> create(std::string_view name, const SolverOptions& options) const;

 private:
  std::vector<SolverEntry> entries_;
};

std::string_view name(Precision precision);  ///< "double" or "float"

}  // namespace firn
