// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A row of /firn/diagnostics: the state's diagnostics and what the step's solve left.

#include "firn/diagnostics.hpp"

namespace firn {

struct DiagnosticsRow : Diagnostics {
  double solver_residual = 0;  ///< true relative residual of the semi-implicit solve [1]
};

}  // namespace firn
