/// The same step stage by stage, with the kernels of the fused path, every field
/// kept: for looking between two stages, for the first step's volumes, and for
/// finding out which number stopped being finite.

#include <algorithm>
#include <array>
#include <cmath>
#include <omp.h>

#include "firn/error.hpp"
#include "optimized/drivers/solver.hpp"

namespace firn::optimized {

namespace {

/// N at the nodes −1, 0, 1, 2 around an offset t, outer branch factored.
std::array<double, 4> weights(double t) {
  const double o = 1 - t;
  return {o * o * o / 6, 2.0 / 3 - t * t + t * t * t / 2, 2.0 / 3 - o * o + o * o * o / 2,
          t * t * t / 6};
}

}  // namespace

template <class T>
void OptimizedSolver<T>::run(Stage stage) {
  const int n = static_cast<int>(nodes_.size());
  switch (stage) {
    case Stage::rasterize: rasterize(); break;
    case Stage::volumes: volumes(); break;
    case Stage::grid_forces: grid_forces(); break;
    case Stage::grid_velocities:
#pragma omp parallel for num_threads(threads_)
      for (int i = 0; i < n; ++i)
        kernels_.node_velocities_star(constants_, nodes_.fields(static_cast<std::size_t>(i)));
      require_finite(stage, &NodeFields<T>::v_star);
      break;
    case Stage::grid_collisions:
      if (solves()) implicit_.release(nodes_.size());
#pragma omp parallel for num_threads(threads_)
      for (int i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        collide_nodes(k, memory_[static_cast<std::size_t>(omp_get_thread_num())], nodes_.fields(k));
      }
      require_finite(stage, &NodeFields<T>::v_star);
      break;
    case Stage::integration:
      if (solves()) solve_kept_fields();
      integration();
      break;
    case Stage::deformation:
    case Stage::particle_velocities: {
      if (gathered_stale_) integration();
      const int pass = stage == Stage::deformation ? pass_deformation : pass_velocity;
      if (const Found found = update_all(pass, false); found.block >= 0) fail(found);
      if (stage == Stage::deformation) stress_stale_ = false;
      break;
    }
    case Stage::particle_collisions: update_all(0, true); break;
    case Stage::positions:
      if (const Found found = update_all(pass_position, false); found.block >= 0) fail(found);
      move_between_blocks();
      gathered_stale_ = tiles_stale_ = true;
      break;
  }
}

template <class T>
void OptimizedSolver<T>::rasterize() {
  solved_ = {};
  refresh_stress();
  scatter_all();
  tiles_stale_ = false;
  const int n = static_cast<int>(nodes_.size());
#pragma omp parallel for num_threads(threads_)
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    NodeFields<T>& node = nodes_.fields(k);
    sum_tiles(k, memory_[static_cast<std::size_t>(omp_get_thread_num())], node);
    kernels_.node_velocities(node);
  }
  gathered_stale_ = true;
  require_finite_particles(Stage::rasterize, slot_v, 3, "velocity is not finite");
  require_finite_particles(Stage::rasterize, slot_m, 1, "mass is not finite");
  require_finite(Stage::rasterize, &NodeFields<T>::v);
}

/// Step 2. ρ_p0 = Σ_i m_i w_ip / h³ of every particle of a block.
template <class T>
void OptimizedSolver<T>::density_sums(std::size_t active, std::vector<double>& rho) const {
  const Lattice& lattice = nodes_.lattice();
  const double h3 = std::pow(lattice.spacing(), 3);
  const Block<T>& block = particles_.block(particles_.active()[active]);
  double m[tile_nodes][tile_nodes][tile_nodes];
  std::int32_t c[3];
  int k[3];
  for (int x = 0; x < tile_nodes; ++x)
    for (int y = 0; y < tile_nodes; ++y)
      for (int z = 0; z < tile_nodes; ++z) {
        lattice.find_node(0, block_cells * block.b.i - 1 + x, c[0], k[0]);
        lattice.find_node(1, block_cells * block.b.j - 1 + y, c[1], k[1]);
        lattice.find_node(2, block_cells * block.b.k - 1 + z, c[2], k[2]);
        const int node = nodes_.find({c[0], c[1], c[2]});
        m[x][y][z] = static_cast<double>(
            nodes_.fields(static_cast<std::size_t>(node)).m[(4 * k[0] + k[1]) * 4 + k[2]]);
      }
  rho.assign(static_cast<std::size_t>(block.count), 0);
  for (int i = 0; i < block.count; ++i) {
    int first[3];
    std::array<double, 4> w[3];
    const std::int32_t b[3] = {block.b.i, block.b.j, block.b.k};
    for (int axis = 0; axis < 3; ++axis) {
      const double x =
          particles_.grid_position(block, i, axis) - block_cells * static_cast<double>(b[axis]);
      first[axis] = std::min(static_cast<int>(x), block_cells - 1);
      w[axis] = weights(x - first[axis]);
    }
    double& sum = rho[static_cast<std::size_t>(i)];
    for (int x = 0; x < 4; ++x)
      for (int y = 0; y < 4; ++y)
        for (int z = 0; z < 4; ++z)
          sum += m[first[0] + x][first[1] + y][first[2] + z] * w[0][static_cast<std::size_t>(x)] *
                 w[1][static_cast<std::size_t>(y)] * w[2][static_cast<std::size_t>(z)] / h3;
  }
}

