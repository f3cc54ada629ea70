// SPDX-License-Identifier: BSD-3-Clause
// Step 7 of optimized/math/return_map-inl.h: the fast way and the way by full decompositions, on
// every instruction set, in float and double, against the definition in long double.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

#include "verification/oracles/elastic_oracle.hpp"
#include "verification/oracles/svd_families.hpp"
#include "verification/tests/optimized/math/elastic_cases.hpp"

namespace firn::verification {
namespace {

Matrix identity() { return {1, 0, 0, 0, 1, 0, 0, 0, 1}; }

/// Trial states F̂.
const std::vector<Family>& trial_states() {
  static const std::vector<Family> families = {
      {"snow", [](Random& r, bool) { return families_detail::near_identity(r); }},
      {"snow, turned",
       [](Random& r, bool) {
         return with_singular_values(r, r.uniform(0.95, 1.05), r.uniform(0.95, 1.05),
                                     r.uniform(0.95, 1.05));
       }},
      {"all inside",
       [](Random& r, bool) {
         return with_singular_values(r, r.uniform(0.976, 1.007), r.uniform(0.976, 1.007),
                                     r.uniform(0.976, 1.007));
       }},
      {"barely outside",
       [](Random& r, bool single) {
         const Real k = families_detail::eps(single) * r.uniform(0, 100);
         return r.below(2) ? with_singular_values(r, 1 + theta_s + k, 1, r.uniform(0.98, 1))
                           : with_singular_values(r, 1, r.uniform(0.98, 1), 1 - theta_c - k);
       }},
      {"uniform",
       [](Random& r, bool) {
         Matrix F = r.below(2) ? identity() : random_rotation(r);
         const Real s = r.uniform(0.6, 1.6);
         for (Real& a : F) a *= s;
         return F;
       }},
      {"diagonal",
       [](Random& r, bool) {
         return Matrix{r.uniform(0.8, 1.2),
                       0,
                       0,
                       0,
                       r.uniform(0.8, 1.2),
                       0,
                       0,
                       0,
                       r.below(2) ? 1 : r.uniform(0.8, 1.2)};
       }},
      {"equal pair",
       [](Random& r, bool single) {
         const Real s = r.uniform(0.9, 1.1), k = families_detail::eps(single) * r.below(5);
         return r.below(2) ? with_singular_values(r, s, s + k, 1)
                           : with_singular_values(r, 1, s, s + k);
       }},
      {"large",
       [](Random& r, bool) {
         return with_singular_values(r, r.uniform(0.3, 3), r.uniform(0.3, 3), r.uniform(0.3, 3));
       }},
      {"Gaussian", [](Random& r, bool) { return families_detail::gaussian(r, 1); }},
      {"inverted",
       [](Random& r, bool) {
         return with_singular_values(r, r.uniform(0.9, 1.1), r.uniform(0.9, 1.1),
                                     r.uniform(-0.5, 0));
       }},
      {"rank 1", [](Random& r, bool) { return with_singular_values(r, r.uniform(0.5, 2), 0, 0); }},
      {"zero", [](Random&, bool) { return Matrix{}; }},
      {"integers -1, 0, 1",
       [](Random& r, bool) {
         Matrix A;
         for (Real& a : A) a = r.below(3) - 1;
         return A;
       }},
  };
  return families;
}

template <class T>
struct State {
  Packed<T> E, P, changed;  // F_E − I, F_P − I
};

template <class T>
State<T> trial(const Family& family, std::size_t n, std::uint64_t seed) {
  State<T> s{Packed<T>(n, 9), Packed<T>(n, 9), Packed<T>(n, 1)};
  Random random(seed);
  for (std::size_t i = 0; i < n; ++i) {
    put(s.E, i, minus_identity(family.make(random, sizeof(T) == 4)));
    Matrix P;
    for (Real& p : P) p = 0.1 * random.uniform(-1, 1);
    put(s.P, i, P);
  }
  return s;
}

class ReturnMapKernel : public EveryTarget {};

template <class T>
struct Worst {
  Spread product, stretch, F_E, F_P, ways;
};

/// What one lane must satisfy. Roundoff of numbers of size `size` and of their products, a few
/// dozen of them: 16 eps.
template <class T, class Exact>
void check_lane(const Matrix& F_hat, const Matrix& F_P, const Exact& exact, const State<T>& after,
                std::size_t i, Worst<T>& worst) {
  const Matrix E = plus_identity(matrix(after.E, i)), P = plus_identity(matrix(after.P, i));
  const Real size = std::max(Real(1), exact.trial.sigma[0]);

  Matrix defect = multiply(E, P);
  const Matrix product = multiply(F_hat, F_P);
  for (int k = 0; k < 9; ++k) defect[k] -= product[k];
  worst.product.add(norm(defect) / (norm(F_P) * size) / roundoff<T>);

  const Svd result = svd_oracle(E);
  const Real beyond = std::max(result.sigma[0] - (1 + static_cast<Real>(theta_s)),
                               (1 - static_cast<Real>(theta_c)) - result.sigma[2]);
  worst.stretch.add(std::max(beyond, Real(0)) / size / roundoff<T>);

  // The map itself is discontinuous where σ2 + σ3 = 0; away from that it is compared entry by
  // entry.
  if (exact.trial.sigma[1] + exact.trial.sigma[2] < 0.5L) return;
  Matrix dE, dP;
  for (int k = 0; k < 9; ++k) dE[k] = E[k] - exact.F_E[k], dP[k] = P[k] - exact.F_P[k];
  worst.F_E.add(norm(dE) / size / roundoff<T>);
  worst.F_P.add(norm(dP) / (norm(F_P) * size) / roundoff<T>);
}

template <class T>
void print(const char* family, const char* way, const Worst<T>& w) {
  if (std::getenv("FIRN_PRINT_ERRORS"))
    std::printf(
        "%-7s %-6s %-20s %-5s F_E F_P %5.2f  sigma %5.2f  F_E %5.2f  F_P %5.2f  fast-svd %5.2f\n",
        kernels::batch_kernels<T>().target, sizeof(T) == 4 ? "float" : "double", family, way,
        w.product.largest(), w.stretch.largest(), w.F_E.largest(), w.F_P.largest(),
        w.ways.largest());
}

template <class T>
void check_family(const Family& family, std::uint64_t seed) {
  SCOPED_TRACE(family.name);
  const std::size_t n = 1500 * sample_factor;
  const auto box = kernels::ElasticBox<T>::from(theta_c, theta_s);
  const auto& table = kernels::batch_kernels<T>();
  const State<T> before = trial<T>(family, n, seed);
  State<T> fast = before, full = before;
  table.return_map(box, fast.E.data(), fast.P.data(), fast.changed.data(), fast.E.packets());
  table.return_map_svd(box, full.E.data(), full.P.data(), full.changed.data(), full.E.packets());
  Worst<T> worst_fast, worst_full;
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix F_hat = plus_identity(matrix(before.E, i)),
                 F_P = plus_identity(matrix(before.P, i));
    const auto exact = return_map_oracle(F_hat, F_P, 1 - static_cast<Real>(static_cast<T>(theta_c)),
                                         1 + static_cast<Real>(static_cast<T>(theta_s)));
    check_lane(F_hat, F_P, exact, fast, i, worst_fast);
    check_lane(F_hat, F_P, exact, full, i, worst_full);
    const Svd& hat = exact.trial;
    if (hat.sigma[1] + hat.sigma[2] < 0.5L) continue;
    Real ways = 0;
    for (std::size_t k = 0; k < 9; ++k)
      ways = std::max({ways, std::abs(Real(fast.E(i, k)) - full.E(i, k)),
                       std::abs(Real(fast.P(i, k)) - full.P(i, k))});
    worst_fast.ways.add(ways / std::max(Real(1), hat.sigma[0]) / roundoff<T>);
  }
  print(family.name, "fast", worst_fast);
  print(family.name, "full", worst_full);
  for (const Worst<T>* w : {&worst_fast, &worst_full}) {
    EXPECT_LE(w->product.largest(), 16);
    EXPECT_LE(w->stretch.largest(), 16);
    EXPECT_LE(w->F_E.largest(), 16);
    EXPECT_LE(w->F_P.largest(), 16);
    EXPECT_LE(w->ways.largest(), 16);
  }
}

TEST_P(ReturnMapKernel, AgainstDefinitionInFloat) {
  std::uint64_t seed = 1;
  for (const Family& f : trial_states()) check_family<float>(f, seed++);
}

TEST_P(ReturnMapKernel, AgainstDefinitionInDouble) {
  std::uint64_t seed = 101;
  for (const Family& f : trial_states()) check_family<double>(f, seed++);
}

/// Inside the box nothing is touched, not one bit of F_E or F_P; outside something is.
template <class T>
void check_untouched() {
  const auto box = kernels::ElasticBox<T>::from(theta_c, theta_s);
  const auto& table = kernels::batch_kernels<T>();
  std::size_t untouched = 0, clamped = 0;
  for (const Family& family : trial_states()) {
    const State<T> before = trial<T>(family, 2003, 5);
    for (auto* way : {table.return_map, table.return_map_svd}) {
      State<T> after = before;
      way(box, after.E.data(), after.P.data(), after.changed.data(), after.E.packets());
      for (std::size_t i = 0; i < before.E.size(); ++i) {
        bool same = true;
        for (std::size_t k = 0; k < 9; ++k)
          same = same && std::memcmp(&before.E(i, k), &after.E(i, k), sizeof(T)) == 0 &&
                 std::memcmp(&before.P(i, k), &after.P(i, k), sizeof(T)) == 0;
        const Svd hat = svd_oracle(plus_identity(matrix(before.E, i)));
        const Real beyond =
            std::max(hat.sigma[0] - (1 + Real(theta_s)), (1 - Real(theta_c)) - hat.sigma[2]);
        if (after.changed(i, 0) == 0) {
          ASSERT_TRUE(same) << family.name << " " << i;
        }
        // Singular values are known to a few eps of F̂ − I, near a half turn ‖F̂ − I‖² = 8.
        if (beyond < -16 * roundoff<T>) {
          ASSERT_EQ(after.changed(i, 0), 0) << family.name << " " << i;
        }
        if (beyond > 16 * roundoff<T>) {
          ASSERT_EQ(after.changed(i, 0), 1) << family.name << " " << i;
        }
        (same ? untouched : clamped) += 1;
      }
    }
  }
  EXPECT_GT(untouched, 3000u);
  EXPECT_GT(clamped, 10000u);
}

TEST_P(ReturnMapKernel, InsideTheBoxNoBitChanges) {
  check_untouched<float>();
  check_untouched<double>();
}

/// Clamping what is clamped moves nothing by more than roundoff; a lane never sees its neighbours;
/// lanes that are not numbers stay alone, and an unbounded box clamps nothing.
template <class T>
void check_lanes() {
  const auto box = kernels::ElasticBox<T>::from(theta_c, theta_s);
  const auto& table = kernels::batch_kernels<T>();
  const std::size_t n = 1604;
  State<T> before{Packed<T>(n, 9), Packed<T>(n, 9), Packed<T>(n, 1)};
  Random random(77);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& f = trial_states()[static_cast<std::size_t>(random.below(13))];
    put(before.E, i, minus_identity(f.make(random, sizeof(T) == 4)));
    put(before.P, i, Matrix{0.1, 0, 0.01, 0, 0, 0, 0, 0.02, 0});
    if (i % 50 == 7) before.E(i, i % 9) = std::numeric_limits<T>::quiet_NaN();
  }
  for (auto* way : {table.return_map, table.return_map_svd}) {
    State<T> once = before;
    way(box, once.E.data(), once.P.data(), once.changed.data(), once.E.packets());
    State<T> twice = once;
    way(box, twice.E.data(), twice.P.data(), twice.changed.data(), twice.E.packets());
    State<T> moved = before;  // rotate every lane by 5 places
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 9; ++k)
        moved.E((i + 5) % n, k) = before.E(i, k), moved.P((i + 5) % n, k) = before.P(i, k);
    way(box, moved.E.data(), moved.P.data(), moved.changed.data(), moved.E.packets());
    for (std::size_t i = 0; i < n; ++i) {
      bool finite = true;
      for (std::size_t k = 0; k < 9; ++k)
        finite = finite && std::isfinite(once.E(i, k)) && std::isfinite(once.P(i, k));
      if (i % 50 == 7) {
        ASSERT_FALSE(finite) << i;
        continue;
      }
      ASSERT_TRUE(finite) << i;
      for (std::size_t k = 0; k < 9; ++k) {
        ASSERT_LE(std::abs(Real(once.E(i, k)) - twice.E(i, k)), 16 * roundoff<T>) << i;
        ASSERT_LE(std::abs(Real(once.P(i, k)) - twice.P(i, k)),
                  16 * roundoff<T> * (1 + std::abs(once.P(i, k))))
            << i;
        ASSERT_EQ(std::memcmp(&once.E(i, k), &moved.E((i + 5) % n, k), sizeof(T)), 0) << i;
        ASSERT_EQ(std::memcmp(&once.P(i, k), &moved.P((i + 5) % n, k), sizeof(T)), 0) << i;
      }
    }
    if (way == table.return_map) {  // one lane at a time: the same bits
      State<T> scalar = before;
      table.return_map_scalar(box, scalar.E.data(), scalar.P.data(), scalar.changed.data(),
                              scalar.E.packets());
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < 9 && i % 50 != 7; ++k) {
          ASSERT_EQ(std::memcmp(&once.E(i, k), &scalar.E(i, k), sizeof(T)), 0) << i;
          ASSERT_EQ(std::memcmp(&once.P(i, k), &scalar.P(i, k), sizeof(T)), 0) << i;
        }
    }
    const double inf = std::numeric_limits<double>::infinity();
    State<T> elastic = before;
    way(kernels::ElasticBox<T>::from(inf, inf), elastic.E.data(), elastic.P.data(),
        elastic.changed.data(), elastic.E.packets());
    for (std::size_t i = 0; i < n; ++i) {
      if (i % 50 == 7) continue;
      for (std::size_t k = 0; k < 9; ++k) {
        ASSERT_EQ(elastic.E(i, k), before.E(i, k)) << i;
      }
    }
  }
}

TEST_P(ReturnMapKernel, IdempotentAndLaneByLane) {
  check_lanes<float>();
  check_lanes<double>();
}

FIRN_ON_EVERY_TARGET(ReturnMapKernel);

}  // namespace
}  // namespace firn::verification
