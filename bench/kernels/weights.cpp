// SPDX-License-Identifier: BSD-3-Clause
/// The weights of one particle: N and N' at four nodes along three axes.

#include <algorithm>
#include <array>
#include <cmath>
#include <gsl/gsl_bspline.h>
#include <gsl/gsl_version.h>
#include <memory>
#include <random>

#include "bench/kernels/kernel_case.hpp"
#include "reference/kernel.hpp"

namespace firn::bench {

namespace {

constexpr std::size_t particles = 1024;

struct Weights {
  double N[3][4], dN[3][4];
};

/// Places inside a cell, three per particle.
std::vector<std::array<double, 3>> places(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<std::array<double, 3>> all(particles);
  for (auto& s : all)
    for (double& x : s) x = static_cast<double>(engine() >> 11) * 0x1p-53;
  return all;
}

Weights weights_by_reference(const std::array<double, 3>& s) {
  Weights w;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reference::kernel_row(s[axis], w.N[axis], w.dN[axis]);
  return w;
}

/// GSL's cubic B-splines on uniform breaks 0 … 7; cell [3, 4] is free of the ends.
/// GSL 2.8 gave the two functions used here new names.
class GslSpline {
 public:
  GslSpline() : space_(gsl_bspline_alloc(4, 8)), values_(gsl_matrix_alloc(4, 2)) {
#if GSL_MAJOR_VERSION == 2 && GSL_MINOR_VERSION < 8
    gsl_bspline_knots_uniform(0, 7, space_);
#else
    gsl_bspline_init_uniform(0, 7, space_);
#endif
  }
  ~GslSpline() {
    gsl_matrix_free(values_);
    gsl_bspline_free(space_);
  }
  GslSpline(const GslSpline&) = delete;
  GslSpline& operator=(const GslSpline&) = delete;

  Weights operator()(const std::array<double, 3>& s) const {
    Weights w;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      evaluate(3 + s[axis]);
      for (std::size_t a = 0; a < 4; ++a) {
        w.N[axis][a] = gsl_matrix_get(values_, a, 0);
        w.dN[axis][a] = gsl_matrix_get(values_, a, 1);
      }
    }
    return w;
  }

 private:
  /// The four splines that do not vanish at x, and their first derivatives.
  void evaluate(double x) const {
    std::size_t first = 0;
#if GSL_MAJOR_VERSION == 2 && GSL_MINOR_VERSION < 8
    std::size_t last = 0;
    gsl_bspline_deriv_eval_nonzero(x, 1, values_, &first, &last, space_);
#else
    gsl_bspline_basis_deriv(x, 1, values_, &first, space_);
#endif
  }

  gsl_bspline_workspace* space_;
  gsl_matrix* values_;
};

/// The polynomial as the paper prints it, one branch per distance.
double printed(double x) {
  const double d = std::abs(x);
  if (d < 1) return 0.5 * d * d * d - d * d + 2.0 / 3;
  return d < 2 ? -d * d * d / 6 + d * d - 2 * d + 4.0 / 3 : 0;
}

/// Largest error of N, in eps of its largest value, and of ΣN − 1.
template <class Code>
double worst_of(const Code& code, const std::vector<std::array<double, 3>>& all) {
  double worst = 0;
  for (const auto& s : all) {
    const Weights w = code(s);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = 0, slope = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        worst =
            std::max(worst, std::abs(w.N[axis][a] - printed(s[axis] + 1 - static_cast<double>(a))));
        sum += w.N[axis][a];
        slope += w.dN[axis][a];
      }
      worst = std::max({worst, std::abs(sum - 1), std::abs(slope)});
    }
  }
  return worst / eps_of<double>;
}

template <class Code>
void time_weights(const Code& code, std::uint64_t seed, results::Case& result) {
  const auto all = places(seed);
  // The printed polynomial, which is the oracle here, is itself off by 4 eps near |x| = 2.
  if (!judge(result, "against the printed polynomial, ΣN = 1, ΣN' = 0", worst_of(code, all), 16))
    return;
  std::vector<Weights> out(particles);
  time_body(
      [&] {
        for (std::size_t i = 0; i < particles; ++i) out[i] = code(all[i]);
      },
      particles, result);
}

}  // namespace

void plan_weights(std::uint64_t seed, std::vector<CasePlan>& plans) {
  plan_kernel(
      "weights", "reference", "double", "",
      [=](results::Case& r) { time_weights(weights_by_reference, seed, r); }, plans);
  plan_kernel(
      "weights", "GSL bspline", "double", "",
      [=](results::Case& r) { time_weights(GslSpline(), seed, r); }, plans);
}

}  // namespace firn::bench
