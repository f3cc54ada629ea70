// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What an open TrajectoryReader knows of its file.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/read.hpp"
#include "io/trajectory/format.hpp"
#include "io/trajectory/reader.hpp"

namespace firn {

/// Where one frame lies in the arrays.
struct FramePlace {
  double time = 0;             ///< [s]
  std::int64_t particles = 0;  ///< N
  std::int64_t first = 0;      ///< row in Points
};

struct TrajectoryReader::Open {
  explicit Open(const std::filesystem::path& path);

  void require_vtkhdf_polydata() const;
  void read_steps();
  void read_single_frame();
  void add_points(FramePlace& frame, std::int64_t more) const;
  void read_firn();
  void open_arrays();
  void open_array(const ParticleArray& array);
  std::int64_t first_row(const std::string& name, std::int64_t frame) const;
  const FramePlace& at(std::int64_t frame) const;

  template <class Value>
  void read(const std::string& name, std::int64_t frame, Value* values) const {
    arrays.at(name).read(first_row(name, frame), at(frame).particles, values);
  }

  /// Integers that must not be negative nor exceed 32 bits.
  std::vector<std::int32_t> read_small(const std::string& name, std::int64_t frame) const;

  hdf5::InputFile file;
  std::vector<FramePlace> frames;
  std::map<std::string, hdf5::InputDataset> arrays;          ///< by ParticleArray::name
  std::map<std::string, std::vector<std::int64_t>> offsets;  ///< Steps/PointDataOffsets
  std::optional<TrajectoryInfo> info;
  std::vector<std::int64_t> steps;
  std::optional<hdf5::InputDataset> restart;
  std::int64_t rows = 0;         ///< of /firn/diagnostics
  std::int64_t stored_rows = 0;  ///< of particle arrays: those that have bytes behind them
};

}  // namespace firn
