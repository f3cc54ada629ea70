/// The solve itself: MINRES in the solver's own precision inside an iterative refinement
/// whose residuals are found in double.

#include <algorithm>
#include <cmath>
#include <limits>
#include <omp.h>
#include <utility>

#include "optimized/implicit/system.hpp"

namespace firn::optimized {

namespace {

/// By how much one round of float iterations reduces the residual before it is found
/// anew; a round in double goes all the way.
template <class S>
constexpr double reduction_per_round = sizeof(S) == 4 ? 1e-2 : 0.0;

}  // namespace

template <class S>
template <class F>
double ImplicitSystem<S>::sum_over_nodes(const F& f) {
  const int n = static_cast<int>(node_blocks());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < n; ++i)
    partial_[static_cast<std::size_t>(i)] =
        f(static_cast<std::size_t>(i), thread_[static_cast<std::size_t>(omp_get_thread_num())]);
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += partial_[static_cast<std::size_t>(i)];
  return sum;
}

/// r = P (v* − B v) in double; returns its norm squared.
template <class S>
double ImplicitSystem<S>::residual() {
  const HessianKernels<double, S>& kernels = hessian_kernels<double, S>();
  sum_over_nodes([&](std::size_t n, Thread&) {
    kernels.pack(v_.data() + n * field_size, gathered<double>(n));
    return 0.0;
  });
  apply<double>();
  return sum_over_nodes([&](std::size_t n, Thread& thread) {
    const double* const Hv = applied<double>(n, thread);
    const double* const v = v_.data() + n * field_size;
    double* const r = residual_.data() + n * field_size;
    const NodeFields<S>& node = nodes_->fields(n);
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < nodes_per_block; ++k) {
        const int i = a * nodes_per_block + k;
        const auto m = static_cast<double>(node.m[k]);
        r[i] = m > 0 ? static_cast<double>(node.v_star[a][k]) - v[i] - factor_ * Hv[i] / m : 0.0;
      }
    if (held(n)) {
      alignas(64) double P[matrix_size];
      const S* const projector = projector_.data() + n * matrix_size;
      for (int k = 0; k < matrix_size; ++k) P[k] = static_cast<double>(projector[k]);
      field_kernels<double>().project(P, r);
    }
    double sum = 0;
    for (int i = 0; i < field_size; ++i)
      sum += static_cast<double>(node.m[i % nodes_per_block]) * r[i] * r[i];
    return sum;
  });
}

/// H annihilates constants, so that Σ m v falls short of Σ m v* by exactly Σ m r, and
/// v plus the mean of r has the right momentum at any tolerance: for every body that
/// contact holds nowhere. Returns by how much the squared norm of r shrinks.
template <class S>
double ImplicitSystem<S>::restore_momentum() {
  std::fill(component_mass_.begin(), component_mass_.end(), 0.0);
  std::fill(component_momentum_.begin(), component_momentum_.end(), 0.0);
  for (std::size_t n = 0; n < node_blocks(); ++n) {
    const auto c = static_cast<std::size_t>(component_[n]);
    if (held(n)) component_held_[c] = 1;
    const double* const r = residual_.data() + n * field_size;
    const NodeFields<S>& node = nodes_->fields(n);
    for (int k = 0; k < nodes_per_block; ++k) {
      const auto m = static_cast<double>(node.m[k]);
      component_mass_[c] += m;
      for (std::size_t a = 0; a < 3; ++a)
        component_momentum_[3 * c + a] += m * r[static_cast<int>(a) * nodes_per_block + k];
    }
  }
  double shrinks = 0;
  for (std::size_t c = 0; c < component_mass_.size(); ++c)
    for (std::size_t a = 0; a < 3; ++a) {
      const bool moves = component_held_[c] == 0 && component_mass_[c] > 0;
      double& mean = component_momentum_[3 * c + a];
      mean = moves ? mean / component_mass_[c] : 0;
      shrinks += component_mass_[c] * mean * mean;
    }
  sum_over_nodes([&](std::size_t n, Thread&) {
    const auto c = static_cast<std::size_t>(component_[n]);
    const NodeFields<S>& node = nodes_->fields(n);
    for (std::size_t a = 0; a < 3; ++a)
      for (int k = 0; k < nodes_per_block; ++k) {
        if (!(node.m[k] > 0)) continue;
        const std::size_t i = n * field_size + a * nodes_per_block + static_cast<std::size_t>(k);
        v_[i] += component_momentum_[3 * c + a];
        residual_[i] -= component_momentum_[3 * c + a];
      }
    return 0.0;
  });
  return shrinks;
}

