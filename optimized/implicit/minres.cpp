/// The solve itself: MINRES with the operator in float inside an iterative refinement whose
/// residuals are found in double.

#include <algorithm>
#include <cmath>
#include <limits>
#include <omp.h>
#include <utility>

#include "optimized/implicit/system.hpp"

namespace firn::optimized {

namespace {

/// By how much a round with the operator in float may reduce the residual before it is found
/// anew; what is asked is divided evenly among as many rounds as that takes. (1e-3 restarts more
/// often; with 1e-7 rounds go on where roundoff leaves nothing to gain, beyond 100 explicit steps.)
double reduction_of_round(double asked) {
  constexpr double most = 1e-5;
  // A little more than that, lest roundoff make another round necessary.
  const double rest = std::max(0.95 * asked, std::numeric_limits<double>::min());
  return std::pow(rest, 1 / std::ceil(std::log(rest) / std::log(most)));
}

/// A round may reduce the residual by so much less than its recurrence says: up to 200 explicit
/// steps it is a few per cent, in hopeless systems a thousand times and more.
constexpr double shortfall_allowed = 10;

}  // namespace

template <class S>
template <class F>
double ImplicitSystem<S>::sum_over_nodes(const F& f) {
  const int n = static_cast<int>(node_blocks());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int i = 0; i < n; ++i)
    partial_[static_cast<std::size_t>(i)] =
        f(static_cast<std::size_t>(i), sums_[static_cast<std::size_t>(omp_get_thread_num())]);
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += partial_[static_cast<std::size_t>(i)];
  return sum;
}

/// z_ = P (v* − B v), found in double, in units of `unit`; returns its norm squared, without
/// these.
template <class S>
double ImplicitSystem<S>::residual(double unit) {
  sum_over_nodes([&](std::size_t n, Sums&) {
    hessian_in_double_.pack(v_ + n * field_size, gathered<double>(n));
    return 0.0;
  });
  apply<double>();
  return sum_over_nodes([&](std::size_t n, Sums& sums) {
    const double* const Hv = applied<double>(n, sums);
    const double* const v = v_ + n * field_size;
    alignas(cache_line) double r[field_size];
    const NodeMotion<S>& node = motion_[n];
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < nodes_per_block; ++k) {
        const int i = a * nodes_per_block + k;
        const auto m = static_cast<double>(node.m[k]);
        r[i] = m > 0 ? static_cast<double>(node.v_star[a][k]) - v[i] - factor_ * Hv[i] / m : 0.0;
      }
    if (const double* const P = exact_projector(n)) fields_in_double_.project(P, r);
    double sum = 0;
    for (int i = 0; i < field_size; ++i) {
      sum += static_cast<double>(node.m[i % nodes_per_block]) * r[i] * r[i];
      block(z_, n)[i] = static_cast<S>(r[i] / unit);
    }
    return sum;
  });
}

/// MINRES (Paige and Saunders 1975) in the inner product Σ m a·b, in which B is
/// self-adjoint; nothing is asked of its definiteness. The reference's minres.cpp has the
/// derivation; here the Lanczos vectors z stay unnormalised, and β is divided out later.
template <class S>
template <class T>
void ImplicitSystem<S>::minres(double scale, double target, std::int64_t max_iterations,
                               SolveReport& report) {
  sum_over_nodes([&](std::size_t n, Sums&) {
    for (S* const zero : {z_last_, w_last_, w_, d_}) std::fill_n(block(zero, n), field_size, S(0));
    S* const r = block(z_, n);
    for (int i = 0; i < field_size; ++i) r[i] = static_cast<S>(scale * static_cast<double>(r[i]));
    hessian<T>().pack(r, gathered<T>(n));
    return 0.0;
  });
  S *z = z_, *z_last = z_last_, *w = w_, *w_last = w_last_;
  double beta = 1, beta_last = 1;  // norms of z and z_last
  double residual = 1;             // with a sign
  double c_last = 1, c = 1, s_last = 0, s = 0;
  double pivot = 1;  // of the tridiagonal matrix: all positive if it is positive definite
  for (std::int64_t k = 0; k < max_iterations && std::abs(residual) > target; ++k) {
    ++report.iterations;
    apply<T>();
    const double ratio = k == 0 ? 0 : beta / beta_last;
    const double alpha = sum_over_nodes([&](std::size_t n, Sums& sums) {
      return fields_.multiply(block(z, n), applied<T>(n, sums), motion_[n].m, factor_, 1 / beta,
                              ratio, block(z_last, n));
    });
    const double beta_next = std::sqrt(sum_over_nodes([&](std::size_t n, Sums&) {
      S* const next = block(z_last, n);
      const double square =
          fields_.subtract(alpha / beta, block(z, n), projector(n), motion_[n].m, next);
      hessian<T>().pack(next, gathered<T>(n));
      return square;
    }));
    const double off_diagonal = k == 0 ? 0 : beta;
    pivot = alpha - (k == 0 ? 0 : beta * beta / pivot);
    if (pivot <= 0) {
      report.indefinite = true;
      // Or roundoff, which then may keep the residual from falling at all: solve() goes on in S.
      if constexpr (sizeof(T) < sizeof(S)) return;
    }

    const double rho_3 = s_last * off_diagonal;
    const double rho_2 = s * alpha + c_last * c * off_diagonal;
    const double delta = c * alpha - c_last * s * off_diagonal;
    const double rho_1 = std::sqrt(delta * delta + beta_next * beta_next);
    if (!(rho_1 > 0)) return;  // B is singular on this space (or not finite): no better d in it
    c_last = c;
    s_last = s;
    c = delta / rho_1;
    s = beta_next / rho_1;
    sum_over_nodes([&](std::size_t n, Sums&) {
      fields_.advance(block(z, n), 1 / (beta * rho_1), rho_3 / rho_1, rho_2 / rho_1, c * residual,
                      block(w, n), block(w_last, n), block(d_, n));
      return 0.0;
    });
    residual *= -s;
    if (!(beta_next > 0)) return;  // the Krylov space is exhausted: d is exact
    std::swap(w_last, w);
    std::swap(z_last, z);
    beta_last = beta;
    beta = beta_next;
  }
}

