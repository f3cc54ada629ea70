// SPDX-License-Identifier: BSD-3-Clause
#include "bench/kernels/matrices.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "optimized/math/batch.hpp"

namespace firn::bench {

namespace {

constexpr std::size_t packet = kernels::packet_size;

std::size_t place(std::size_t index, std::size_t component) {
  return (index / packet * 9 + component) * packet + index % packet;
}

}  // namespace

std::vector<Mat3> matrices(const std::string& family, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return (static_cast<double>(engine() >> 11) + 0.5) * 0x1p-53; };
  // Box and Muller: the same numbers on every machine, as std::normal_distribution is not.
  const auto normal = [&] {
    const double a = uniform(), b = uniform();
    return std::sqrt(-2 * std::log(a)) * std::cos(2 * M_PI * b);
  };
  const bool gaussian = family == "Gaussian";
  const double size = gaussian ? 1 : family == "snow" ? 0.03 : 0.003;
  std::vector<Mat3> result(count);
  for (Mat3& A : result) {
    for (int c = 0; c < 9; ++c) A(c / 3, c % 3) = size * normal();
    if (!gaussian) A += Mat3::Identity();
  }
  return result;
}

template <class T>
std::vector<T> pack(const std::vector<Mat3>& matrices) {
  std::vector<T> packed((matrices.size() + packet - 1) / packet * packet * 9);
  for (std::size_t i = 0; i < matrices.size(); ++i)
    for (std::size_t c = 0; c < 9; ++c)
      packed[place(i, c)] =
          static_cast<T>(matrices[i](static_cast<int>(c / 3), static_cast<int>(c % 3)));
  return packed;
}

template <class T>
Mat3 unpack(const std::vector<T>& packed, std::size_t index) {
  Mat3 A;
  for (std::size_t c = 0; c < 9; ++c)
    A(static_cast<int>(c / 3), static_cast<int>(c % 3)) =
        static_cast<double>(packed[place(index, c)]);
  return A;
}

template std::vector<float> pack<float>(const std::vector<Mat3>&);
template std::vector<double> pack<double>(const std::vector<Mat3>&);
template Mat3 unpack<float>(const std::vector<float>&, std::size_t);
template Mat3 unpack<double>(const std::vector<double>&, std::size_t);

void SvdQuality::take(const Mat3& A, const Mat3& U, const Vec3& sigma, const Mat3& V, double eps) {
  const double off = (U * sigma.asDiagonal() * V.transpose() - A).norm() / A.norm() / eps;
  const double skew = std::max((U.transpose() * U - Mat3::Identity()).norm(),
                               (V.transpose() * V - Mat3::Identity()).norm()) /
                      eps;
  // NaN is worse than anything.
  backward = off <= backward ? backward : off;
  orthogonality = skew <= orthogonality ? orthogonality : skew;
}

}  // namespace firn::bench
