#pragma once
/// The optimized solver itself: one simulation in blocks.

#include <memory>
#include <vector>

#include "firn/registry.hpp"
#include "optimized/drivers/skips.hpp"
#include "optimized/implicit/system.hpp"
#include "optimized/passes/contact.hpp"
#include "optimized/passes/kernel_table.hpp"
#include "optimized/store/node_store.hpp"
#include "optimized/store/particle_store.hpp"
#include "optimized/store/thread_memory.hpp"

namespace firn::optimized {

template <class T>
class OptimizedSolver final : public Solver {
 public:
  explicit OptimizedSolver(const SolverOptions& options);

  const SolverTraits& traits() const override;
  void load(const Scene& scene, const State& state) override;
  TimeStep choose_time_step() override;
  StepReport advance_through(Stage last, double dt) override;
  StepReport step(double dt) override;
  void store(State& state) const override;
  Diagnostics diagnostics(const Scene& scene) const override;
  std::size_t restart_size() const override;
  void store_restart(std::span<std::byte> bytes) const override;
  void load_restart(std::span<const std::byte> bytes) override;
  double bytes_per_particle() const override;

 private:
  /// A fault in a kernel, with the number of the active or node block.
  struct Found {
    std::int64_t block = -1;
    FaultReport report;
  };

  void prepare(double dt);
  void refresh_nodes();
  void refresh_stress();
  void finish_step();

  // fused.cpp: the whole step, each field kept no longer than needed.
  StepReport fused_step();
  void scatter_all();
  void sum_tiles(std::size_t n, ThreadMemory<T>& memory, NodeFields<T>& node) const;
  void collide_nodes(std::size_t n, ThreadMemory<T>& memory, NodeFields<T>& node);
  static std::int64_t count_nodes(const NodeFields<T>& node);
  Found update_all(int passes, bool collide);
  int update_block(std::size_t active, int passes, bool collide, ThreadMemory<T>& memory,
                   FaultReport& report);
  void load_surroundings(std::size_t active, const Workspace<T>& work) const;
  void find_colliders(const Block<T>& block, ThreadMemory<T>& memory) const;
  void collide_particles(const Block<T>& block, const std::vector<int>& colliders) const;
  void move_between_blocks();
  [[noreturn]] void fail(const Found& found);

  // integration.cpp: step 6 of semi-implicit scenes.
  bool solves() const { return scene_->semi_implicit(); }
  void solve_implicit();
  void solve_kept_fields();
  /// What stages 7 and 8 gather, from motion_of(node block). Whether v_i^{n+1} is finite.
  template <class F>
  bool pack_all(const F& motion_of);
  void report_solve(StepReport& report) const;

  // staged.cpp: stage by stage, every field kept.
  void run(Stage stage);
  void rasterize();
  void volumes();
  void density_sums(std::size_t active, std::vector<double>& rho) const;
  void grid_forces();
  void integration();
  void require_finite(Stage stage, const T (NodeFields<T>::*field)[3][nodes_per_block]);
  void require_finite_particles(Stage stage, int slot, int count, const char* what);
  std::int64_t place_in_order(std::size_t n, int place) const;
  std::int64_t grid_nodes() const;
  void load_grid(const Grid& grid);
  void store_grid(Grid& grid) const;

  const Scene* scene_ = nullptr;
  SkipSet skips_;
  int threads_;
  const KernelTable<T>& kernels_;
  std::vector<MaterialConstants<T>> materials_;
  StepConstants<T> constants_{};
  ParticleStore<T> particles_;
  NodeStore<T> nodes_;
  Contacts contacts_;
  ImplicitSystem<T> implicit_;
  SolveReport solved_;  ///< of the step under way
  std::vector<ThreadMemory<T>> memory_;

  double time_ = 0, dt_ = 0;
  std::int64_t step_ = 0;
  Stage next_ = Stage::rasterize;
  bool nodes_stale_ = true;       ///< the set of blocks has changed
  bool stress_stale_ = true;      ///< F_E or V_p0 came from outside
  bool tiles_stale_ = true;       ///< the tiles are not those of the present particles
  bool gathered_stale_ = true;    ///< (v_new, u) are not those of the node fields
  bool volumes_unknown_ = false;  ///< some V_p0 is 0
  bool volumes_found_ = false;    ///< this step has estimated some
};

template <class T>
template <class F>
bool OptimizedSolver<T>::pack_all(const F& motion_of) {
  const int n = static_cast<int>(nodes_.size());
  bool finite = true;
#pragma omp parallel for num_threads(threads_) reduction(&& : finite)
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const NodeMotion<T>& motion = motion_of(k);
    finite = kernels_.pack_gathered(constants_, motion, nodes_.gathered(k)) && finite;
  }
  return finite;
}

extern template class OptimizedSolver<float>;
extern template class OptimizedSolver<double>;

}  // namespace firn::optimized
