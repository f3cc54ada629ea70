// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Where a check found what error: particles and nodes in space, for each compared step.

#include <cstdint>
#include <string>
#include <vector>

#include "verification/check/check.hpp"

namespace firn {

/// Errors of one row of the table at every point, in units of the bound; 0 where the row has no
/// number there. Of a vector or matrix the largest component counts.
struct ErrorColumn {
  std::string name;  ///< "3_grid_forces f_i", "1-10 v_p"
  std::vector<float> in_bounds;
};

/// Particles first, in the order of their ids' states, then the nodes of positive mass.
struct ErrorFrame {
  std::int64_t step = 0;
  double time = 0;               ///< [s]
  std::vector<Vec3> point;       ///< x_p at the start of the step; x_i [m]
  std::vector<std::int64_t> id;  ///< of a particle; −1 for a node
  std::vector<NodeIndex> node;   ///< (i,j,k); 0 for a particle
  std::vector<ErrorColumn> columns;
};

class ErrorMap {
 public:
  /// The numbers of one row in one step, which began with `input`.
  void add(const Scene& scene, const State& input, const State& reference, const FieldCheck& row,
           const std::vector<Place>& places);

  const std::vector<ErrorFrame>& frames() const { return frames_; }

 private:
  ErrorFrame& frame_of(const State& input);

  std::vector<ErrorFrame> frames_;
};

}  // namespace firn
