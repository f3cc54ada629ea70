// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The built-in solvers, by name.

#include <memory>

#include "firn/registry.hpp"
#include "solvers/solvers.hpp"

namespace firn::fixtures {

inline const Registry& builtin_registry() {
  static const Registry registry = [] {
    Registry all;
    register_solvers(all);
    return all;
  }();
  return registry;
}

inline std::unique_ptr<Solver> make_reference() {
  return builtin_registry().create(reference_name, {});
}

}  // namespace firn::fixtures
