/// The whole step in three passes: particles to tiles, tiles to nodes, nodes to
/// particles. Node fields live in a thread's own memory for one node block at a time; a
/// semi-implicit step keeps m, vⁿ and v* of all of them for its solve.

#include <algorithm>
#include <cmath>
#include <omp.h>

#include "firn/error.hpp"
#include "optimized/drivers/solver.hpp"

namespace firn::optimized {

namespace {

/// Every block is sorted again each 16th step; which one when depends on where it
/// lies, so that no step sorts all of them.
constexpr std::int64_t sort_interval = 16;

bool sort_is_due(const NodeIndex& b, std::int64_t step) {
  return (step + b.i + 3 * b.j + 5 * b.k) % sort_interval == 0;
}

}  // namespace

template <class T>
void OptimizedSolver<T>::scatter_all() {
  const std::vector<int>& active = particles_.active();
  const int n = static_cast<int>(active.size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_))
  for (int a = 0; a < n; ++a) {
    ThreadMemory<T>& memory = memory_[static_cast<std::size_t>(omp_get_thread_num())];
    Block<T>& block = particles_.block(active[static_cast<std::size_t>(a)]);
    if (sort_is_due(block.b, step_)) particles_.sort(block, memory.sorting);
    // Most often this thread's next block; its particles are asked for in advance.
    BlockView<T> next{};
    if (a + 1 < n)
      next = particles_.view(particles_.block(active[static_cast<std::size_t>(a) + 1]));
    kernels_.scatter(particles_.view(block), a + 1 < n ? &next : nullptr, constants_, memory.work,
                     nodes_.tile(static_cast<std::size_t>(a)));
  }
}

template <class T>
void OptimizedSolver<T>::sum_tiles(std::size_t n, ThreadMemory<T>& memory,
                                   NodeFields<T>& node) const {
  const NodeBlock& block = nodes_.block(n);
  const Share* share = nodes_.shares(block);
  for (int k = 0; k < block.share_count; ++k)
    kernels_.add_tile(nodes_.tile(static_cast<std::size_t>(share[k].tile_number)), share[k].region,
                      memory.sums.data());
  kernels_.planar(memory.sums.data(), node);
}

template <class T>
std::int64_t OptimizedSolver<T>::count_nodes(const NodeFields<T>& node) {
  std::int64_t count = 0;
  for (const T m : node.m) count += m > 0 ? 1 : 0;
  return count;
}

template <class T>
void OptimizedSolver<T>::collide_nodes(std::size_t n, ThreadMemory<T>& memory,
                                       NodeFields<T>& node) {
  if (scene_->colliders.empty()) return;
  const NodeBlock& block = nodes_.block(n);
  const double h = scene_->grid.spacing;
  const Vec3 c(block.c.i, block.c.j, block.c.k);
  // Node −1 of a periodic axis is node n−1, far from the others.
  const Lattice& lattice = nodes_.lattice();
  const bool split = (lattice.period(0) > 0 && block.c.i == 0) ||
                     (lattice.period(1) > 0 && block.c.j == 0) ||
                     (lattice.period(2) > 0 && block.c.k == 0);
  if (skips_.contact && !split)
    contacts_.near(scene_->grid.origin + h * (block_cells * c + Vec3::Constant(0.5)),
                   1.5 * std::sqrt(3.0) * h, memory.colliders);
  else
    contacts_.all(memory.colliders);
  if (memory.colliders.empty()) return;
  for (int k = 0; k < nodes_per_block; ++k) {
    if (!(node.m[k] > 0)) continue;
    const NodeIndex i = nodes_.index(block, k);
    const Vec3 x = scene_->grid.origin + h * Vec3(i.i, i.j, i.k);
    Vec3 v(static_cast<double>(node.v_star[0][k]), static_cast<double>(node.v_star[1][k]),
           static_cast<double>(node.v_star[2][k]));
    if (solves()) {
      Mat3 free = Mat3::Identity();
      contacts_.collide(memory.colliders, x, v, free);
      if (free != Mat3::Identity()) implicit_.set_free_directions(n, k, free);
    } else {
      contacts_.collide(memory.colliders, x, v);
    }
    for (int a = 0; a < 3; ++a) node.v_star[a][k] = static_cast<T>(v[a]);
  }
}

template <class T>
void OptimizedSolver<T>::load_surroundings(std::size_t active, const Workspace<T>& work) const {
  nodes_.load_surroundings(
      active, kernels_, [&](std::size_t n) { return nodes_.gathered(n); }, work.local);
  kernels_.difference(work);
}

/// The colliders that particles of a block may touch, into memory.colliders.
template <class T>
void OptimizedSolver<T>::find_colliders(const Block<T>& block, ThreadMemory<T>& memory) const {
  const double h = scene_->grid.spacing;
  const Vec3 b(block.b.i, block.b.j, block.b.k);
  if (skips_.contact)
    contacts_.near(scene_->grid.origin + h * (block_cells * b + Vec3::Constant(2)),
                   2 * std::sqrt(3.0) * h, memory.colliders);
  else
    contacts_.all(memory.colliders);
}

