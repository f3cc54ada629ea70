// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Compares two trajectories, also ones that other programs wrote.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace firn {

struct CompareOptions {
  /// Frames belong together if their times differ by no more than this [s]. By default that is
  /// the rounding of a time that many additions of Δt reached, 1e-9·max(|t_A|, |t_B|)
  /// (4·10⁶ roundings of 2⁻⁵²); 2⁻²³·max(|t_A|, |t_B|) if the times of A or of B are all numbers
  /// of 32 bits, as in files that VTK has written.
  std::optional<double> time_tolerance;
};

/// One quantity over all matching frames and particles. The difference of a
/// particle is the Euclidean (Frobenius) norm of a − b; relative differences are
/// in units of the largest norm of that quantity in the two frames at hand.
struct QuantityComparison {
  std::string name, units;
  std::int64_t compared = 0;   ///< particles × frames
  std::int64_t different = 0;  ///< how many of these differ in some bit
  double max_absolute = 0, rms_absolute = 0;
  double max_relative = 0, rms_relative = 0;
  bool identical = true;  ///< every bit; NaN equals NaN

  /// Where max_absolute is (a non-finite difference beats all others).
  struct Worst {
    double time = 0;  ///< [s]
    std::int64_t frame_a = 0, frame_b = 0;
    std::int64_t id = 0;
    std::vector<double> a, b;  ///< the particle's values
  };
  std::optional<Worst> worst;
  std::optional<double> first_different_time;  ///< first frame in which they differ [s]
};

/// A frame in which the two files hold different particles.
struct ParticleMismatch {
  double time = 0;  ///< [s]
  std::int64_t only_in_a = 0, only_in_b = 0;
};

struct TrajectoryComparison {
  std::int64_t frames_a = 0, frames_b = 0, frames_matched = 0;
  std::vector<double> only_in_a, only_in_b;  ///< times of frames without a partner [s]
  bool times_identical = true;               ///< of the matched frames, every bit
  double max_time_difference = 0;            ///< of the matched frames [s]
  std::vector<ParticleMismatch> particle_mismatches;
  std::vector<QuantityComparison>
      quantities;  ///< position, velocity, mass, volume, F_E, F_P, material

  /// Same frames, same particles, same bits.
  bool identical() const;
};

/// Throws InputError for a file that cannot be read or has an id twice in a frame.
TrajectoryComparison compare_trajectories(const std::filesystem::path& a,
                                          const std::filesystem::path& b,
                                          const CompareOptions& options = {});

}  // namespace firn
