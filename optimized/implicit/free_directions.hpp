// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Projectors onto the directions that contact leaves free, kept for the node blocks in which they
/// are not all of them.

#include <vector>

#include "firn/types.hpp"
#include "optimized/implicit/layout.hpp"
#include "optimized/store/memory.hpp"

namespace firn::optimized {

/// Of one node block, planar: [xx xy xz yy yz zz][node]. One rounded to float no longer keeps the
/// held directions out of the residual, where no search direction could reduce them: hence two.
template <class S>
struct Projector {
  double exact[matrix_size];
  S in_S[matrix_size];
  const S* rounded() const { return in_S; }
};
template <>
struct Projector<double> {
  double exact[matrix_size];
  const double* rounded() const { return exact; }
};

template <class S>
class FreeDirections {
 public:
  /// Every direction of so many node blocks is free.
  void release(std::size_t node_blocks);

  /// P at node k of node block n. Different node blocks may be set at the same time.
  void set(std::size_t n, int k, const Mat3& P);
  Mat3 at(std::size_t n, int k) const;

  /// Those of node block n, null if all of its nodes are free.
  const double* exact(std::size_t n) const {
    return held_[n] == nullptr ? nullptr : held_[n]->exact;
  }
  const S* rounded(std::size_t n) const {
    return held_[n] == nullptr ? nullptr : held_[n]->rounded();
  }

  std::size_t bytes() const { return held_.bytes() + projectors_.size() * sizeof(Projector<S>); }

 private:
  Projector<S>* take();

  AlignedArray<Projector<S>*> held_;  ///< by node block; null: all free
  std::vector<AlignedPointer<Projector<S>>> projectors_;
  std::size_t in_use_ = 0;
};

extern template class FreeDirections<float>;
extern template class FreeDirections<double>;

}  // namespace firn::optimized
