// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimized/implicit/minres.hpp"

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

/// vectors.v = v*; returns its norm.
template <class S>
double start_from_v_star(const LinearSystem<S>& system) {
  return std::sqrt(sum_over_nodes(system, [&](std::size_t n, ThreadSums<S>&) {
    const NodeMotion<S>& node = system.memory.motion[n];
    double* const v = system.vectors.v[n];
    double sum = 0;
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < nodes_per_block; ++k) {
        const auto v_star = static_cast<double>(node.v_star[a][k]);
        v[a * nodes_per_block + k] = v_star;
        sum += static_cast<double>(node.m[k]) * v_star * v_star;
      }
    return sum;
  }));
}

template <class S>
double mass_of_nodes(const LinearSystem<S>& system) {
  return sum_over_nodes(system, [&](std::size_t n, ThreadSums<S>&) {
    double sum = 0;
    for (const S m : system.memory.motion[n].m) sum += static_cast<double>(m);
    return sum;
  });
}

/// vectors.z = P (v* − B v), found in double, in units of `unit`; returns its norm, without these.
template <class S>
double find_residual(const LinearSystem<S>& system, double unit) {
  const SolveVectors<S>& vectors = system.vectors;
  for_each_node_block(system, [&](std::size_t n) {
    system.kernels.hessian_in_double.pack(vectors.v[n], vectors.in_double.gathered[n]);
  });
  apply_hessian<double>(system);
  return std::sqrt(sum_over_nodes(system, [&](std::size_t n, ThreadSums<S>& sums) {
    const double* const Hv = hessian_at<double>(system, n, sums);
    const double* const v = vectors.v[n];
    alignas(cache_line) double r[field_size];
    const NodeMotion<S>& node = system.memory.motion[n];
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < nodes_per_block; ++k) {
        const int i = a * nodes_per_block + k;
        const auto m = static_cast<double>(node.m[k]);
        const auto v_star = static_cast<double>(node.v_star[a][k]);
        r[i] = m > 0 ? v_star - v[i] - system.factor * Hv[i] / m : 0.0;
      }
    if (const double* const P = system.memory.free.exact(n))
      system.kernels.fields_in_double.project(P, r);
    double sum = 0;
    for (int i = 0; i < field_size; ++i) {
      sum += static_cast<double>(node.m[i % nodes_per_block]) * r[i] * r[i];
      vectors.z[n][i] = static_cast<S>(r[i] / unit);
    }
    return sum;
  }));
}

/// v += size d.
template <class S>
void add_correction(const LinearSystem<S>& system, double size) {
  for_each_node_block(system, [&](std::size_t n) {
    double* const v = system.vectors.v[n];
    const S* const d = system.vectors.d[n];
    for (int i = 0; i < field_size; ++i) v[i] += size * static_cast<double>(d[i]);
  });
}

/// v^{n+1} = v, in the place of v*.
template <class S>
void keep_solution(const LinearSystem<S>& system) {
  for_each_node_block(system, [&](std::size_t n) {
    const double* const v = system.vectors.v[n];
    S* const solution = &system.memory.motion[n].v_star[0][0];
    for (int i = 0; i < field_size; ++i) solution[i] = static_cast<S>(v[i]);
  });
}

}  // namespace

template <class S>
SolveReport solve(const LinearSystem<S>& system, double tolerance, std::int64_t max_iterations) {
  using Status = SolveReport::Status;
  const double v_star_norm = start_from_v_star(system);
  // A speed of the scene's size: a small residual is no reason for a float to underflow.
  const double unit = v_star_norm > 0 ? v_star_norm / std::sqrt(mass_of_nodes(system)) : 1;

  SolveReport report;
  double last_size = std::numeric_limits<double>::infinity(), promised = last_size;
  bool in_float = true;
  constexpr bool may_widen = sizeof(S) > sizeof(float);
  const std::int64_t most_in_float =
      may_widen ? max_iterations - max_iterations / 2 : max_iterations;
  while (true) {
    const double size = find_residual(system, unit);
    report.residual = size > 0 ? size / v_star_norm : 0;
    if (!std::isfinite(size) || !std::isfinite(report.residual)) {
      report.status = Status::not_finite;
      return report;
    }
    if (size <= tolerance * v_star_norm) break;
    if (may_widen && in_float &&
        (report.indefinite || size > std::min(shortfall_allowed * promised, last_size) ||
         report.iterations >= most_in_float))
      // Roundoff costs more iterations than a float saves, and tells nothing about curvature.
      in_float = report.indefinite = false;
    else if (!(size < last_size))
      report.status = Status::stagnates;
    if (report.iterations >= max_iterations) report.status = Status::out_of_iterations;
    if (report.status != Status::converged) return report;
    last_size = size;

    double target = tolerance * v_star_norm / size;
    if (in_float) target = reduction_of_round(target);
    const MinresResult round =
        in_float ? minres<float>(system, unit / size, target, most_in_float - report.iterations)
                 : minres<S>(system, unit / size, target, max_iterations - report.iterations);
    report.iterations += round.iterations;
    report.indefinite |= round.indefinite;
    promised = target * size;
    add_correction(system, size);
  }
  keep_solution(system);
  return report;
}

template SolveReport solve(const LinearSystem<float>&, double, std::int64_t);
template SolveReport solve(const LinearSystem<double>&, double, std::int64_t);

}  // namespace firn::optimized
