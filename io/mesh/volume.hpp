// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Everything that needs OpenVDB: implemented with it in volume_openvdb.cpp, and as an error
/// without it in volume_missing.cpp.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// Points origin + spacing·(i,j,k); arrays over them have k fastest.
struct SampleGrid {
  Vec3 origin = Vec3::Zero();
  double spacing = 0;
  std::array<int, 3> size{};

  Vec3 point(int i, int j, int k) const { return origin + spacing * Vec3(i, j, k); }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * size[1] + j) * size[2] + k;
  }
  std::size_t count() const { return index(size[0], 0, 0); }
};

/// Most samples that one shape may have: half a gigabyte of floats.
inline constexpr double largest_number_of_samples = 0x1p27;

/// Throws InputError if the grid has too many samples.
void require_samples_fit(const std::array<double, 3>& size, const std::string& where);

/// Adds `amount` to the count of every point inside a closed mesh of one shell,
/// which lies strictly within the grid.
void count_inside(const TriangleMesh& shell, const SampleGrid& grid, int amount,
                  std::vector<std::int16_t>& count, const std::string& where);

/// A level set as its file holds it: exact where |φ| < band, only the sign is right elsewhere.
struct LevelSet {
  SampleGrid grid;
  std::vector<float> phi;
  double band = 0;       ///< [m]
  TriangleMesh surface;  ///< {φ = 0}, meshed
};

LevelSet read_level_set(const std::string& path, const std::string& grid);

}  // namespace firn
