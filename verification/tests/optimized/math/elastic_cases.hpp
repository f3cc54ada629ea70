// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What the tests of the elastic kernels share: units of roundoff, samples near the elastic
/// box, and the line that FIRN_PRINT_ERRORS asks for.

#include <cstdio>
#include <cstdlib>

#include "verification/oracles/elastic_oracle.hpp"
#include "verification/oracles/svd_families.hpp"
#include "verification/tests/optimized/math/kernel_fixture.hpp"

namespace firn::verification {

inline constexpr double theta_c = 2.5e-2, theta_s = 7.5e-3;  // the paper's snow

inline void report(const char* target, const char* type, const char* what, const Spread& spread) {
  if (std::getenv("FIRN_PRINT_ERRORS"))
    std::printf("%-7s %-6s %-44s largest %6.2f  99.9 %% %6.2f\n", target, type, what,
                spread.largest(), spread.quantile(0.999));
}

template <class T>
const char* type_name() {
  return sizeof(T) == 4 ? "float" : "double";
}

/// F − I
inline Matrix minus_identity(Matrix F) {
  F[0] -= 1, F[4] -= 1, F[8] -= 1;
  return F;
}

/// F with singular values inside or near the elastic box, turned by any rotation.
inline Matrix near_the_box(Random& r) {
  const double a = 1 - 1.2 * theta_c, b = 1 + 1.5 * theta_s;
  return with_singular_values(r, r.uniform(a, b), r.uniform(a, b), r.uniform(a, b));
}

}  // namespace firn::verification
