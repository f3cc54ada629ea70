// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The weights around one particle together with what an error of its position
/// does to them. Written for the checker alone: it judges solvers and shares no
/// code with any.

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn::check {

/// Node i as particle p sees it.
struct StencilNode {
  std::int32_t node = -1;   ///< place in Grid::node; −1: the reference has no mass there
  double w = 0;             ///< w_ip [1]
  double w_error = 0;       ///< largest |δw_ip| that the position's error can cause
  Vec3 grad_w;              ///< ∇w_ip [1/m]
  double grad_w_error = 0;  ///< largest ‖δ∇w_ip‖ [1/m]
};

/// All particles' stencils at the positions of one time step.
///
/// A particle within its own error of a cell boundary has up to five candidate
/// nodes per axis instead of four, so that a node which only one of two correct
/// solvers touches still gets its bound.
class Stencils {
 public:
  Stencils() = default;

  /// `x_error[p]`: bound of |δx_p| per axis [m]. `tiny`: smallest normal number.
  Stencils(const Scene& scene, const Particles& particles, const Grid& grid,
           const std::vector<Vec3>& x_error, double tiny);

  /// Fills `out` with the stencil of particle p.
  void around(std::size_t p, std::vector<StencilNode>& out) const;

  /// Nodes that the reference does not have but a rounded position can reach,
  /// with the largest mass that could land there [kg].
  const std::map<NodeIndex, double>& stray_mass() const { return stray_mass_; }

 private:
  // Of the particles at the start of the step: their state may be gone when they are asked for.
  std::vector<Vec3> x_;
  std::vector<double> m_;
  Vec3 origin_;
  double h_ = 1;
  double tiny_ = 0;
  std::vector<Vec3> t_error_;       // |δx_p|/h, at most `largest_t_error`
  std::vector<std::size_t> first_;  // of particle p in node_
  std::vector<std::int32_t> node_;  // place in the grid, x slowest, z fastest
  std::map<NodeIndex, double> stray_mass_;
};

}  // namespace firn::check
