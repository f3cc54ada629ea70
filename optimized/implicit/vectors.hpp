// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The vectors of a solve and the fields of its operator, typed views of memory that the explicit
/// step lends while it solves: its tiles, and what stages 7 and 8 gather.

#include "optimized/implicit/kernel_table.hpp"
#include "optimized/store/node_store.hpp"

namespace firn::optimized {

/// A vector field, planar node block by node block.
template <class T>
struct FieldVector {
  T* first = nullptr;
  /// Of node block n: field_size numbers, [axis][node].
  T* operator[](std::size_t n) const { return first + n * field_size; }
};

/// Equal pieces, one for each (node) block.
template <class T>
struct Pieces {
  T* first = nullptr;
  std::size_t size = 0;
  T* operator[](std::size_t n) const { return first + n * size; }
};

/// What the operator in type T reads, a field as blocks gather it, and what it writes.
template <class T>
struct OperatorFields {
  Pieces<T> gathered;  ///< by node block
  Pieces<T> tiles;     ///< by active block
};

template <class S>
struct SolveVectors {
  FieldVector<double> v;             ///< the solution so far
  FieldVector<S> z;                  ///< residual, Lanczos vector
  FieldVector<S> z_last, w, w_last;  ///< of MINRES
  FieldVector<S> d;                  ///< its solution
  // One of both at a time: they lie in the same memory.
  OperatorFields<float> in_float;
  OperatorFields<double> in_double;

  template <class T>
  const OperatorFields<T>& in() const {
    if constexpr (std::is_same_v<T, float>)
      return in_float;
    else
      return in_double;
  }
};

/// [v | z | the operator's tiles | z_last, w_last, w, d] in the tiles' memory. An application in
/// double, to find a residual, may take the place of the last four for its tiles: they live between
/// two residuals only.
template <class S>
SolveVectors<S> borrow_vectors(NodeStore<S>& nodes, std::size_t active_blocks,
                               const ImplicitKernels<S>& kernels);

}  // namespace firn::optimized