/// Stage 9 for one block, with the colliders that were found.
template <class T>
void OptimizedSolver<T>::collide_particles(const Block<T>& block,
                                           const std::vector<int>& colliders) const {
  for (int i = 0; i < block.count; ++i) {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = static_cast<double>(particles_.value(block, i, slot_v + a));
    const Vec3 before = v;
    contacts_.collide(colliders, particles_.position(block, i), v);
    if (v == before) continue;
    for (int a = 0; a < 3; ++a) particles_.value(block, i, slot_v + a) = static_cast<T>(v[a]);
  }
}

/// Some of stages 7 to 10 for one block; returns the number of leavers.
template <class T>
int OptimizedSolver<T>::update_block(std::size_t active, int passes, bool collide,
                                     ThreadMemory<T>& memory, FaultReport& report) {
  const Block<T>& block = particles_.block(particles_.active()[active]);
  const BlockView<T> view = particles_.view(block);
  if (passes & (pass_deformation | pass_velocity)) load_surroundings(active, memory.work);
  memory.colliders.clear();
  if (collide && !scene_->colliders.empty()) find_colliders(block, memory);
  if (memory.colliders.empty())
    return kernels_.update(view, constants_, memory.work, passes, report);
  // Particles collide between stages 8 and 10.
  const int before = passes & (pass_deformation | pass_velocity);
  if (before) kernels_.update(view, constants_, memory.work, before, report);
  collide_particles(block, memory.colliders);
  return passes & pass_position
             ? kernels_.update(view, constants_, memory.work, pass_position, report)
             : 0;
}

template <class T>
auto OptimizedSolver<T>::update_all(int passes, bool collide) -> Found {
  const std::vector<int>& active = particles_.active();
  const int n = static_cast<int>(active.size());
  Found found;
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_))
  for (int a = 0; a < n; ++a) {
    ThreadMemory<T>& memory = memory_[static_cast<std::size_t>(omp_get_thread_num())];
    FaultReport report;
    const int leavers = update_block(static_cast<std::size_t>(a), passes, collide, memory, report);
    if ((passes & pass_position) && report.fault == Fault::none) {
      const int lost = particles_.take_out(particles_.block(active[static_cast<std::size_t>(a)]),
                                           memory.work.leavers, leavers);
      if (lost >= 0) report = {Fault::position, lost};
    }
    if (report.fault == Fault::none) continue;
#pragma omp critical
    if (found.block < 0 || a < found.block) found = {a, report};
  }
  return found;
}

template <class T>
void OptimizedSolver<T>::move_between_blocks() {
  if (particles_.put_in(threads_)) nodes_stale_ = true;
}

/// Names the particle. Its block has not given any away.
template <class T>
void OptimizedSolver<T>::fail(const Found& found) {
  const Block<T>& block =
      particles_.block(particles_.active()[static_cast<std::size_t>(found.block)]);
  const Fault fault = found.report.fault;
  const Stage stage = fault == Fault::deformation ? Stage::deformation
                      : fault == Fault::velocity  ? Stage::particle_velocities
                                                  : Stage::positions;
  const auto p = static_cast<std::int64_t>(particles_.index(block, found.report.place));
  throw SimulationError(stage, SimulationError::Subject::particle, p,
                        fault == Fault::deformation ? "deformation gradient is not finite"
                        : fault == Fault::velocity
                            ? "velocity is not finite"
                            : "particle moves more than 4 cells in a step or leaves the domain");
}

template <class T>
StepReport OptimizedSolver<T>::fused_step() {
  refresh_stress();
  scatter_all();
  const bool keep_fields = !skips_.fields || !skips_.volumes;
  if (keep_fields) nodes_.require_fields();

  const int n = static_cast<int>(nodes_.size());
  if (solves()) implicit_.release(nodes_.size());
  std::int64_t count = 0;
  bool finite = true;
#pragma omp parallel for num_threads(threads_) schedule(dynamic, blocks_per_turn(n, threads_)) \
    reduction(+ : count) reduction(&& : finite)
  for (int i = 0; i < n; ++i) {
    ThreadMemory<T>& memory = memory_[static_cast<std::size_t>(omp_get_thread_num())];
    const auto k = static_cast<std::size_t>(i);
    NodeFields<T>& node = keep_fields ? nodes_.fields(k) : *memory.node.data();
    sum_tiles(k, memory, node);
    kernels_.node_velocities(node);
    kernels_.node_forces(constants_, node);
    kernels_.node_velocities_star(constants_, node);
    collide_nodes(k, memory, node);
    finite = kernels_.pack_gathered(constants_, node, nodes_.gathered(k)) && finite;
    if (solves()) implicit_.motion(k) = node;
    count += count_nodes(node);
  }
  if (finite && solves()) {
    solve_implicit();
    finite = pack_all([&](std::size_t k) -> const NodeMotion<T>& { return implicit_.motion(k); });
  }
  // No particle has changed yet: the staged path finds out what went wrong and where.
  if (!finite) {
    advance_through(Stage::integration, dt_);
    throw SimulationError(Stage::integration, SimulationError::Subject::solver, -1,
                          "velocity is not finite");
  }
  if (!skips_.volumes) volumes();

  const Found found = update_all(pass_deformation | pass_velocity | pass_position, true);
  if (found.block >= 0) fail(found);
  move_between_blocks();
  tiles_stale_ = gathered_stale_ = true;
  StepReport report;
  report.dt = dt_;
  report.grid_nodes = count;
  report_solve(report);
  return report;
}

template class OptimizedSolver<float>;
template class OptimizedSolver<double>;

}  // namespace firn::optimized