/// Preconditioned MINRES (Paige and Saunders 1975; Choi 2006, section 3.2 for the residual)
/// in the inner product Σ m a·b, in which B and the preconditioner are self-adjoint: no
/// definiteness of B is asked for. The Lanczos vectors are z (dual) and y = T z (primal).
template <class S>
void ImplicitSystem<S>::minres(double target, std::int64_t max_iterations, SolveReport& report) {
  const HessianKernels<S, S>& hessian = hessian_kernels<S, S>();
  const FieldKernels<S>& fields = field_kernels<S>();
  const auto preconditioned = [&](std::size_t n, const S* z, S* y) {
    const S* const inverse = block_preconditioner_ ? inverse_.data() + n * matrix_size : nullptr;
    const double zy = fields.precondition(inverse, z, nodes_->fields(n).m, y);
    hessian.pack(y, gathered<S>(n));
    return zy;
  };

  double beta = std::sqrt(sum_over_nodes([&](std::size_t n, Thread&) {
    const S* const r = block(r_, n);
    std::copy_n(r, field_size, block(z_, n));
    for (const AlignedArray<S>* zero : {&z_last_, &w_last_, &w_, &d_})
      std::fill_n(block(*zero, n), field_size, S(0));
    return preconditioned(n, r, block(y_, n));
  }));
  double beta_last = 1, dbar = 0, epsilon = 0, phi_bar = beta, c = -1, s = 0;
  double pivot = 1, size = 1;  // of the tridiagonal matrix; norm of r_
  for (std::int64_t k = 0; k < max_iterations && size > target && beta > 0; ++k) {
    ++report.iterations;
    apply<S>();
    const double ratio = k == 0 ? 0 : beta / beta_last;
    const double alpha = sum_over_nodes([&](std::size_t n, Thread& thread) {
      const S* const f = applied<S>(n, thread);
      return fields.multiply(block(y_, n), f, nodes_->fields(n).m, factor_, 1 / beta, ratio,
                             block(z_last_, n));
    });
    const double beta_next_squared = sum_over_nodes([&](std::size_t n, Thread&) {
      S* const z = block(z_last_, n);
      fields.subtract(alpha / beta, block(z_, n), z);
      if (held(n)) fields.project(projector_.data() + n * matrix_size, z);
      return preconditioned(n, z, block(y_next_, n));
    });
    const double beta_next = std::sqrt(std::max(beta_next_squared, 0.0));
    pivot = alpha - (k > 0 ? beta * beta / pivot : 0);
    if (pivot <= 0) report.indefinite = true;

    const double epsilon_last = epsilon, delta = c * dbar + s * alpha;
    const double gamma_bar = s * dbar - c * alpha;
    epsilon = s * beta_next;
    dbar = -c * beta_next;
    const double gamma = std::hypot(gamma_bar, beta_next);
    if (!(gamma > 0)) break;  // B is singular on this space (or not finite): no better d in it
    c = gamma_bar / gamma;
    s = beta_next / gamma;
    const double phi = c * phi_bar;
    phi_bar *= s;
    const double lose = beta_next > 0 ? phi_bar * c / beta_next : 0;
    size = std::sqrt(sum_over_nodes([&](std::size_t n, Thread&) {
      return fields.advance(block(y_, n), 1 / beta, epsilon_last, delta, gamma, phi, s * s, lose,
                            block(z_last_, n), block(w_, n), nodes_->fields(n).m, block(w_last_, n),
                            block(d_, n), block(r_, n));
    }));
    std::swap(w_last_, w_);
    std::swap(z_last_, z_);
    std::swap(y_, y_next_);
    beta_last = beta;
    beta = beta_next;
  }
}

template <class S>
SolveReport ImplicitSystem<S>::solve(double tolerance, std::int64_t max_iterations) {
  const double v_star_norm = std::sqrt(sum_over_nodes([&](std::size_t n, Thread&) {
    const NodeFields<S>& node = nodes_->fields(n);
    double sum = 0;
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < nodes_per_block; ++k) {
        const auto v = static_cast<double>(node.v_star[a][k]);
        v_[n * field_size + static_cast<std::size_t>(a * nodes_per_block + k)] = v;
        sum += static_cast<double>(node.m[k]) * v * v;
      }
    return sum;
  }));
  SolveReport report;
  double last_size = std::numeric_limits<double>::infinity();
  for (int round = 0;; ++round) {
    double size2 = residual();
    if (round > 0 && block_preconditioner_) size2 -= restore_momentum();
    const double size = std::sqrt(std::max(size2, 0.0));
    report.residual = size > 0 ? size / v_star_norm : 0;
    if (!std::isfinite(size) || !std::isfinite(report.residual)) {
      report.status = SolveReport::Status::not_finite;
      return report;
    }
    if (size <= tolerance * v_star_norm) break;
    if (!(size < last_size)) report.status = SolveReport::Status::stagnates;
    if (report.iterations >= max_iterations) report.status = SolveReport::Status::out_of_iterations;
    if (report.status != SolveReport::Status::converged) return report;
    last_size = size;

    // In units of its size: a small residual is no reason for a float to underflow.
    sum_over_nodes([&](std::size_t n, Thread&) {
      for (std::size_t i = n * field_size; i < (n + 1) * field_size; ++i)
        r_[i] = static_cast<S>(residual_[i] / size);
      return 0.0;
    });
    minres(std::max(tolerance * v_star_norm / size, reduction_per_round<S>),
           max_iterations - report.iterations, report);
    sum_over_nodes([&](std::size_t n, Thread&) {
      for (std::size_t i = n * field_size; i < (n + 1) * field_size; ++i)
        v_[i] += size * static_cast<double>(d_[i]);
      return 0.0;
    });
  }
  sum_over_nodes([&](std::size_t n, Thread&) {
    NodeFields<S>& node = nodes_->fields(n);
    for (int i = 0; i < field_size; ++i)
      node.v_star[i / nodes_per_block][i % nodes_per_block] =
          static_cast<S>(v_[n * field_size + static_cast<std::size_t>(i)]);
    return 0.0;
  });
  return report;
}

template SolveReport ImplicitSystem<float>::solve(double, std::int64_t);
template SolveReport ImplicitSystem<double>::solve(double, std::int64_t);

}  // namespace firn::optimized
