// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/minres.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace firn::optimized {

namespace {

/// z and the operator's input from the residual; everything else 0.
template <class T, class S>
void start(const LinearSystem<S>& system, double scale) {
  const SolveVectors<S>& vectors = system.vectors;
  const HessianKernels<T, S>& kernels = system.kernels.template hessian<T>();
  for_each_node_block(system, [&](std::size_t n) {
    for (const FieldVector<S>& zero : {vectors.z_last, vectors.w_last, vectors.w, vectors.d})
      std::fill_n(zero[n], field_size, S(0));
    S* const r = vectors.z[n];
    for (int i = 0; i < field_size; ++i) r[i] = static_cast<S>(scale * static_cast<double>(r[i]));
    kernels.pack(r, vectors.template in<T>().gathered[n]);
  });
}

}  // namespace

/// Here the Lanczos vectors z stay unnormalised, and β is divided out later.
template <class T, class S>
MinresResult minres(const LinearSystem<S>& system, double scale, double target,
                    std::int64_t max_iterations) {
  const HessianKernels<T, S>& hessian = system.kernels.template hessian<T>();
  const FieldKernels<S>& fields = system.kernels.fields;
  const Pieces<T> gathered = system.vectors.template in<T>().gathered;
  const NodeMotion<S>* const motion = system.memory.motion.data();
  start<T>(system, scale);

  FieldVector<S> z = system.vectors.z, z_last = system.vectors.z_last;
  FieldVector<S> w = system.vectors.w, w_last = system.vectors.w_last;
  const FieldVector<S> d = system.vectors.d;
  double beta = 1, beta_last = 1;  // norms of z and z_last
  double residual = 1;             // with a sign
  double c_last = 1, c = 1, s_last = 0, s = 0;
  double pivot = 1;  // of the tridiagonal matrix: all positive if it is positive definite
  MinresResult result;
  for (std::int64_t k = 0; k < max_iterations && std::abs(residual) > target; ++k) {
    ++result.iterations;
    apply_hessian<T>(system);
    const double ratio = k == 0 ? 0 : beta / beta_last;
    const double alpha = sum_over_nodes(system, [&](std::size_t n, ThreadSums<S>& sums) {
      return fields.multiply(z[n], hessian_at<T>(system, n, sums), motion[n].m, system.factor,
                             1 / beta, ratio, z_last[n]);
    });
    const double beta_next = std::sqrt(sum_over_nodes(system, [&](std::size_t n, ThreadSums<S>&) {
      S* const next = z_last[n];
      const double square =
          fields.subtract(alpha / beta, z[n], system.memory.free.rounded(n), motion[n].m, next);
      hessian.pack(next, gathered[n]);
      return square;
    }));
    const double off_diagonal = k == 0 ? 0 : beta;
    pivot = alpha - (k == 0 ? 0 : beta * beta / pivot);
    if (pivot <= 0) {
      result.indefinite = true;
      // Or roundoff, which then may keep the residual from falling at all: the caller goes on in S.
      if constexpr (sizeof(T) < sizeof(S)) return result;
    }

    const double rho_3 = s_last * off_diagonal;
    const double rho_2 = s * alpha + c_last * c * off_diagonal;
    const double delta = c * alpha - c_last * s * off_diagonal;
    const double rho_1 = std::sqrt(delta * delta + beta_next * beta_next);
    if (!(rho_1 > 0)) break;  // B is singular on this space (or not finite): no better d in it
    c_last = c;
    s_last = s;
    c = delta / rho_1;
    s = beta_next / rho_1;
    for_each_node_block(system, [&](std::size_t n) {
      fields.advance(z[n], 1 / (beta * rho_1), rho_3 / rho_1, rho_2 / rho_1, c * residual, w[n],
                     w_last[n], d[n]);
    });
    residual *= -s;
    if (!(beta_next > 0)) break;  // the Krylov space is exhausted: d is exact
    std::swap(w_last, w);
    std::swap(z_last, z);
    beta_last = beta;
    beta = beta_next;
  }
  return result;
}

template MinresResult minres<float>(const LinearSystem<float>&, double, double, std::int64_t);
template MinresResult minres<float>(const LinearSystem<double>&, double, double, std::int64_t);
template MinresResult minres<double>(const LinearSystem<double>&, double, double, std::int64_t);

}  // namespace firn::optimized
