// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The matrices on which decompositions are timed, and how good a decomposition is.

#include <cstdint>
#include <string>
#include <vector>

#include "firn/types.hpp"
#include "optimized/math/batch.hpp"

namespace firn::bench {

/// How many are timed: they stay in the second-level cache.
inline constexpr std::size_t count = 1024;
inline constexpr std::size_t packets = count / kernels::packet_size;

/// "snow": I + 0.03 N, mostly outside the elastic box; "elastic": I + 0.003 N, mostly
/// inside; "Gaussian": N. N has independent normal entries.
std::vector<Mat3> matrices(const std::string& family, std::size_t count, std::uint64_t seed);

/// Matrices to packets of 16 and back, as optimized/math/batch.hpp lays them out.
template <class T>
std::vector<T> pack(const std::vector<Mat3>& matrices);
template <class T>
Mat3 unpack(const std::vector<T>& packed, std::size_t index);

/// Largest ‖UΣVᵀ − A‖/‖A‖ and ‖QᵀQ − I‖ over all of them, in units of eps.
struct SvdQuality {
  double backward = 0, orthogonality = 0;
  void take(const Mat3& A, const Mat3& U, const Vec3& sigma, const Mat3& V, double eps);
};

}  // namespace firn::bench
