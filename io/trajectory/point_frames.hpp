// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Points with numbers that change from frame to frame, also in their count: a file for ParaView
/// beside trajectories (temporal VTKHDF PolyData 2.0).

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "firn/types.hpp"

namespace firn {

/// One array of numbers, `components` of them per point, row by row.
struct PointArray {
  std::string name;
  int components = 1;
  std::vector<float> values;
};

struct PointFrame {
  double time = 0;                 ///< [s]
  std::vector<Vec3> points;        ///< [m]
  std::vector<PointArray> arrays;  ///< the same names and components in every frame
};

/// Throws OutputError. The file appears under its name when it is complete; `format` is an
/// attribute of its group /firn.
void write_point_frames(const std::filesystem::path& path, const std::string& format,
                        const std::vector<PointFrame>& frames);

}  // namespace firn
