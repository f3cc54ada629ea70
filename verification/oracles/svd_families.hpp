// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Families of 3x3 matrices that find the mistakes which random tests do not see.

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "verification/oracles/svd_oracle.hpp"
#include "verification/support/random_numbers.hpp"

namespace firn::verification {

using Random = fixtures::NumbersOf<fixtures::SplitMix64>;

/// A rotation, uniformly distributed (normalized Gaussian quaternion).
inline Matrix random_rotation(Random& random) {
  Real q[4], n = 0;
  for (Real& x : q) x = random.gaussian(), n += x * x;
  n = std::sqrt(n);
  for (Real& x : q) x /= n;
  const Real w = q[0], x = q[1], y = q[2], z = q[3];
  return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
}

/// U diag(a, b, c) Vᵀ with random rotations.
inline Matrix with_singular_values(Random& random, Real a, Real b, Real c) {
  const Matrix V = random_rotation(random);
  Matrix U = random_rotation(random);
  for (int i = 0; i < 3; ++i) U[3 * i] *= a, U[3 * i + 1] *= b, U[3 * i + 2] *= c;
  return multiply(U, transpose(V));
}

struct Family {
  const char* name;
  Matrix (*make)(Random& random, bool single);
};

namespace families_detail {

inline Matrix gaussian(Random& r, Real scale) {
  Matrix A;
  for (Real& a : A) a = scale * r.gaussian();
  return A;
}

inline Matrix near_identity(Random& r) {
  Matrix A;
  for (int k = 0; k < 9; ++k) A[k] = (k % 4 == 0) + 0.03 * r.uniform(-1, 1);
  return A;
}

inline Real eps(bool single) { return single ? 0x1p-23L : 0x1p-52L; }

/// 10^x
inline Real power(double x) { return std::pow(Real(10), Real(x)); }

}  // namespace families_detail

/// All families whose decomposition is a number; NaN and infinity are tests of their own.
inline const std::vector<Family>& svd_families() {
  using namespace families_detail;
  static const std::vector<Family> families = {
      {"snow: I + 0.03 R", [](Random& r, bool) { return near_identity(r); }},
      {"snow, turned",
       [](Random& r, bool) {
         return with_singular_values(r, r.uniform(1, 1.0075), r.uniform(0.9925, 1.0075),
                                     r.uniform(0.975, 1));
       }},
      {"Gaussian", [](Random& r, bool) { return gaussian(r, 1); }},
      {"rotation", [](Random& r, bool) { return random_rotation(r); }},
      {"rotation times scalar",
       [](Random& r, bool) {
         Matrix A = random_rotation(r);
         const Real s = r.sign() * std::exp(2 * r.gaussian());
         for (Real& a : A) a *= s;
         return A;
       }},
      {"nearly equal",
       [](Random& r, bool single) {
         const Real k = power(r.uniform(-2, 4)) * eps(single);
         return with_singular_values(r, 1, 1 + k * r.gaussian(), 1 + k * r.gaussian());
       }},
      {"I + k eps",
       [](Random& r, bool single) {
         Matrix A;
         for (int k = 0; k < 9; ++k) A[k] = (k % 4 == 0) + (r.below(9) - 4) * eps(single);
         return A;
       }},
      {"approaching one",
       [](Random& r, bool single) {
         const double m = single ? 8 : 16;
         return with_singular_values(r, 1, 1 - power(-m * r.uniform()),
                                     1 - power(-m * r.uniform()));
       }},
      {"close pair",
       [](Random& r, bool single) {
         const Real close = 1 - power(-(single ? 8 : 16) * r.uniform()), s = r.uniform(0, 2);
         return r.uniform() < 0.5 ? with_singular_values(r, 1, close, s / 2)
                                  : with_singular_values(r, 2, s / 2, s / 2 * close);
       }},
      {"rank 1",
       [](Random& r, bool) { return with_singular_values(r, std::exp(r.gaussian()), 0, 0); }},
      {"rank 1, one axis",
       [](Random& r, bool) {
         Matrix A{};
         const int row = r.below(3);
         for (int j = 0; j < 3; ++j) A[3 * row + j] = r.below(3) == 0 ? 0 : r.gaussian();
         return r.below(2) ? A : transpose(A);
       }},
      {"rank 2",
       [](Random& r, bool) {
         return with_singular_values(r, std::exp(r.gaussian()), std::exp(r.gaussian()), 0);
       }},
      {"zero", [](Random&, bool) { return Matrix{}; }},
      {"integers -1, 0, 1",
       [](Random& r, bool) {
         Matrix A;
         for (Real& a : A) a = r.below(3) - 1;
         if (r.below(2))
           for (int i = 0; i < 3; ++i) A[3 * i + r.below(3)] = 0;
         return A;
       }},
      {"inverted snow",
       [](Random& r, bool) {
         Matrix A = near_identity(r);
         const int column = r.below(3);
         for (int i = 0; i < 3; ++i) A[3 * i + column] *= -1;
         return A;
       }},
      {"inverted Gaussian",
       [](Random& r, bool) {
         Matrix A = gaussian(r, 1);
         if (det(A) > 0)
           for (Real& a : A) a = -a;
         return A;
       }},
      {"condition 1e4 to 1e16",
       [](Random& r, bool single) {
         const double k = single ? r.uniform(4, 8) : r.uniform(8, 16);
         return with_singular_values(r, 1, power(-k * r.uniform()), r.sign() * power(-k));
       }},
      {"1, root eps, root eps times r",
       [](Random& r, bool single) {
         const Real s = power(single ? -r.uniform(2.5, 5) : -r.uniform(6, 11));
         return with_singular_values(r, 1, s, r.sign() * s * r.uniform());
       }},
      {"signed diagonal",
       [](Random& r, bool) {
         Matrix A{};
         for (int i = 0; i < 3; ++i)
           A[4 * i] = r.sign() * (r.below(4) ? std::exp(r.gaussian()) : 1);
         return A;
       }},
      {"signed permutation times powers of two",
       [](Random& r, bool) {
         const int p = r.below(3), q = (p + 1 + r.below(2)) % 3;
         Matrix A{};
         for (int i = 0; i < 3; ++i) {
           const int column = i == 0 ? p : i == 1 ? q : 3 - p - q;
           A[3 * i + column] = r.sign() * std::ldexp(Real(1), r.below(60) - 50);
         }
         return A;
       }},
      {"log-uniform mixed entries",
       [](Random& r, bool single) {
         Matrix A;
         for (Real& a : A) a = r.gaussian() * power(single ? r.uniform(-8, 0) : r.uniform(-16, 0));
         return A;
       }},
      {"awkward numbers",
       [](Random& r, bool single) {
         static const double some[] = {0,        0,       1,       -1,       0x1p-12,
                                       -0x1p-12, 0x1p-24, 0x1p-26, -0x1p-26, 0x1p-52,
                                       -0x1p-53, -0.5,    2,       -0x1p-23};
         Matrix A;
         for (Real& a : A) {
           const int k = r.below(15);
           a = k < 14 ? some[k] : 1 + eps(single);
         }
         return A;
       }},
      {"small", [](Random& r, bool single) { return gaussian(r, power(single ? -15 : -20)); }},
      {"large", [](Random& r, bool single) { return gaussian(r, power(single ? 15 : 20)); }},
      {"very small",
       [](Random& r, bool single) { return gaussian(r, power(single ? -20 : -160)); }},
      {"very large", [](Random& r, bool single) { return gaussian(r, power(single ? 20 : 160)); }},
      {"scale 1e-2", [](Random& r, bool) { return gaussian(r, 1e-2L); }},
      {"near overflow",
       [](Random& r, bool single) {
         Matrix A;
         for (Real& a : A) a = r.uniform(-1, 1) * power(single ? 37 : 307);
         return A;
       }},
      {"denormal", [](Random& r, bool single) { return gaussian(r, power(single ? -40 : -310)); }},
  };
  return families;
}

}  // namespace firn::verification
