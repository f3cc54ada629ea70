#pragma once
/// The linear system of the semi-implicit update on blocks and tiles,
///   B v = v*,   B v = v + βΔt² M⁻¹H v   (Stomakhin et al. 2013, section 6),
/// without a matrix: what a particle needs is found once per step (14 numbers beside what
/// it has), and applying H is one gather and one scatter.
///
/// Memory: the factors, and m, vⁿ and v* of every node. The vectors of the solve lie in the
/// memory of the explicit step's tiles, of which the operator takes the smaller half.

#include <array>
#include <cstdint>
#include <vector>

#include "optimized/implicit/kernel_table.hpp"
#include "optimized/store/memory.hpp"
#include "optimized/store/node_store.hpp"
#include "optimized/store/particle_store.hpp"
#include "optimized/store/thread_memory.hpp"

namespace firn::optimized {

/// What a solve took.
struct SolveReport {
  enum class Status { converged, not_finite, stagnates, out_of_iterations };
  Status status = Status::converged;
  std::int64_t iterations = 0;
  double residual = 0;      ///< true relative residual at the end
  bool indefinite = false;  ///< negative curvature was met
};

template <class S>
class ImplicitSystem {
  /// Where a thread adds up the tiles around a node block: a vector field, interleaved in up
  /// to 4 channels and planar.
  struct alignas(cache_line) Sums {
    double interleaved[4 * nodes_per_block], planar[field_size];
  };

 public:
  explicit ImplicitSystem(int threads) : threads_(threads) {}

  // What the stages before leave.

  /// m, vⁿ and v* of a node block; v^{n+1} after the solve.
  NodeMotion<S>& motion(std::size_t n) const { return motion_[n]; }
  /// Room for the nodes; all their directions are free.
  void release(std::size_t node_blocks);
  /// Node k of node block n. Different node blocks may be set at the same time.
  void set_free_directions(std::size_t n, int k, const Mat3& P);
  Mat3 free_directions(std::size_t n, int k) const;

  // The solve.

  /// Linearizes about the particles' F_E, and puts each block's particles in cell order.
  /// `factor` is βΔt²/h². Tiles and gathered fields lose what they hold.
  void assemble(ParticleStore<S>& particles, NodeStore<S>& nodes, const StepConstants<S>& step,
                double factor, std::vector<ThreadMemory<S>>& memory);

  /// Solves B v = v* along the free directions, from v*. On success v_star of the node
  /// blocks is the solution; otherwise they keep v*.
  SolveReport solve(double tolerance, std::int64_t max_iterations);

  // Between two stages only.

  /// v_i* of node block n as it was remembered, [axis][node].
  S* v_star(std::size_t n) const { return v_star_.data() + n * field_size; }
  void remember_v_star(const NodeStore<S>& nodes);

  std::size_t bytes() const;

 private:
  std::size_t node_blocks() const { return nodes_->size(); }
  /// Of a node block with a node that is not free; else null. One rounded to float no longer
  /// keeps the held directions out of the residual, where no search direction could reduce
  /// them: hence two.
  const double* exact_projector(std::size_t n) const { return held_[n]; }
  const S* projector(std::size_t n) const {
    const bool in_double = sizeof(S) == sizeof(double);
    return held_[n] == nullptr
               ? nullptr
               : reinterpret_cast<const S*>(held_[n] + (in_double ? 0 : matrix_size));
  }
  double* take_projector();
  static S* block(S* field, std::size_t n) { return field + n * field_size; }

  void lay_out_vectors();
  void factor_particles(const StepConstants<S>& step);
  void make_room_for_records();
  HessianBlock<S> particles_of(std::size_t active) const;

  // The operator in type T, on what was packed.
  template <class T>
  const HessianKernels<T, S>& hessian() const {
    if constexpr (sizeof(T) == sizeof(float))
      return hessian_in_float_;
    else
      return hessian_in_double_;
  }
  template <class T>
  T* gathered(std::size_t n) const {
    return reinterpret_cast<T*>(nodes_->gathered(n));
  }
  /// Of this thread.
  template <class T>
  HessianScratch<T> scratch() const;
  template <class T>
  T* tile(std::size_t active) const {
    return reinterpret_cast<T*>(tiles_) + active * static_cast<std::size_t>(hessian<T>().tile_size);
  }
  /// H times what was packed, onto the tiles.
  template <class T>
  void apply();
  /// The tiles' sum at node block n: h² times H of what was packed, planar.
  template <class T>
  const FieldType<T, S>* applied(std::size_t n, Sums& sums) const;
  /// The node of a block's tile that its heaviest particle is nearest to, for positions in double.
  std::array<int, 3> anchor(const Block<S>& block) const;

  /// Σ over node blocks of f(n, sums of this thread), added in their order.
  template <class F>
  double sum_over_nodes(const F& f);

  double residual(double unit);
  // MINRES for B d = r with the operator in T: z_ times `scale` is the residual divided by its
  // norm.
  template <class T>
  void minres(double scale, double target, std::int64_t max_iterations, SolveReport& report);

  // Of the instruction set that was chosen when the solver was made: the layout of tiles and
  // gathered fields depends on it.
  const HessianKernels<float, S>& hessian_in_float_ = hessian_kernels<float, S>();
  const HessianKernels<double, S>& hessian_in_double_ = hessian_kernels<double, S>();
  const FieldKernels<S>& fields_ = field_kernels<S>();
  const FieldKernels<double>& fields_in_double_ = field_kernels<double>();
  const SetupKernels<S>& setup_ = setup_kernels<S>();

  int threads_;
  ParticleStore<S>* particles_ = nullptr;
  NodeStore<S>* nodes_ = nullptr;
  std::vector<ThreadMemory<S>>* memory_ = nullptr;
  int slots_ = 0;
  int largest_slab_ = 0;  ///< places for the particles of an x-slab
  double factor_ = 0;

  AlignedArray<S> factors_;           ///< chunks, block after block
  std::vector<std::size_t> first_;    ///< where each active block's chunks begin
  AlignedArray<std::int32_t> begin_;  ///< 65 numbers for each active block
  /// Of each active block, for forces in a type narrower than the fields'; see applied().
  struct Defect {
    std::array<int, 3> anchor;
    double total[3];
  };
  std::vector<Defect> defects_;
  AlignedArray<NodeMotion<S>> motion_;

  /// Projectors of node blocks with a node that is not free: [6][64] in double, then, if S is
  /// float, in float; null for the others.
  AlignedArray<double*> held_;
  std::vector<AlignedPointer<double>> projectors_;
  std::size_t projectors_in_use_ = 0;

  // In the tiles' memory, see lay_out_vectors().
  double* v_ = nullptr;         ///< v
  S* z_ = nullptr;              ///< residual, Lanczos vector
  std::byte* tiles_ = nullptr;  ///< of the operator
  S *z_last_ = nullptr, *w_last_ = nullptr, *w_ = nullptr, *d_ = nullptr;  ///< MINRES

  std::vector<Sums> sums_;  ///< of each thread
  AlignedArray<double> partial_;
  AlignedArray<S> v_star_;
};

}  // namespace firn::optimized
