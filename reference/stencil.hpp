// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which nodes a particle touches, and with which weights. Computed once at the
/// beginning of a step: positions move only at its end.

#include <array>
#include <cstdint>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"
#include "reference/kernel.hpp"

namespace firn::reference {

/// Whether the cell of x has an index that can be represented: at most 2^30 cells
/// from the grid's origin along each axis. False for NaN.
bool inside_domain(const GridSettings& grid, const Vec3& x);

/// The nodes around every particle: width³ of them, with the width of kernel.hpp.
class Stencils {
 public:
  /// Finds the nodes within reach of the particles, sorted by (i,j,k), and the
  /// weights. Throws SimulationError for a particle more than 2^30 cells away
  /// from the origin, in the name of `stage`.
  void build(const Scene& scene, const Particles& particles, Stage stage,
             std::vector<NodeIndex>& node);

  /// Memory held [B].
  double bytes() const;

  /// Calls visit(i, w_ip) for each node i around particle p; w_ip =
  /// N((x_p − x_i)/h) N((y_p − y_i)/h) N((z_p − z_i)/h).
  template <class Visit>
  void for_each_node(std::size_t p, Visit&& visit) const {
    const auto& [x, y, z] = stencils_[p].row;
    const std::int32_t* i = nodes_around(p);
    for (int a = 0; a < kernel_.width; ++a)
      for (int b = 0; b < kernel_.width; ++b) {
        const double NN = x.N[a] * y.N[b];
        for (int c = 0; c < kernel_.width; ++c, ++i)
          visit(static_cast<std::size_t>(*i), NN * z.N[c]);
      }
  }

  /// Calls visit(i, w_ip, ∇w_ip); the gradient is with respect to x_p, in 1/m.
  template <class Visit>
  void for_each_node_with_gradient(std::size_t p, Visit&& visit) const {
    const auto& [x, y, z] = stencils_[p].row;
    const std::int32_t* i = nodes_around(p);
    for (int a = 0; a < kernel_.width; ++a)
      for (int b = 0; b < kernel_.width; ++b) {
        const double NN = x.N[a] * y.N[b];
        const double dNN = x.dN[a] * y.N[b];
        const double NdN = x.N[a] * y.dN[b];
        for (int c = 0; c < kernel_.width; ++c, ++i)
          visit(static_cast<std::size_t>(*i), NN * z.N[c],
                Vec3(dNN * z.N[c], NdN * z.N[c], NN * z.dN[c]));
      }
  }

 private:
  struct Stencil {
    std::array<Kernel::Row, 3> row;  ///< weights along x, y, z
    std::size_t cube;                ///< number of its cube of nodes, one for each occupied cell
  };

  const std::int32_t* nodes_around(std::size_t p) const {
    const auto width = static_cast<std::size_t>(kernel_.width);
    return &places_[stencils_[p].cube * width * width * width];
  }

  Kernel kernel_;
  std::vector<Stencil> stencils_;     ///< one per particle
  std::vector<std::int32_t> places_;  ///< where the nodes of each cube stand in the list of nodes
};

}  // namespace firn::reference
