// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/implicit/free_directions.hpp"

#include <algorithm>

namespace firn::optimized {

namespace {

template <class S>
void put(Projector<S>& projector, int node, const Mat3& A) {
  const double entries[6] = {A(0, 0), A(0, 1), A(0, 2), A(1, 1), A(1, 2), A(2, 2)};
  for (int e = 0; e < 6; ++e) {
    const int i = e * nodes_per_block + node;
    projector.exact[i] = entries[e];
    if constexpr (sizeof(S) < sizeof(double)) projector.in_S[i] = static_cast<S>(entries[e]);
  }
}

}  // namespace

template <class S>
void FreeDirections<S>::release(std::size_t node_blocks) {
  held_.require(node_blocks, node_blocks / 8);
  std::fill_n(held_.data(), node_blocks, nullptr);
  in_use_ = 0;
}

template <class S>
Projector<S>* FreeDirections<S>::take() {
  Projector<S>* projector = nullptr;
#pragma omp critical(firn_projectors)
  {
    if (in_use_ == projectors_.size()) projectors_.push_back(allocate_aligned<Projector<S>>(1));
    projector = projectors_[in_use_++].get();
  }
  return projector;
}

template <class S>
void FreeDirections<S>::set(std::size_t n, int k, const Mat3& P) {
  if (held_[n] == nullptr) {
    held_[n] = take();
    for (int i = 0; i < nodes_per_block; ++i) put(*held_[n], i, Mat3::Identity());
  }
  put(*held_[n], k, P);
}

template <class S>
Mat3 FreeDirections<S>::at(std::size_t n, int k) const {
  const double* const projector = exact(n);
  if (projector == nullptr) return Mat3::Identity();
  const auto entry = [&](int e) { return projector[e * nodes_per_block + k]; };
  Mat3 P;
  P << entry(0), entry(1), entry(2),  //
      entry(1), entry(3), entry(4),   //
      entry(2), entry(4), entry(5);
  return P;
}

template class FreeDirections<float>;
template class FreeDirections<double>;

}  // namespace firn::optimized
