#pragma once
/// The linear system of the semi-implicit update on blocks and tiles,
///   B v = v*,   B v = v + βΔt² M⁻¹H v   (Stomakhin et al. 2013, section 6),
/// without a matrix: what a particle needs is found once per step (15 numbers and its
/// position, in cell order), and applying H is one gather and one scatter.

#include <cstdint>
#include <vector>

#include "optimized/implicit/kernel_table.hpp"
#include "optimized/memory.hpp"
#include "optimized/node_store.hpp"
#include "optimized/particle_store.hpp"

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
 public:
  explicit ImplicitSystem(int threads) : threads_(threads) {}

  // Contact: the directions that stage 5 leaves free.

  /// Everything is free.
  void release(std::size_t node_blocks);
  /// Node k of node block n. Different node blocks may be set at the same time.
  void set_free_directions(std::size_t n, int k, const Mat3& P);
  Mat3 free_directions(std::size_t n, int k) const;

  // The solve.

  /// Linearizes about the particles' F_E. `factor` is βΔt²/h².
  void assemble(const ParticleStore<S>& particles, NodeStore<S>& nodes,
                const StepConstants<S>& step, double factor);

  /// Solves B v = v* along the free directions, from v*. On success v_star of the node
  /// fields is the solution; otherwise nothing has changed.
  SolveReport solve(double tolerance, std::int64_t max_iterations);

  /// v_i* of node block n as it was remembered, [axis][node].
  S* v_star(std::size_t n) const { return v_star_.data() + n * field_size; }
  void remember_v_star(const NodeStore<S>& nodes);

  std::size_t bytes() const;

 private:
  /// Scratch memory of one thread.
  struct Thread {
    AlignedArray<double> numbers, field;
    AlignedArray<std::uint8_t> cells;
  };

  std::size_t node_blocks() const { return nodes_->size(); }
  bool held(std::size_t n) const { return held_[n] != 0; }
  /// Of a node block with a node that is not free; else null.
  const S* projector(std::size_t n) const {
    return held(n) ? projector_.data() + n * matrix_size : nullptr;
  }
  S* block(const AlignedArray<S>& field, std::size_t n) const {
    return field.data() + n * field_size;
  }

  void factor_particles(const StepConstants<S>& step);

  // The operator in type T, on what was packed.
  template <class T>
  T* gathered(std::size_t n) const {
    return reinterpret_cast<T*>(nodes_->gathered(n));
  }
  template <class T>
  HessianScratch<T> scratch(Thread& thread) const;
  /// H times what was packed, onto the tiles.
  template <class T>
  void apply();
  /// The tiles' sum at node block n: h² times H of what was packed, planar.
  template <class T>
  const T* applied(std::size_t n, Thread& thread) const;

  /// Σ over node blocks of f(n, thread), added in their order.
  template <class F>
  double sum_over_nodes(const F& f);

  // Refinement: v and its residual in double.
  double residual();
  // MINRES in S for B d = r: z_ is the residual divided by its norm.
  void minres(double target, std::int64_t max_iterations, SolveReport& report);

  int threads_;
  const ParticleStore<S>* particles_ = nullptr;
  NodeStore<S>* nodes_ = nullptr;
  double factor_ = 0;

  std::vector<Thread> thread_;
  AlignedArray<S> chunks_;            ///< particles in cell order, block after block
  std::vector<std::size_t> first_;    ///< where each active block's chunks begin
  AlignedArray<std::int32_t> begin_;  ///< 65 numbers for each active block

  AlignedArray<std::uint8_t> held_;  ///< node blocks with a node that is not free
  /// The projectors of these, [6][64] per node block. One rounded to float no longer keeps the
  /// held directions out of the residual, where no search direction could reduce them.
  AlignedArray<double> exact_projector_;
  AlignedArray<S> projector_;

  AlignedArray<double> v_, residual_;  ///< v and v* − B v
  AlignedArray<double> partial_;
  AlignedArray<S> z_last_, z_, w_last_, w_, d_;  ///< MINRES: Lanczos vectors, directions, solution
  AlignedArray<S> v_star_;
};

}  // namespace firn::optimized