/// V_p0 = m_p/ρ_p0 where V_p0 is not known; nothing to do once all are.
template <class T>
void OptimizedSolver<T>::volumes() {
  if (!volumes_unknown_ && skips_.volumes) return;
  const int n = static_cast<int>(particles_.active().size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_))
  for (int a = 0; a < n; ++a) {
    std::vector<double> rho;
    density_sums(static_cast<std::size_t>(a), rho);
    const Block<T>& block = particles_.block(particles_.active()[static_cast<std::size_t>(a)]);
    for (int i = 0; i < block.count; ++i) {
      T& V_0 = particles_.value(block, i, slot_V_0);
      if (V_0 == 0)
        V_0 = static_cast<T>(static_cast<double>(particles_.value(block, i, slot_m)) /
                             rho[static_cast<std::size_t>(i)]);
    }
  }
  if (!volumes_unknown_) return;
  volumes_unknown_ = false;
  volumes_found_ = stress_stale_ = tiles_stale_ = true;
  require_finite_particles(Stage::volumes, slot_V_0, 1, "volume is not finite");
}

template <class T>
void OptimizedSolver<T>::grid_forces() {
  refresh_stress();
  require_finite_particles(Stage::grid_forces, slot_stiffness, 1,
                           "hardening exp(xi (1 - J_P)) is not finite");
  require_finite_particles(Stage::grid_forces, slot_tau, 6, "stress is not finite");
  if (tiles_stale_) scatter_all();
  tiles_stale_ = false;
  const int n = static_cast<int>(nodes_.size());
#pragma omp parallel for num_threads(threads_)
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    ThreadMemory<T>& memory = memory_[static_cast<std::size_t>(omp_get_thread_num())];
    NodeFields<T>& node = *memory.node.data();
    sum_tiles(k, memory, node);
    kernels_.node_forces(constants_, node);
    std::copy(&node.f[0][0], &node.f[0][0] + 3 * nodes_per_block, &nodes_.fields(k).f[0][0]);
  }
  require_finite(Stage::grid_forces, &NodeFields<T>::f);
}

/// Step 6, explicit: v^{n+1} = v*; and what the gather reads.
template <class T>
void OptimizedSolver<T>::integration() {
  pack_all([&](std::size_t k) -> const NodeMotion<T>& { return nodes_.fields(k); });
  gathered_stale_ = false;
  require_finite(Stage::integration, &NodeFields<T>::v_star);
}

/// Place of a node among those of positive mass in (i,j,k) order.
template <class T>
std::int64_t OptimizedSolver<T>::place_in_order(std::size_t n, int place) const {
  const NodeIndex mine = nodes_.index(nodes_.block(n), place);
  std::int64_t before = 0;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    for (int i = 0; i < nodes_per_block; ++i)
      if (nodes_.fields(k).m[i] > 0 && nodes_.index(nodes_.block(k), i) < mine) ++before;
  return before;
}

template <class T>
void OptimizedSolver<T>::require_finite(Stage stage,
                                        const T (NodeFields<T>::*field)[3][nodes_per_block]) {
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    for (int i = 0; i < nodes_per_block; ++i)
      for (int a = 0; a < 3; ++a)
        if (!std::isfinite((nodes_.fields(k).*field)[a][i]) ||
            !std::isfinite(nodes_.fields(k).m[i])) {
          const NodeIndex at = nodes_.index(nodes_.block(k), i);
          throw SimulationError(stage, SimulationError::Subject::node, place_in_order(k, i),
                                std::string(stage == Stage::grid_forces ? "force" : "velocity") +
                                    " is not finite at node (" + std::to_string(at.i) + ", " +
                                    std::to_string(at.j) + ", " + std::to_string(at.k) + ")");
        }
}

