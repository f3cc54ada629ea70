// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// MINRES on blocks and tiles.

#include <cstdint>

#include "optimized/implicit/system.hpp"

namespace firn::optimized {

struct MinresResult {
  std::int64_t iterations = 0;  ///< = applications of B
  bool indefinite = false;      ///< negative curvature was met, or what roundoff takes for it
};

/// MINRES (Paige and Saunders 1975) for B d = r in the inner product Σ m a·b, in which B is
/// self-adjoint; nothing is asked of its definiteness. The operator is applied in type T. On entry
/// vectors.z times `scale` is the residual divided by its norm; on return vectors.d is an
/// approximate solution for that right-hand side. Stops when the norm of the residual, as the
/// recurrence has it, is at most `target`, after `max_iterations`, or, if T is narrower than S, at
/// negative curvature. The reference's minres.cpp has the derivation.
template <class T, class S>
MinresResult minres(const LinearSystem<S>& system, double scale, double target,
                    std::int64_t max_iterations);

}  // namespace firn::optimized
