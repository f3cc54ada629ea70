// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "reference/polar.hpp"
#include "reference/svd.hpp"
#include "verification/support/eps.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

using test::Random;
using Wide = long double;  // 64 bits of mantissa: 2000 times finer than what is judged
using WideMat3 = Eigen::Matrix<Wide, 3, 3>;
using WideVec3 = Eigen::Matrix<Wide, 3, 1>;

struct Family {
  std::string name;
  std::function<Mat3(Random&)> draw;
};

Mat3 random_frame(Random& random) {
  const Vec3 a = random.vec3().normalized();
  const Vec3 b = a.cross(random.vec3()).normalized();
  Mat3 R;
  R << a, b, a.cross(b);
  return R;
}

Mat3 with_singular_values(Random& random, const Vec3& sigma) {
  return random_frame(random) * sigma.asDiagonal() * random_frame(random).transpose();
}

Mat3 random_integers(Random& random) {
  return random.mat3().unaryExpr([](double u) { return std::floor(1.5 * (u + 1)) - 1; });
}

Mat3 signed_permutation(Random& random) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                   {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int* order = orders[static_cast<int>(std::floor(3 * (random() + 1))) % 6];
  Mat3 m = Mat3::Zero();
  for (int column = 0; column < 3; ++column)
    m(order[column], column) =
        std::copysign(std::ldexp(1.0, static_cast<int>(10 * random())), random());
  return m;
}

double log_uniform(Random& random, double decades) {
  const double exponent = 0.5 * decades * random();
  return std::copysign(std::pow(10, exponent), random());
}

void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }

std::vector<Family> families() {
  const double tiny = std::sqrt(eps);
  return {
      {"snow", [](Random& r) -> Mat3 { return Mat3::Identity() + 0.03 * r.mat3(); }},
      {"uniform", [](Random& r) { return r.mat3(); }},
      {"rotation", random_frame},
      {"scaled_rotation", [](Random& r) -> Mat3 { return 7 * r() * random_frame(r); }},
      {"nearly_equal",
       [](Random& r) { return with_singular_values(r, Vec3::Ones() + 4 * eps * r.vec3()); }},
      {"close_pair",
       [](Random& r) { return with_singular_values(r, Vec3(2, 1 + 1e-10 * r(), 1)); }},
      {"close_large_pair",
       [](Random& r) { return with_singular_values(r, Vec3(1 + 1e-13 * r(), 1, 0.1)); }},
      {"rank_1", [](Random& r) -> Mat3 { return r.vec3() * r.vec3().transpose(); }},
      {"rank_2",
       [](Random& r) -> Mat3 {
         Mat3 m = r.vec3() * r.vec3().transpose();
         m += r.vec3() * r.vec3().transpose();
         return m;
       }},
      {"inverted",
       [](Random& r) {
         Mat3 m = r.mat3();
         if (m.determinant() > 0) m.row(1) *= -1;
         return m;
       }},
      {"ill_conditioned",
       [](Random& r) {
         return with_singular_values(
             r, Vec3(1, std::pow(10, -8 + 8 * r()), std::pow(10, -8 + 8 * r())));
       }},
      {"square_root_of_eps",
       [tiny](Random& r) { return with_singular_values(r, Vec3(1, tiny, tiny * r())); }},
      {"integers", random_integers},
      {"signed_permutation", signed_permutation},
      {"mixed_magnitudes",
       [](Random& r) -> Mat3 {
         return Mat3::NullaryExpr([&](auto) { return log_uniform(r, 20); });
       }},
      {"widely_mixed",
       [](Random& r) -> Mat3 {
         return Mat3::NullaryExpr([&](auto) { return log_uniform(r, 500); });
       }},
      {"huge", [](Random& r) -> Mat3 { return 1e160 * r.mat3(); }},
      {"tiny", [](Random& r) -> Mat3 { return 1e-160 * r.mat3(); }},
      {"overflow_of_squares", [](Random& r) -> Mat3 { return 5e307 * r.mat3(); }},
      {"denormal", [](Random& r) -> Mat3 { return 1e-310 * r.mat3(); }},
  };
}

