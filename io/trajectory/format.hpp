// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What writer and reader of trajectories share: names, units and shapes.
///
/// A trajectory is one HDF5 file with two groups. `/VTKHDF` is temporal VTKHDF
/// PolyData 2.0, which ParaView ≥ 5.12 (VTK ≥ 9.3) opens as it is: frame k of N
/// particles occupies rows k·N … (k+1)·N − 1 of Points and of every array in
/// PointData. `/firn` holds where the file comes from, one diagnostics row per
/// step, the step number of each frame, and what a bitwise restart needs beyond
/// the particles. docs/files.md has the full table.
///
/// The file counts its frames in `/VTKHDF/Steps`, attribute NSteps, and its rows
/// in `/firn/diagnostics`, attribute rows. Arrays may be longer than that while
/// the file is being written, and stay longer if the writer is killed. The one
/// exception is Steps/Values, which has NSteps values at any moment: VTK's
/// reader copies all of it into NSteps places and crashes if there are more.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "firn/types.hpp"
#include "io/trajectory/diagnostics_row.hpp"

namespace firn {

/// The attributes of /firn beside `format` and `version`.
struct TrajectoryInfo {
  std::string solver;
  Precision precision = Precision::float64;  ///< particle data: 64-bit or 32-bit datasets
  int threads = 1;
  std::string firn_version;
  std::string processor;
  std::string scene;  ///< resolved TOML text
};

inline constexpr std::string_view trajectory_format = "firn-trajectory";
inline constexpr std::int64_t trajectory_version = 1;

/// One particle quantity and where a file holds it.
struct ParticleArray {
  const char* name;      ///< "velocity"
  const char* path;      ///< "/VTKHDF/PointData/velocity"
  const char* units;     ///< "m/s"
  int components;        ///< 9: a matrix, row-major
  bool integer = false;  ///< else stored in the precision of the file
};

/// Positions stand beside PointData, everything else in it.
inline bool is_point_data(const ParticleArray& array) {
  return std::string_view(array.name) != "position";
}

/// Calls visit(ParticleArray, array…) for every dataset of a frame, with that array of each
/// of `particles`: the one list of what a trajectory holds per particle.
template <class Visit, class... P>
void for_each_array(Visit&& visit, P&... particles) {
  visit(ParticleArray{"position", "/VTKHDF/Points", "m", 3}, particles.x...);
  visit(ParticleArray{"velocity", "/VTKHDF/PointData/velocity", "m/s", 3}, particles.v...);
  visit(ParticleArray{"mass", "/VTKHDF/PointData/mass", "kg", 1}, particles.m...);
  visit(ParticleArray{"volume", "/VTKHDF/PointData/volume", "m^3", 1}, particles.V_0...);
  visit(ParticleArray{"F_E", "/VTKHDF/PointData/F_E", "1", 9}, particles.F_E...);
  visit(ParticleArray{"F_P", "/VTKHDF/PointData/F_P", "1", 9}, particles.F_P...);
  visit(ParticleArray{"id", "/VTKHDF/PointData/id", "1", 1, true}, particles.id...);
  visit(ParticleArray{"material", "/VTKHDF/PointData/material", "1", 1, true},
        particles.material...);
}

/// One dataset of /firn/diagnostics.
struct DiagnosticsColumn {
  const char* name;
  const char* units;
  int components;
  bool integer;
  bool optional = false;  ///< files of other programs, and of older versions, may lack it
};

inline constexpr std::array<DiagnosticsColumn, 15> diagnostics_columns = {
    {{"time", "s", 1, false},
     {"dt", "s", 1, false},
     {"mass", "kg", 1, false},
     {"momentum", "kg m/s", 3, false},
     {"angular_momentum", "kg m^2/s", 3, false},
     {"kinetic_energy", "J", 1, false},
     {"elastic_energy", "J", 1, false},
     {"gravitational_energy", "J", 1, false},
     {"center_of_mass", "m", 3, false},
     {"max_speed", "m/s", 1, false},
     {"min_J_E", "1", 1, false},
     {"max_J_E", "1", 1, false},
     {"grid_nodes", "1", 1, true},
     {"solver_iterations", "1", 1, true},
     {"solver_residual", "1", 1, false, true}}};

/// Bytes of one diagnostics row.
inline constexpr double diagnostics_row_bytes = 8 * 21;

/// The values of one column in one row: `components` of them, from `values` on.
/// Integer columns: grid_nodes and solver_iterations, exact in a double.
void get_column(const DiagnosticsRow& row, std::size_t column, double* values);
void set_column(DiagnosticsRow& row, std::size_t column, const double* values);

}  // namespace firn
