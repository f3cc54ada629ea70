// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What the solver leaves out where a scene does not need it. Every skip has a
/// switch, so that its effect can be measured and its harmlessness proven.

#include <string>
#include <string_view>

#include "optimized/store/layout.hpp"

namespace firn::optimized {

struct SkipSet {
  KernelSkips kernels;   ///< box, hardening, plastic, rest
  bool contact = true;   ///< contact of blocks out of every collider's reach
  bool friction = true;  ///< the friction law of colliders without friction
  bool volumes = true;   ///< the density sum once every V_p0 is known
  bool material = true;  ///< the material of each particle in scenes with one only
  bool fields = true;    ///< node fields that no later pass reads
  bool empty = true;     ///< nodes that no particle reaches

  /// All but those that FIRN_NO_SKIP names, separated by commas ("all" for all of
  /// them). InputError for an unknown name.
  static SkipSet from_environment();
  static SkipSet from_text(std::string_view names);
};

}  // namespace firn::optimized
