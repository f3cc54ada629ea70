// SPDX-License-Identifier: BSD-3-Clause
/// Singular value decompositions and polar factors, beside Eigen's and GSL's.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <gsl/gsl_linalg.h>
#include <memory>

#include "bench/kernels/kernel_case.hpp"
#include "bench/kernels/matrices.hpp"
#include "firn/error.hpp"
#include "firn/material.hpp"
#include "optimized/math/batch.hpp"
#include "reference/polar.hpp"

namespace firn::bench {

namespace {

/// Ours keep 10 and 12 eps on every family; a library is timed if it is anywhere near
/// working accuracy, and what it reaches stands beside its time.
void judge_svd(const SvdQuality& quality, bool ours, results::Case& result) {
  const double backward = ours ? 10 : 100, orthogonality = ours ? 12 : 100;
  result.validation = "backward error " + to_text(quality.backward) + " eps, orthogonality " +
                      to_text(quality.orthogonality) + " eps; allowed " + to_text(backward) +
                      " and " + to_text(orthogonality);
  if (quality.backward <= backward && quality.orthogonality <= orthogonality) return;
  result.status = results::Status::invalid;
  result.message = "not of working accuracy: " + result.validation;
}

template <class T>
void time_batch_svd(const std::string& family, std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> plain = matrices(family, count, seed);
  const std::vector<T> A = pack<T>(plain);
  std::vector<T> U(A.size()), V(A.size()), sigma(A.size() / 3);
  const auto& batch = kernels::batch_kernels<T>();
  batch.svd(A.data(), U.data(), sigma.data(), V.data(), packets);
  SvdQuality quality;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 s;
    for (std::size_t c = 0; c < 3; ++c)
      s[static_cast<int>(c)] =
          static_cast<double>(sigma[(i / kernels::packet_size * 3 + c) * kernels::packet_size +
                                    i % kernels::packet_size]);
    quality.take(unpack(A, i), unpack(U, i), s, unpack(V, i), eps_of<T>);
  }
  judge_svd(quality, true, result);
  if (result.status == results::Status::measured)
    time_body([&] { batch.svd(A.data(), U.data(), sigma.data(), V.data(), packets); }, count,
              result);
}

struct Decomposed {
  Mat3 U, V;
  Vec3 sigma;
};

Decomposed by_reference(const Mat3& A) {
  const reference::Svd s = reference::svd(A);
  return {s.U, s.V, s.sigma};
}

Decomposed by_eigen(const Mat3& A) {
  const Eigen::JacobiSVD<Mat3> s(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {s.matrixU(), s.matrixV(), s.singularValues()};
}

Decomposed by_gsl(const Mat3& A) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  RowMajor U = A, V;
  Vec3 sigma;
  gsl_matrix_view u = gsl_matrix_view_array(U.data(), 3, 3),
                  v = gsl_matrix_view_array(V.data(), 3, 3);
  gsl_vector_view s = gsl_vector_view_array(sigma.data(), 3);
  gsl_linalg_SV_decomp_jacobi(&u.matrix, &v.matrix, &s.vector);
  return {U, V, sigma};
}

void time_plain_svd(Decomposed (*svd)(const Mat3&), const std::string& family, std::uint64_t seed,
                    results::Case& result) {
  const std::vector<Mat3> A = matrices(family, count, seed);
  std::vector<Decomposed> out(count);
  SvdQuality quality;
  for (const Mat3& matrix : A) {
    const Decomposed d = svd(matrix);
    quality.take(matrix, d.U, d.sigma, d.V, 0x1p-52);
  }
  judge_svd(quality, svd == by_reference, result);
  if (result.status != results::Status::measured) return;
  time_body(
      [&] {
        for (std::size_t i = 0; i < count; ++i) out[i] = svd(A[i]);
      },
      count, result);
}

/// Polar factor near a rotation; judged by the symmetry of RᵀF and by RᵀR.
template <class T>
void time_polar(std::uint64_t seed, results::Case& result) {
  const std::vector<T> F = pack<T>(matrices("elastic", count, seed));
  std::vector<T> R(F.size());
  const auto& batch = kernels::batch_kernels<T>();
  batch.polar_near_rotation(F.data(), R.data(), packets);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Mat3 r = unpack(R, i), S = r.transpose() * unpack(F, i);
    worst = std::max(
        {worst, (S - S.transpose()).norm(), (r.transpose() * r - Mat3::Identity()).norm()});
  }
  // ‖S − Sᵀ‖ is √2·2 times the skew part, of which Newton's polar leaves 2 eps.
  if (!judge(result, "symmetry of RᵀF and RᵀR − I", worst / eps_of<T>, 8)) return;
  time_body([&] { batch.polar_near_rotation(F.data(), R.data(), packets); }, count, result);
}

Mat3 polar_by_reference(const Mat3& F) { return reference::rotation(F); }

Mat3 polar_by_eigen(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> s(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return s.matrixU() * s.matrixV().transpose();
}

void time_plain_polar(Mat3 (*polar)(const Mat3&), std::uint64_t seed, results::Case& result) {
  const std::vector<Mat3> F = matrices("elastic", count, seed);
  std::vector<Mat3> R(count);
  double worst = 0;
  for (const Mat3& f : F) {
    const Mat3 r = polar(f), S = r.transpose() * f;
    worst = std::max(
        {worst, (S - S.transpose()).norm(), (r.transpose() * r - Mat3::Identity()).norm()});
  }
  // Two decompositions' worth of orthogonality, 100 eps for a library's.
  if (!judge(result, "symmetry of RᵀF and RᵀR − I", worst / eps_of<double>, 100)) return;
  time_body(
      [&] {
        for (std::size_t i = 0; i < count; ++i) R[i] = polar(F[i]);
      },
      count, result);
}

template <class T>
void plan_our_decompositions(const std::string& target, std::uint64_t seed,
                             std::vector<CasePlan>& plans) {
  for (const char* family : {"snow", "Gaussian"})
    plan_kernel(
        std::string("SVD, ") + family, "optimized", name_of<T>, target,
        [=](results::Case& r) { time_batch_svd<T>(family, seed, r); }, plans);
  plan_kernel(
      "polar, elastic", "optimized", name_of<T>, target,
      [=](results::Case& r) { time_polar<T>(seed, r); }, plans);
}

}  // namespace

void plan_decompositions(std::uint64_t seed, std::vector<CasePlan>& plans) {
  for (const std::string& target : kernel_targets()) {
    plan_our_decompositions<float>(target, seed, plans);
    plan_our_decompositions<double>(target, seed, plans);
  }
  const std::pair<const char*, Decomposed (*)(const Mat3&)> peers[] = {
      {"reference", by_reference}, {"Eigen JacobiSVD", by_eigen}, {"GSL SV_decomp_jacobi", by_gsl}};
  for (const auto& [code, svd] : peers)
    for (const char* family : {"snow", "Gaussian"})
      plan_kernel(
          std::string("SVD, ") + family, code, "double", "",
          [=, svd = svd](results::Case& r) { time_plain_svd(svd, family, seed, r); }, plans);
  const std::pair<const char*, Mat3 (*)(const Mat3&)> polars[] = {
      {"reference", polar_by_reference}, {"Eigen JacobiSVD", polar_by_eigen}};
  for (const auto& [code, polar] : polars)
    plan_kernel(
        "polar, elastic", code, "double", "",
        [=, polar = polar](results::Case& r) { time_plain_polar(polar, seed, r); }, plans);
}

}  // namespace firn::bench
