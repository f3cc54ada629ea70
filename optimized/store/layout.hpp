// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How the optimized solver lays its numbers out in memory: plain data that the
/// drivers (compiled for the baseline instruction set) and the kernels (compiled
/// once for every instruction set) share. No code with branches lives here.

#include <cstdint>

#include "optimized/math/elastic_box.hpp"

namespace firn::optimized {

/// Cells along an edge of a particle block, nodes along an edge of a node block.
inline constexpr int block_cells = 4;
/// Nodes along an axis that a particle touches: the support of a cubic B-spline.
inline constexpr int stencil_nodes = 4;
/// Nodes along an edge of a block's tile: 4 cells reach 4 + 3 nodes.
inline constexpr int tile_nodes = block_cells + stencil_nodes - 1;
/// The z-rows of a tile are padded to a power of two.
inline constexpr int tile_row = 8;
/// Nodes of a node block and cells of a particle block, (4x + y)·4 + z is the number of each.
inline constexpr int nodes_per_block = block_cells * block_cells * block_cells;
inline constexpr int cells_per_block = nodes_per_block;
/// Rows of a node block along z, and cells of a particle block at one x: an x-slab.
inline constexpr int rows_per_block = block_cells * block_cells;
inline constexpr int cells_per_slab = rows_per_block;
/// Node blocks that a tile meets where no period cuts them: b + {0,1}³.
inline constexpr int tile_corners = 8;

/// Number of node (x, y, z) in its node block, of cell (x, y, z) in its particle block.
constexpr int number_in_block(int x, int y, int z) {
  return (block_cells * x + y) * block_cells + z;
}

/// A chunk holds one cache line of every particle quantity: quantity s of lane l
/// lies at chunk[s·chunk_lanes + l]. The same on every instruction set, so that
/// restart data may move between machines.
inline constexpr int cache_line = 64;  ///< bytes
template <class T>
inline constexpr int chunk_lanes = cache_line / int{sizeof(T)};

/// Particles per page, the unit in which a block's memory grows.
inline constexpr int page_particles = 32;

/// The quantities of a particle, one slot each.
enum Slot : int {
  slot_x = 0,           ///< position inside the block, see position-inl.h (3)
  slot_v = 3,           ///< v_p [m/s] (3)
  slot_E_E = 6,         ///< F_E − I, row-major (9)
  slot_E_P = 15,        ///< F_P − I, row-major (9)
  slot_tau = 24,        ///< V_p0 P F_Eᵀ [J], symmetric: 00 01 02 11 12 22 (6)
  slot_m = 30,          ///< m_p [kg]
  slot_V_0 = 31,        ///< V_p0 [m³]
  slot_stiffness = 32,  ///< 2 μ V_p0 with the hardened μ [J]
  slot_index = 33,      ///< place in the caller's order, an integer of the size of T
  slots_common = 34,
  slot_material = 34,  ///< an integer of the size of T; present if the scene has several materials
};

/// Integers of the size of T: float positions and indices are stored as such.
template <class T>
struct IntegerOf;
template <>
struct IntegerOf<float> {
  using Type = std::int32_t;
};
template <>
struct IntegerOf<double> {
  using Type = std::int64_t;
};
template <class T>
using Integer = typename IntegerOf<T>::Type;

/// Float positions are fixed-point: 2^28 units per grid spacing. A block is 2^30
/// wide and an int32 reaches 8 spacings to either side, so that a position plus a
/// displacement of less than one block never overflows. The resolution, 4e-9 h,
/// is 64 times that of a float in [2, 4).
inline constexpr std::int32_t fixed_one = 1 << 28;

/// Quantities that a tile carries per node: m v (3) and m, then the force (3).
/// A row of a tile is 8 nodes in z times C channels, C = what fits beside 4 nodes
/// in a vector; rows 0 … 4/C−1 hold (m v, m), the rest the force.
struct TileShape {
  int channels;       ///< C: 1, 2 or 4
  int mass_rows;      ///< 4/C
  int force_rows;     ///< 4/C, 3 for C = 1
  int gather_rows;    ///< rows of (v_new, u): ⌈6/C⌉
  int tile_size;      ///< values in a block's tile
  int gathered_size;  ///< values in a node block's (v_new, u)
  int sums_size;      ///< values in a node block's sums of tiles
};

/// Constants of one material.
template <class T>
struct MaterialConstants {
  T two_mu_0;                  ///< 2 μ_0 [Pa]
  T lambda_over_2mu;           ///< λ_0 / (2 μ_0) [1]
  T hardening;                 ///< ξ
  kernels::ElasticBox<T> box;  ///< limits of the elastic singular values
};

/// What the kernels leave out where it changes nothing (skips.hpp).
struct KernelSkips {
  bool box = true;        ///< the return map of particles certified elastic
  bool hardening = true;  ///< the exponential where J_P has not changed
  bool plastic = true;    ///< reading and writing F_P of vectors in which nothing yields
  bool rest = true;       ///< stress and forces of particles whose F_E is exactly I
};

/// What is the same for all particles and nodes during a step.
template <class T>
struct StepConstants {
  const MaterialConstants<T>* materials;
  int material_count;
  int slots;        ///< per particle: slots_common, + 1 with several materials
  T dt;             ///< Δt [s]
  T dt_over_h;      ///< Δt/h [s/m]
  T minus_inv_h;    ///< −1/h [1/m]
  T gravity_dt[3];  ///< Δt g [m/s]
  T flip;           ///< α
  KernelSkips skip;
};

/// One block of particles as a kernel sees it.
template <class T>
struct BlockView {
  T* const* pages;  ///< ⌈count/page_particles⌉ of them
  int count;        ///< particles
  T limit[3];       ///< a particle stays if 0 ≤ x < limit along each axis, in units of h
};

/// Scratch memory of one thread, large enough for its largest block.
template <class T>
struct Workspace {
  T* records;             ///< record_size per particle, sorted by cell
  std::uint8_t* cells;    ///< cell number of every particle, 0 … 63
  T* moments;             ///< one x-slab of P2G
  T* local;               ///< the 7×7×8 node values that a block gathers from
  T* coefficients;        ///< their difference form
  std::int32_t* leavers;  ///< particles that left the block, ascending
};

/// Values per P2G record.
inline constexpr int record_size = 28;
/// Values that a node's rows hold at most: 4 of mass and momentum and 4 of force in the scatter,
/// 8 of (v_new, u) in the gather, channels without a quantity included.
inline constexpr int values_per_node = 8;
/// The sums n0, s0, s1, n3 that stand for a row's 4 nodes in x while a slab is scattered
/// (p2g-inl.h).
inline constexpr int sums_in_x = 4;
/// The difference form of the node values that a block gathers from (g2p-inl.h): value, first and
/// second difference at the nodes 1 … 5 of the tile's 0 … 6 in x.
inline constexpr int kinds_in_x = 3;
inline constexpr int inner_planes = tile_nodes - 2;

/// Bounds on the scratch arrays' lengths; coefficients may hold a row of 4 nodes for each cell.
inline constexpr int moments_size = tile_nodes * sums_in_x * values_per_node * tile_row;
inline constexpr int local_size = tile_nodes * tile_nodes * values_per_node * tile_row;
inline constexpr int coefficients_size =
    inner_planes * tile_nodes * kinds_in_x * values_per_node * stencil_nodes * block_cells;

/// What stages 6 to 8 need of one node block, planar: node (x,y,z) at (4x + y)·4 + z.
template <class T>
struct NodeMotion {
  T m[nodes_per_block];          ///< m_i
  T v[3][nodes_per_block];       ///< v_iⁿ
  T v_star[3][nodes_per_block];  ///< v_i*, then v_i^{n+1}
};

/// All fields of one node block.
template <class T>
struct NodeFields : NodeMotion<T> {
  T momentum[3][nodes_per_block];  ///< Σ m_p v_p w_ip
  T f[3][nodes_per_block];         ///< f_i
};

/// A box of nodes seen from two sides: tile nodes from `tile` on are a node
/// block's nodes from `node` on.
struct Region {
  int tile[3], node[3], size[3];
};

/// Where something stopped being finite (or ran too far): the first place found.
enum class Fault : int { none, deformation, velocity, position };

/// What went wrong in a kernel, if anything, and where in its block.
struct FaultReport {
  Fault fault = Fault::none;
  int place = -1;  ///< particle in the block
};

/// What a pass over the particles of a block does; combined by |.
enum Pass : int {
  pass_deformation = 1,  ///< stage 7: F_E, F_P and the stress that follows from them
  pass_velocity = 2,     ///< stage 8: v_p
  pass_position = 4,     ///< stage 10: x_p
};

}  // namespace firn::optimized
