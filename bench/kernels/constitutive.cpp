// SPDX-License-Identifier: BSD-3-Clause
/// The box test, the stress, the return mapping and the Hessian of one particle.

#include "reference/constitutive.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <gsl/gsl_linalg.h>

#include "bench/kernels/kernel_case.hpp"
#include "bench/kernels/matrices.hpp"
#include "firn/error.hpp"
#include "firn/material.hpp"
#include "optimized/math/batch.hpp"

namespace firn::bench {

namespace {

template <class T>
std::vector<T> minus_identity(const std::vector<Mat3>& F) {
  std::vector<Mat3> E = F;
  for (Mat3& e : E) e -= Mat3::Identity();
  return pack<T>(E);
}

/// Step 7 on fresh copies each time (the copy, 18 numbers, is timed with it). Judged by
/// F_E F_P against F before, and by the singular values against the box.
template <class T>
void time_return_map(const std::string& family, bool by_svd, std::uint64_t seed,
                     results::Case& result) {
  const Material snow;
  const auto box = kernels::ElasticBox<T>::from(snow.critical_compression, snow.critical_stretch);
  const std::vector<Mat3> F = matrices(family, count, seed);
  const std::vector<T> E = minus_identity<T>(F), P(E.size(), T{0});
  std::vector<T> F_E = E, F_P = P, changed(count);
  const auto& batch = kernels::batch_kernels<T>();
  const auto map = by_svd ? batch.return_map_svd : batch.return_map;
  map(box, F_E.data(), F_P.data(), changed.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Mat3 elastic = Mat3::Identity() + unpack(F_E, i),
               plastic = Mat3::Identity() + unpack(F_P, i);
    const Mat3 before = Mat3::Identity() + unpack(E, i);
    const Vec3 s = reference::svd(elastic).sigma;
    worst =
        std::max({worst, (elastic * plastic - before).norm(), s[0] - snow.largest_elastic_stretch(),
                  snow.smallest_elastic_stretch() - s[2]});
  }
  if (!judge(result, "F_E F_P against F, singular values against the box", worst / eps_of<T>, 64))
    return;
  time_body(
      [&] {
        std::copy(E.begin(), E.end(), F_E.begin());
        std::copy(P.begin(), P.end(), F_P.begin());
        map(box, F_E.data(), F_P.data(), changed.data(), packets);
      },
      count, result);
}

template <class T>
void time_exp(std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> random = matrices("Gaussian", count, seed);
  std::vector<T> x(count), y(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = static_cast<T>(random[i](0, 0));
  const auto& batch = kernels::batch_kernels<T>();
  batch.exp(x.data(), y.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i)
    worst = std::max(worst,
                     std::abs(static_cast<double>(y[i]) / std::exp(static_cast<double>(x[i])) - 1));
  if (!judge(result, "against libm in double", worst / eps_of<T>, 4)) return;
  time_body([&] { batch.exp(x.data(), y.data(), packets); }, count, result);
}

/// Half of "snow at the limit", I + 0.008 N, is inside the box. The singular values by GSL decide;
/// within 8 eps of a limit either answer is right.
std::vector<Mat3> near_the_limit(std::uint64_t seed) {
  std::vector<Mat3> F = matrices("elastic", count, seed);
  for (Mat3& f : F) f = Mat3::Identity() + (f - Mat3::Identity()) * 0.8;
  return F;
}

bool inside_by_gsl(const Mat3& F, const Material& snow, double margin, bool& close) {
  gsl_matrix* U = gsl_matrix_alloc(3, 3);
  gsl_matrix* V = gsl_matrix_alloc(3, 3);
  gsl_vector* s = gsl_vector_alloc(3);
  for (std::size_t i = 0; i < 9; ++i)
    gsl_matrix_set(U, i / 3, i % 3, F(static_cast<int>(i / 3), static_cast<int>(i % 3)));
  gsl_linalg_SV_decomp_jacobi(U, V, s);
  const double high = gsl_vector_get(s, 0) - snow.largest_elastic_stretch();
  const double low = snow.smallest_elastic_stretch() - gsl_vector_get(s, 2);
  gsl_matrix_free(U), gsl_matrix_free(V), gsl_vector_free(s);
  close = std::abs(high) < margin || std::abs(low) < margin;
  return high <= 0 && low <= 0;
}

/// Counts wrong answers; one is too many. Also says if both answers occurred.
double wrong_answers(const std::vector<Mat3>& F, const std::function<bool(std::size_t)>& inside,
                     double eps) {
  const Material snow;
  double wrong = 0;
  std::size_t yes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    bool close = false;
    const bool expected = inside_by_gsl(F[i], snow, 8 * eps, close), said = inside(i);
    yes += said;
    wrong += said != expected && !close;
  }
  return yes == 0 || yes == count ? count : wrong;
}

bool judge_answers(results::Case& result, double wrong) {
  result.validation = "answers that differ from GSL's singular values: " + to_text(wrong) + " of " +
                      std::to_string(count) + ", allowed 0";
  if (wrong == 0) return true;
  result.status = results::Status::invalid;
  result.message = result.validation;
  return false;
}

template <class T>
void time_box_test(std::uint64_t seed, results::Case& result) {
  const Material snow;
  const auto box = kernels::ElasticBox<T>::from(snow.critical_compression, snow.critical_stretch);
  const std::vector<T> E = minus_identity<T>(near_the_limit(seed));
  std::vector<Mat3> F(count);  // as rounded to T
  for (std::size_t i = 0; i < count; ++i) F[i] = Mat3::Identity() + unpack(E, i);
  std::vector<T> inside(count);
  const auto& batch = kernels::batch_kernels<T>();
  batch.inside_elastic_box(E.data(), box, inside.data(), packets);
  if (!judge_answers(result, wrong_answers(
                                 F, [&](std::size_t i) { return inside[i] != 0; }, eps_of<T>)))
    return;
  time_body([&] { batch.inside_elastic_box(E.data(), box, inside.data(), packets); }, count,
            result);
}

bool inside_by(const Vec3& sigma) {
  const Material snow;
  return sigma[0] <= snow.largest_elastic_stretch() && sigma[2] >= snow.smallest_elastic_stretch();
}

void time_plain_box_test(bool by_eigen, std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> F = near_the_limit(seed);
  const auto test = [&](std::size_t i) {
    return inside_by(by_eigen ? Vec3(Eigen::JacobiSVD<Mat3>(F[i]).singularValues())
                              : reference::svd(F[i]).sigma);
  };
  if (!judge_answers(result, wrong_answers(F, test, eps_of<double>))) return;
  std::vector<char> inside(count);
  time_body(
      [&] {
        for (std::size_t i = 0; i < count; ++i) inside[i] = test(i);
      },
      count, result);
}

/// 2μ(F − R)Fᵀ + λ(J − 1)J I with Eigen's decomposition: oracle and peer.
Mat3 stress_by_eigen(const reference::Lame& lame, const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> s(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double J = F.determinant();
  return 2 * lame.mu * (F - s.matrixU() * s.matrixV().transpose()) * F.transpose() +
         lame.lambda * (J - 1) * J * Mat3::Identity();
}

constexpr reference::Lame lame{1.0, 0.7};  // the ratio of snow at ν = 0.2 is 2/3

/// In units of eps (2μ + 3λ), the change of τ by one rounding of F near a rotation.
double off(const Mat3& tau, const Mat3& exact, double eps) {
  return (tau - exact).norm() / (2 * lame.mu + 3 * lame.lambda) / eps;
}

template <class T>
void time_stress(const std::string& family, std::uint64_t seed, results::Case& result) {
  const std::vector<T> E = minus_identity<T>(matrices(family, count, seed));
  std::vector<T> mu(count, static_cast<T>(lame.mu)), lambda(count, static_cast<T>(lame.lambda));
  std::vector<T> tau(count * 6);
  const auto& batch = kernels::batch_kernels<T>();
  batch.kirchhoff_stress(E.data(), mu.data(), lambda.data(), tau.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Mat3 mine;
    for (int r = 0, k = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c, ++k) {
        const std::size_t at =
            (i / kernels::packet_size * 6 + static_cast<std::size_t>(k)) * kernels::packet_size +
            i % kernels::packet_size;
        mine(r, c) = mine(c, r) = static_cast<double>(tau[at]);
      }
    worst = std::max(worst,
                     off(mine, stress_by_eigen(lame, Mat3::Identity() + unpack(E, i)), eps_of<T>));
  }
  // A dozen roundings of numbers of size 1 on our side, Eigen's own 10 eps of σ on the other.
  if (!judge(result, "against Eigen's decomposition in double", worst, 32)) return;
  time_body(
      [&] { batch.kirchhoff_stress(E.data(), mu.data(), lambda.data(), tau.data(), packets); },
      count, result);
}

void time_plain_stress(Mat3 (*stress)(const reference::Lame&, const Mat3&),
                       const std::string& family, std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> F = matrices(family, count, seed);
  double worst = 0;
  for (const Mat3& f : F)
    worst = std::max(worst, off(stress(lame, f), reference::piola_stress(lame, f) * f.transpose(),
                                eps_of<double>));
  if (!judge(result, "against P Fᵀ of the reference", worst, 64)) return;
  std::vector<Mat3> tau(count);
  time_body(
      [&] {
        for (std::size_t i = 0; i < count; ++i) tau[i] = stress(lame, F[i]);
      },
      count, result);
}

/// V A Fᵀ for a velocity gradient L, as each application of the semi-implicit operator needs it.
template <class T>
void time_hessian(std::uint64_t seed, results::Case& result) {
  const std::vector<T> E = minus_identity<T>(matrices("snow", count, seed));
  const std::vector<T> L = pack<T>(matrices("Gaussian", count, seed + 1));
  std::vector<T> two_mu(count, static_cast<T>(2 * lame.mu)),
      lambda(count, static_cast<T>(lame.lambda)), factors(count * 15), action(E.size());
  const auto& batch = kernels::batch_kernels<T>();
  batch.hessian_factors(E.data(), two_mu.data(), lambda.data(), factors.data(), packets);
  batch.hessian_action(factors.data(), L.data(), action.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Mat3 F = Mat3::Identity() + unpack(E, i), l = unpack(L, i);
    const Mat3 exact = reference::StressDifferential(lame, F)(l * F) * F.transpose();
    worst = std::max(worst, off(unpack(action, i), exact, eps_of<T>) / l.norm());
  }
  if (!judge(result, "against the reference's δP Fᵀ", worst, 32)) return;
  time_body([&] { batch.hessian_action(factors.data(), L.data(), action.data(), packets); }, count,
            result);
}

void time_plain_hessian(std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> F = matrices("snow", count, seed),
                          L = matrices("Gaussian", count, seed + 1);
  std::vector<reference::StressDifferential> dP;
  for (const Mat3& f : F) dP.emplace_back(lame, f);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // Fourth-order differences of P; (1e-3)⁴ and eps/1e-3 are both below 1e-11.
    const auto P = [&](double t) { return reference::piola_stress(lame, F[i] + t * L[i] * F[i]); };
    constexpr double t = 1e-3;
    const Mat3 exact = (8 * (P(t) - P(-t)) - (P(2 * t) - P(-2 * t))) / (12 * t);
    worst = std::max(worst, (dP[i](L[i] * F[i]) - exact).norm() / L[i].norm() / 1e-9);
  }
  result.validation = "against differences of P: " + to_text(worst) + " of 1e-9 allowed";
  if (!(worst <= 1)) {
    result.status = results::Status::invalid;
    result.message = result.validation;
    return;
  }
  std::vector<Mat3> action(count);
  time_body(
      [&] {
        for (std::size_t i = 0; i < count; ++i) action[i] = dP[i](L[i] * F[i]) * F[i].transpose();
      },
      count, result);
}

template <class T>
void plan_our_maps(const std::string& target, std::uint64_t seed, std::vector<CasePlan>& plans) {
  const auto add = [&](const std::string& kernel, const char* code,
                       std::function<void(results::Case&)> run) {
    plan_kernel(kernel, code, name_of<T>, target, std::move(run), plans);
  };
  add("box test", "optimized", [=](results::Case& r) { time_box_test<T>(seed, r); });
  for (const char* family : {"elastic", "snow"}) {
    const std::string of = std::string(", ") + family;
    add("stress" + of, "optimized", [=](results::Case& r) { time_stress<T>(family, seed, r); });
    for (const bool by_svd : {false, true})
      add("return map" + of, by_svd ? "optimized, by SVD" : "optimized",
          [=](results::Case& r) { time_return_map<T>(family, by_svd, seed, r); });
  }
  add("exp", "optimized", [=](results::Case& r) { time_exp<T>(seed, r); });
  add("Hessian action", "optimized", [=](results::Case& r) { time_hessian<T>(seed, r); });
}

}  // namespace

void plan_constitutive(std::uint64_t seed, std::vector<CasePlan>& plans) {
  for (const std::string& target : kernel_targets()) {
    plan_our_maps<float>(target, seed, plans);
    plan_our_maps<double>(target, seed, plans);
  }
  const auto add = [&](const std::string& kernel, const char* code,
                       std::function<void(results::Case&)> run) {
    plan_kernel(kernel, code, "double", "", std::move(run), plans);
  };
  add("box test", "reference SVD", [=](results::Case& r) { time_plain_box_test(false, seed, r); });
  add("box test", "Eigen JacobiSVD", [=](results::Case& r) { time_plain_box_test(true, seed, r); });
  for (const char* family : {"elastic", "snow"}) {
    const std::string kernel = std::string("stress, ") + family;
    add(kernel, "reference",
        [=](results::Case& r) { time_plain_stress(reference::kirchhoff_stress, family, seed, r); });
    add(kernel, "Eigen JacobiSVD",
        [=](results::Case& r) { time_plain_stress(stress_by_eigen, family, seed, r); });
  }
  add("Hessian action", "reference", [=](results::Case& r) { time_plain_hessian(seed, r); });
}
}  // namespace firn::bench
