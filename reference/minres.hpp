// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// MINRES for node fields.

#include <cstdint>
#include <functional>
#include <vector>

#include "firn/types.hpp"

namespace firn::reference {

/// A vector at every node: velocity, residual, search direction.
using NodeField = std::vector<Vec3>;

/// (a, b) = Σ_i m_i a_i·b_i.
double inner_product(const std::vector<double>& m, const NodeField& a, const NodeField& b);

/// y += s x.
void add_scaled(double s, const NodeField& x, NodeField& y);

struct MinresResult {
  std::int64_t iterations = 0;  ///< = applications of B
  bool indefinite = false;      ///< a direction u with (u, B u) ≤ 0 was met
};

/// Adds to x an approximate solution d of B d = r, for an operator B that is
/// self-adjoint in the inner product with the masses m but need not be positive
/// (Paige and Saunders 1975). Among all d in the Krylov space of r it takes the
/// one with the smallest residual; stops when the residual norm, as the
/// recurrence has it, is at most `target`, or after `max_iterations`.
MinresResult minres(const std::function<NodeField(const NodeField&)>& B,
                    const std::vector<double>& m, const NodeField& r, double target,
                    std::int64_t max_iterations, NodeField& x);

}  // namespace firn::reference