template <class S>
SolveReport ImplicitSystem<S>::solve(double tolerance, std::int64_t max_iterations) {
  const double v_star_norm = std::sqrt(sum_over_nodes([&](std::size_t n, Sums&) {
    const NodeMotion<S>& node = motion_[n];
    double sum = 0;
    for (int i = 0; i < field_size; ++i) {
      const auto v = static_cast<double>(node.v_star[i / nodes_per_block][i % nodes_per_block]);
      v_[n * field_size + static_cast<std::size_t>(i)] = v;
      sum += static_cast<double>(node.m[i % nodes_per_block]) * v * v;
    }
    return sum;
  }));
  const double mass = sum_over_nodes([&](std::size_t n, Sums&) {
    double sum = 0;
    for (const S m : motion_[n].m) sum += static_cast<double>(m);
    return sum;
  });
  // A speed of the scene's size: a small residual is no reason for a float to underflow.
  const double unit = v_star_norm > 0 ? v_star_norm / std::sqrt(mass) : 1;

  SolveReport report;
  double last_size = std::numeric_limits<double>::infinity(), promised = last_size;
  bool in_float = true;
  constexpr bool may_widen = sizeof(S) > sizeof(float);
  const std::int64_t most_in_float =
      may_widen ? max_iterations - max_iterations / 2 : max_iterations;
  while (true) {
    const double size = std::sqrt(residual(unit));
    report.residual = size > 0 ? size / v_star_norm : 0;
    if (!std::isfinite(size) || !std::isfinite(report.residual)) {
      report.status = SolveReport::Status::not_finite;
      return report;
    }
    if (size <= tolerance * v_star_norm) break;
    if (may_widen && in_float &&
        (report.indefinite || size > std::min(shortfall_allowed * promised, last_size) ||
         report.iterations >= most_in_float))
      // Roundoff costs more iterations than a float saves, and tells nothing about curvature.
      in_float = report.indefinite = false;
    else if (!(size < last_size))
      report.status = SolveReport::Status::stagnates;
    if (report.iterations >= max_iterations) report.status = SolveReport::Status::out_of_iterations;
    if (report.status != SolveReport::Status::converged) return report;
    last_size = size;

    double target = tolerance * v_star_norm / size;
    if (in_float) {
      target = reduction_of_round(target);
      minres<float>(unit / size, target, most_in_float - report.iterations, report);
    } else {
      minres<S>(unit / size, target, max_iterations - report.iterations, report);
    }
    promised = target * size;
    sum_over_nodes([&](std::size_t n, Sums&) {
      for (std::size_t i = n * field_size; i < (n + 1) * field_size; ++i)
        v_[i] += size * static_cast<double>(d_[i]);
      return 0.0;
    });
  }
  sum_over_nodes([&](std::size_t n, Sums&) {
    for (int i = 0; i < field_size; ++i)
      motion_[n].v_star[i / nodes_per_block][i % nodes_per_block] =
          static_cast<S>(v_[n * field_size + static_cast<std::size_t>(i)]);
    return 0.0;
  });
  return report;
}

template SolveReport ImplicitSystem<float>::solve(double, std::int64_t);
template SolveReport ImplicitSystem<double>::solve(double, std::int64_t);

}  // namespace firn::optimized
