// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Everything that a trajectory file holds, created at full size.

#include <cstddef>
#include <cstdint>

#include "io/hdf5/id.hpp"
#include "io/trajectory/format.hpp"

namespace firn {

struct TrajectorySize {
  std::int64_t particles = 0;
  std::size_t restart_size = 0;  ///< bytes per frame
  std::int64_t frames = 0;       ///< room for so many, ≥ 1
  std::int64_t rows = 0;

  /// Bytes on the disk, without headers.
  double bytes(Precision precision) const;
};

/// Creates all groups, datasets and attributes in a new file. NSteps and rows
/// are 0, Steps/Values has one place. Throws OutputError.
void create_trajectory_layout(hid_t file, const TrajectoryInfo& info, const TrajectorySize& size);

}  // namespace firn
