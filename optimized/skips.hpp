#pragma once
/// What the solver leaves out where a scene does not need it. Every skip has a
/// switch, so that its effect can be measured and its harmlessness proven.

#include <string>
#include <string_view>

namespace firn::optimized {

struct SkipSet {
  bool box = true;      ///< return map of particles certified inside the elastic box
  bool contact = true;  ///< collision tests of blocks out of every collider's reach

  /// All but those that FIRN_NO_SKIP names, separated by commas ("all" for all of
  /// them). InputError for an unknown name.
  static SkipSet from_environment();
  static SkipSet from_text(std::string_view names);
};

}  // namespace firn::optimized
