// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Rotations by an angle, without the C library's sine and cosine: those of
/// glibc and of WebAssembly's musl differ in the last bit.

#include "firn/types.hpp"

namespace firn {

struct SineCosine {
  double sine, cosine;
};

/// sin θ and cos θ to 2 eps + eps·|θ|, as θ itself is only known to eps·|θ| [rad].
SineCosine sine_cosine(double angle);

/// R turning by `angle` [rad] about the unit vector `axis` (right hand).
Mat3 rotation_about(const Vec3& axis, double angle);

}  // namespace firn