/// The particle with the smallest index whose values are not all finite.
template <class T>
void OptimizedSolver<T>::require_finite_particles(Stage stage, int slot, int count,
                                                  const char* what) {
  constexpr auto nobody = static_cast<std::int64_t>(-1);
  std::int64_t first = nobody;
  for (const int number : particles_.active()) {
    const Block<T>& block = particles_.block(number);
    for (int i = 0; i < block.count; ++i)
      for (int s = slot; s < slot + count; ++s)
        if (!std::isfinite(particles_.value(block, i, s))) {
          const auto p = static_cast<std::int64_t>(particles_.index(block, i));
          first = first == nobody ? p : std::min(first, p);
        }
  }
  if (first != nobody)
    throw SimulationError(stage, SimulationError::Subject::particle, first, what);
}

template <class T>
std::int64_t OptimizedSolver<T>::grid_nodes() const {
  std::int64_t count = 0;
  for (std::size_t k = 0; k < nodes_.size(); ++k) count += count_nodes(nodes_.fields(k));
  return count;
}

template <class T>
void OptimizedSolver<T>::load_grid(const Grid& grid) {
  nodes_.require_fields();
  for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_.fields(k) = NodeFields<T>{};
  const bool integrated = number(next_) > number(Stage::integration);
  if (solves()) implicit_.release(nodes_.size()), implicit_.remember_v_star(nodes_);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const std::int32_t at[3] = {grid.node[i].i, grid.node[i].j, grid.node[i].k};
    std::int32_t c[3];
    int k[3];
    for (int axis = 0; axis < 3; ++axis)
      nodes_.lattice().find_node(axis, at[axis], c[axis], k[axis]);
    const int n = nodes_.find({c[0], c[1], c[2]});
    if (n < 0) continue;  // out of every particle's reach: without mass, without influence
    NodeFields<T>& node = nodes_.fields(static_cast<std::size_t>(n));
    const int place = (4 * k[0] + k[1]) * 4 + k[2];
    const std::vector<Vec3>& v_star = integrated ? grid.v_new : grid.v_star;
    if (!grid.m.empty()) node.m[place] = static_cast<T>(grid.m[i]);
    for (int a = 0; a < 3; ++a) {
      if (!grid.v.empty()) node.v[a][place] = static_cast<T>(grid.v[i][a]);
      if (!grid.f.empty()) node.f[a][place] = static_cast<T>(grid.f[i][a]);
      if (!v_star.empty()) node.v_star[a][place] = static_cast<T>(v_star[i][a]);
      if (solves() && integrated && !grid.v_star.empty())
        implicit_.v_star(static_cast<std::size_t>(n))[a * nodes_per_block + place] =
            static_cast<T>(grid.v_star[i][a]);
    }
    if (solves() && !grid.free_directions.empty() && !grid.free_directions[i].isIdentity(0))
      implicit_.set_free_directions(static_cast<std::size_t>(n), place, grid.free_directions[i]);
  }
}

template <class T>
void OptimizedSolver<T>::store_grid(Grid& grid) const {
  struct Place {
    NodeIndex index;
    std::size_t block;
    int node;
  };
  std::vector<Place> order;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    for (int i = 0; i < nodes_per_block; ++i)
      if (nodes_.fields(k).m[i] > 0) order.push_back({nodes_.index(nodes_.block(k), i), k, i});
  std::sort(order.begin(), order.end(),
            [](const Place& a, const Place& b) { return a.index < b.index; });
  const bool forces = number(next_) > number(Stage::grid_forces);
  const bool star = number(next_) > number(Stage::grid_velocities);
  const bool integrated = number(next_) > number(Stage::integration);
  for (const Place& p : order) {
    const NodeFields<T>& node = nodes_.fields(p.block);
    const auto vector = [&](const T(&field)[3][nodes_per_block]) {
      return Vec3(static_cast<double>(field[0][p.node]), static_cast<double>(field[1][p.node]),
                  static_cast<double>(field[2][p.node]));
    };
    grid.node.push_back(p.index);
    grid.m.push_back(static_cast<double>(node.m[p.node]));
    grid.v.push_back(vector(node.v));
    if (forces) grid.f.push_back(vector(node.f));
    if (star && solves() && integrated) {
      const T* const v = implicit_.v_star(p.block) + p.node;
      grid.v_star.emplace_back(static_cast<double>(v[0]), static_cast<double>(v[nodes_per_block]),
                               static_cast<double>(v[2 * nodes_per_block]));
    } else if (star) {
      grid.v_star.push_back(vector(node.v_star));
    }
    if (solves() && number(next_) > number(Stage::grid_collisions))
      grid.free_directions.push_back(implicit_.free_directions(p.block, p.node));
    if (integrated) grid.v_new.push_back(vector(node.v_star));
  }
}

template class OptimizedSolver<float>;
template class OptimizedSolver<double>;

}  // namespace firn::optimized