/// Errors of a sample; the bounds are for the largest and for the 99.9th percentile.
struct Errors {
  std::vector<double> values;
  double largest() const { return *std::max_element(values.begin(), values.end()); }
  double percentile() {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 999 / 1000);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }
};

class Svd3x3 : public testing::TestWithParam<Family> {};

TEST_P(Svd3x3, IsAccurate) {
  const int count = 20000;
  Random random(42);
  Errors backward, orthogonal, values;
  for (int n = 0; n < count; ++n) {
    const Mat3 A = GetParam().draw(random);
    // Exact scaling: long double has the exponents, Eigen's SVD of it does not need them.
    const double largest = A.cwiseAbs().maxCoeff();
    int exponent = 0;
    if (largest > 0) std::frexp(largest, &exponent);
    const auto wide = [&](const auto& m) {
      return m.unaryExpr([&](double a) { return std::ldexp(static_cast<Wide>(a), -exponent); })
          .eval();
    };
    const Svd usv = svd(A);
    const WideMat3 A_w = wide(A), U = usv.U.cast<Wide>(), V = usv.V.cast<Wide>();
    const WideVec3 sigma = wide(usv.sigma);
    // A denormal number has fewer than 53 bits: its last one is the unit then.
    const Wide floor = std::ldexp(Wide(1), std::max(-1074 - exponent, -16000));
    const Wide unit = std::max(eps * A_w.norm(), floor);
    if (largest > 0) {
      backward.values.push_back(
          static_cast<double>((U * sigma.asDiagonal() * V.transpose() - A_w).norm() / unit));
      WideVec3 oracle = Eigen::JacobiSVD<WideMat3>(A_w).singularValues();
      if (sigma[2] < 0) oracle[2] = -oracle[2];
      values.values.push_back(static_cast<double>((sigma - oracle).cwiseAbs().maxCoeff() /
                                                  std::max(eps * oracle[0], floor)));
    } else {
      EXPECT_TRUE(usv.sigma.isZero(0));
      backward.values.push_back(0);
      values.values.push_back(0);
    }
    orthogonal.values.push_back(
        static_cast<double>(std::max((U.transpose() * U - WideMat3::Identity()).norm(),
                                     (V.transpose() * V - WideMat3::Identity()).norm()) /
                            eps));

    ASSERT_GT(usv.U.determinant(), 0.5) << A;
    ASSERT_GT(usv.V.determinant(), 0.5) << A;
    ASSERT_GE(usv.sigma[0], usv.sigma[1]) << A;
    ASSERT_GE(usv.sigma[1], std::abs(usv.sigma[2])) << A;
    const Wide det = A_w.determinant();
    if (std::abs(usv.sigma[2]) > 8 * eps * usv.sigma[0] && std::abs(det) > 1e-15L) {
      ASSERT_EQ(usv.sigma[2] > 0, det > 0) << A;
    }
  }
  // The table of attainable accuracies that svd.hpp promises, in eps.
  EXPECT_LE(backward.largest(), 10);
  EXPECT_LE(backward.percentile(), 5);
  EXPECT_LE(orthogonal.largest(), 12);
  EXPECT_LE(orthogonal.percentile(), 7);
  EXPECT_LE(values.largest(), 6);
  EXPECT_LE(values.percentile(), 3);
  EXPECT_EQ(backward.values.size(), static_cast<std::size_t>(count));
  RecordProperty("backward", std::to_string(backward.largest()));
  RecordProperty("orthogonal", std::to_string(orthogonal.largest()));
  RecordProperty("singular_values", std::to_string(values.largest()));
}

INSTANTIATE_TEST_SUITE_P(Families, Svd3x3, testing::ValuesIn(families()),
                         [](const auto& info) { return info.param.name; });

