// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The unit of every tolerance that counts roundings.

#include <limits>

namespace firn {

inline constexpr double eps = std::numeric_limits<double>::epsilon();  ///< 2⁻⁵²

}  // namespace firn
