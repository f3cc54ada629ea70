// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Why a bound of the error analysis may be as wide as the number itself.

#include <compare>
#include <cstdint>

namespace firn::check {

/// A number whose bound exceeds this part of its field's size is not judged: what is within
/// such a bound is not known to be right.
inline constexpr double widest_judged = 1e-3;

struct Cause {
  enum class Kind : std::uint8_t {
    rounding,    ///< nothing but rounding: the number is small beside the terms it comes from
    light_node,  ///< a node whose mass rounded positions can take away
    contact,     ///< a contact that may have gone one way or another, and it is not known which
    normal,      ///< a collider's normal that may be anything within rounding
    solve,       ///< the tolerance with which the implicit system is solved
    indefinite,  ///< an implicit solve whose matrix is not positive
    singular,    ///< a deformation gradient that is close to a singular or inverted one
    chaos        ///< a perturbation of 1e-10 grows too fast (free running)
  };
  Kind kind = Kind::rounding;
  int collider = -1;  ///< place in Scene::colliders, for contact and normal

  friend auto operator<=>(const Cause&, const Cause&) = default;
};

}  // namespace firn::check