TEST(Svd, ExactCases) {
  const auto sigma_of = [](double a, double b, double c) {
    return svd(Vec3(a, b, c).asDiagonal()).sigma;
  };
  EXPECT_EQ(svd(Mat3::Zero()).sigma, Vec3(Vec3::Zero()));
  EXPECT_EQ(svd(Mat3::Zero()).U.determinant(), 1);
  EXPECT_EQ(svd(Mat3::Identity()).sigma, Vec3(Vec3::Ones()));
  EXPECT_EQ(sigma_of(1, 3, 2), Vec3(3, 2, 1));
  EXPECT_EQ(sigma_of(0.1, -0.3, 0.7), Vec3(0.7, 0.3, -0.1));
  EXPECT_EQ(sigma_of(-1, -1, -1), Vec3(1, 1, -1));
  EXPECT_EQ(sigma_of(0, -5, 0), Vec3(5, 0, 0));
  // Two columns so far below the third that their squares underflow: 0 beside σ1.
  const Vec3 sigma = sigma_of(1e-200, 1, 1e-190);
  EXPECT_EQ(sigma[0], 1);
  EXPECT_LE(sigma[1], 1e-190);
}

/// A column exchange counts as a change: after it the pair that was looked at
/// before has to be looked at again. Found by random tests only among integers.
TEST(Svd, AllSmallIntegerMatrices) {
  Errors backward;
  for (int n = 0; n < 19683; ++n) {
    Mat3 A;
    for (int entry = 0, rest = n; entry < 9; ++entry, rest /= 3)
      A(entry / 3, entry % 3) = rest % 3 - 1;
    const Svd usv = svd(A);
    backward.values.push_back((usv.U * usv.sigma.asDiagonal() * usv.V.transpose() - A).norm());
  }
  EXPECT_LE(backward.largest(), 10 * eps * 3);  // ‖A‖ ≤ 3
}

TEST(Svd, NotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    Mat3 A = Mat3::Identity();
    A(1, 2) = bad;
    const Svd usv = svd(A);
    EXPECT_TRUE(usv.U.array().isNaN().all());
    EXPECT_TRUE(usv.sigma.array().isNaN().all());
    EXPECT_TRUE(usv.V.array().isNaN().all());
  }
}

class Polar3x3 : public testing::TestWithParam<Family> {};

/// F = R S with a rotation R and a symmetric S. R itself has the condition
/// number σ1/(σ2 + σ3); what can be asked of any F is that RᵀF is symmetric.
TEST_P(Polar3x3, IsAccurate) {
  Random random(43);
  double skew = 0, orthogonal = 0, product = 0, symmetry = 0;
  for (int n = 0; n < 5000; ++n) {
    Mat3 F = GetParam().draw(random);
    const double size = F.norm();
    if (size == 0) continue;
    F /= size;
    if (!F.allFinite() || F.norm() < 0.5) continue;  // the scale of F is svd()'s concern
    const Polar RS = polar(F);
    const WideMat3 R = RS.R.cast<Wide>();
    const WideMat3 RtF = R.transpose() * F.cast<Wide>();
    const auto in_eps = [](Wide error) { return static_cast<double>(error / eps); };
    skew = std::max(skew, in_eps((RtF - RtF.transpose()).norm() / 2));
    orthogonal = std::max(orthogonal, in_eps((R.transpose() * R - WideMat3::Identity()).norm()));
    product = std::max(product, in_eps((R * RS.S.cast<Wide>() - F.cast<Wide>()).norm()));
    symmetry = std::max(symmetry, in_eps((RS.S - RS.S.transpose()).cast<Wide>().norm()));
    ASSERT_GT(RS.R.determinant(), 0.5);
  }
  EXPECT_LE(skew, 4);
  EXPECT_LE(orthogonal, 12);
  EXPECT_LE(product, 12);  // as U Σ Vᵀ, and ‖VᵀV − I‖
  EXPECT_LE(symmetry, 4);  // two roundings of either half
}

INSTANTIATE_TEST_SUITE_P(Families, Polar3x3, testing::ValuesIn(families()),
                         [](const auto& info) { return info.param.name; });

TEST(Polar, RotationTakesTheSignOffTheSmallestSingularValue) {
  // F = diag(3, 2, −1): R = I, S = F. A reflection is not a rotation.
  const Polar RS = polar(Mat3(Vec3(3, 2, -1).asDiagonal()));
  EXPECT_EQ(RS.R, Mat3(Mat3::Identity()));
  EXPECT_EQ(RS.S, Mat3(Vec3(3, 2, -1).asDiagonal()));
}

}  // namespace
}  // namespace firn::reference
