#pragma once
/// Which nodes a particle touches, and with which weights. Computed once at the
/// beginning of a step: positions move only at its end.

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "firn/scene.hpp"
#include "firn/state.hpp"

namespace firn::reference {

/// Whether the cell of x has an index that can be represented: at most 2^30 cells
/// from the grid's origin along each axis. False for NaN.
bool inside_domain(const GridSettings& grid, const Vec3& x);

/// A number for every point (i,j,k) of an unbounded lattice that was asked for;
/// −1 for points seen for the first time. The points are kept in hashed blocks
/// of 4×4×4, because a scene may be spread out and yet locally dense.
class SparseNumbers {
 public:
  /// From one k to the next the numbers are adjacent in memory, within a block:
  /// up to the next multiple of 4.
  std::int32_t& operator[](const NodeIndex& n);
  void clear();

 private:
  struct Hash {
    std::size_t operator()(const NodeIndex& block) const;
  };
  using Block = std::array<std::int32_t, 64>;
  /// Neighbours are asked for one after the other: where the blocks used last are.
  struct Recent {
    NodeIndex block;
    Block* numbers = nullptr;
  };
  std::unordered_map<NodeIndex, Block, Hash> blocks_;
  std::array<Recent, 64> recent_;
};

/// The 4×4×4 nodes around every particle.
class Stencils {
 public:
  /// Finds the nodes within reach of the particles, sorted by (i,j,k), and the
  /// weights. Throws SimulationError for a particle more than 2^30 cells away
  /// from the origin, in the name of `stage`.
  void build(const Scene& scene, const Particles& particles, Stage stage,
             std::vector<NodeIndex>& node);

  /// Memory held, without the hash tables [B].
  double bytes() const;

  /// Calls visit(i, w_ip) for each of the 64 nodes i around particle p; w_ip =
  /// N((x_p − x_i)/h) N((y_p − y_i)/h) N((z_p − z_i)/h).
  template <class Visit>
  void for_each_node(std::size_t p, Visit&& visit) const {
    const Weights& w = weights_[p];
    const std::int32_t* i = nodes_of_cell_[static_cast<std::size_t>(w.cell)].data();
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        const double NN = w.N[0][a] * w.N[1][b];
        for (int c = 0; c < 4; ++c, ++i) visit(static_cast<std::size_t>(*i), NN * w.N[2][c]);
      }
  }

  /// Calls visit(i, w_ip, ∇w_ip); the gradient is with respect to x_p, in 1/m.
  template <class Visit>
  void for_each_node_with_gradient(std::size_t p, Visit&& visit) const {
    const Weights& w = weights_[p];
    const std::int32_t* i = nodes_of_cell_[static_cast<std::size_t>(w.cell)].data();
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        const double NN = w.N[0][a] * w.N[1][b];
        const double dNN = w.dN[0][a] * w.N[1][b];
        const double NdN = w.N[0][a] * w.dN[1][b];
        for (int c = 0; c < 4; ++c, ++i)
          visit(static_cast<std::size_t>(*i), NN * w.N[2][c],
                Vec3(dNN * w.N[2][c], NdN * w.N[2][c], NN * w.dN[2][c]));
      }
  }

 private:
  struct Weights {
    double N[3][4];     ///< along each axis
    double dN[3][4];    ///< derivative with respect to x_p: N'/h [1/m]
    std::int32_t cell;  ///< particles of the same cell touch the same nodes
  };

  void weigh(const Scene& scene, const Particles& particles, Stage stage, std::size_t p);
  void number_nodes(std::vector<NodeIndex>& node);

  std::array<int, 3> period_{};  ///< nodes along each axis, 0 = open
  std::vector<Weights> weights_;
  std::vector<NodeIndex> first_node_of_cell_;
  std::vector<std::array<std::int32_t, 64>> nodes_of_cell_;
  SparseNumbers cell_number_, node_number_;
};

}  // namespace firn::reference
