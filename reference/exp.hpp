// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The exponential function of the hardening law.

namespace firn::reference {

/// eˣ within 1 unit in the last place; +∞ on overflow, NaN for NaN. The libraries
/// of different platforms disagree in the last bit of std::exp; this one uses
/// only operations that IEEE 754 fixes, so that all of them compute the same simulation.
double exp(double x);

}  // namespace firn::reference
