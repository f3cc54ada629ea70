// SPDX-License-Identifier: BSD-3-Clause
/// Work of the semi-implicit solve on the nodes of one node block: from tiles to planar
/// fields, and the vector operations of MINRES. Inner products are Σ m a·b, in as many partial
/// sums as the widest vector has lanes, which are added as doubles: the same order always.

#if defined(FIRN_OPTIMIZED_IMPLICIT_FIELDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_FIELDS_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_FIELDS_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_FIELDS_INL_H_
#endif

#include "optimized/implicit/layout.hpp"
#include "optimized/math/mat3-inl.h"
#include "optimized/passes/grid-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

namespace kn = firn::kernels::HWY_NAMESPACE;

/// Sums of C channels as a planar field.
template <class T, int C>
void planar_vector(const T* sums, T* field) {
  alignas(cache_line) T unused[nodes_per_block];
  for (int component = 0; component < 3; component += C, sums += C * nodes_per_block) {
    T* to[C];
    for (int c = 0; c < C; ++c)
      to[c] = component + c < 3 ? field + (component + c) * nodes_per_block : unused;
    separate<T, C>(sums, to);
  }
}

/// A planar field interleaved as blocks gather it: [x][y][row][z][channel]. Of two channels, the
/// second row holds the third component twice.
template <class T, class Field>
void pack_vector(const Field* field, T* gathered) {
  constexpr int C = channels<T>;
  // The nodes of a row; two vectors on 128-bit targets in double.
  constexpr int step = lane_count<Field> < stencil_nodes ? lane_count<Field> : stencil_nodes;
  const hn::CappedTag<T, step> d;
  const hn::CappedTag<Field, step> from;
  for (int i = 0; i < nodes_per_block; i += stencil_nodes)
    for (int r = 0; r < force_rows<T>; ++r, gathered += row_size<T>)
      for (int z = 0; z < stencil_nodes; z += step) {
        const auto channel = [&](int c) HWY_ATTR {
          c += r * C;
          const auto v = hn::LoadU(from, field + (c < 3 ? c : 2) * nodes_per_block + i + z);
          if constexpr (sizeof(T) < sizeof(Field)) {
            return hn::DemoteTo(d, v);
          } else {
            return v;
          }
        };
        T* const to = gathered + z * C;
        if constexpr (C == 1) {
          hn::StoreU(channel(0), d, to);
        } else if constexpr (C == 2) {
          hn::StoreInterleaved2(channel(0), channel(1), d, to);
        } else {
          hn::StoreInterleaved4(channel(0), channel(1), channel(2), hn::Zero(d), d, to);
        }
      }
}

/// A block's sum is kept in as many parts as the widest instruction set has lanes, so that all of
/// them add in the same order.
template <class T>
inline constexpr int sum_vectors = chunk_lanes<T> / lane_count<T>;

template <class T>
HWY_INLINE void set_zero(Vec<T>* sums) {
  for (int k = 0; k < sum_vectors<T>; ++k) sums[k] = hn::Zero(Lanes<T>());
}

template <class T>
HWY_INLINE double total(const Vec<T>* sums) {
  double total = 0;
  for (int k = 0; k < sum_vectors<T>; ++k) {
    alignas(cache_line) T lane[lane_count<T>];
    hn::Store(sums[k], Lanes<T>(), lane);
    for (int i = 0; i < lane_count<T>; ++i) total += static_cast<double>(lane[i]);
  }
  return total;
}

/// Calls f(first node, part of the sum) for every vector of a block's nodes.
template <class T, class F>
HWY_INLINE void for_each_vector(const F& f) {
  for (int i = 0; i < nodes_per_block; i += sum_vectors<T> * lane_count<T>)
    for (int k = 0; k < sum_vectors<T>; ++k) f(i + k * lane_count<T>, k);
}

/// Divided by m, not multiplied by a reciprocal that may overflow.
template <class T>
double multiply(const T* y, const T* f, const T* m, double factor, double s, double ratio, T* z) {
  const Lanes<T> d;
  const auto factor_ = hn::Set(d, static_cast<T>(factor)), s_ = hn::Set(d, static_cast<T>(s));
  const auto ratio_ = hn::Set(d, static_cast<T>(ratio));
  Vec<T> sums[sum_vectors<T>];
  set_zero<T>(sums);
  for (int a = 0; a < 3; ++a)
    for_each_vector<T>([&](int node, int part) HWY_ATTR {
      const int i = a * nodes_per_block + node;
      const auto mass = hn::Load(d, m + node);
      const auto y_i = hn::Load(d, y + i);
      const auto acceleration = hn::Div(hn::Mul(factor_, hn::Load(d, f + i)), mass);
      const auto By = where_mass<T>(mass, hn::Mul(s_, hn::Add(y_i, acceleration)));
      const auto z_i = hn::NegMulAdd(ratio_, hn::Load(d, z + i), By);
      hn::Store(z_i, d, z + i);
      sums[part] = hn::MulAdd(hn::Mul(mass, hn::Mul(s_, y_i)), z_i, sums[part]);
    });
  return total<T>(sums);
}

/// The symmetric matrix of vector i of a block.
template <class T>
HWY_INLINE kn::Sym3<Vec<T>> load_symmetric(const T* matrix, int i) {
  const Lanes<T> d;
  const auto at = [&](int k) HWY_ATTR { return hn::Load(d, matrix + k * nodes_per_block + i); };
  return {at(0), at(1), at(2), at(3), at(4), at(5)};
}

template <class T>
HWY_INLINE kn::Vec3<Vec<T>> load_field(const T* x, int i) {
  const Lanes<T> d;
  const auto at = [&](int k) HWY_ATTR { return hn::Load(d, x + k * nodes_per_block + i); };
  return {{at(0), at(1), at(2)}};
}

template <class T>
HWY_INLINE void store_field(const kn::Vec3<Vec<T>>& v, T* x, int i) {
  const Lanes<T> d;
  for (int a = 0; a < 3; ++a) hn::Store(v[a], d, x + a * nodes_per_block + i);
}

template <class T>
void project(const T* projector, T* x) {
  for (int i = 0; i < nodes_per_block; i += lane_count<T>)
    store_field<T>(kn::mul(load_symmetric(projector, i), load_field(x, i)), x, i);
}

template <class T>
double subtract(double c, const T* x, const T* projector, const T* m, T* z) {
  const Lanes<T> d;
  const auto c_ = hn::Set(d, static_cast<T>(c));
  Vec<T> sums[sum_vectors<T>];
  set_zero<T>(sums);
  for_each_vector<T>([&](int i, int part) HWY_ATTR {
    const auto x_i = load_field(x, i);
    auto z_i = load_field(z, i);
    for (int a = 0; a < 3; ++a) z_i[a] = hn::NegMulAdd(c_, x_i[a], z_i[a]);
    if (projector != nullptr) z_i = kn::mul(load_symmetric(projector, i), z_i);
    store_field<T>(z_i, z, i);
    sums[part] = hn::MulAdd(hn::Load(d, m + i), kn::dot(z_i, z_i), sums[part]);
  });
  return total<T>(sums);
}

template <class T>
void advance(const T* z, double s, double a, double b, double step, const T* w, T* w_last, T* x) {
  const Lanes<T> d;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<T>(value)); };
  const auto s_ = set(s), a_ = set(a), b_ = set(b), step_ = set(step);
  for (int i = 0; i < field_size; i += lane_count<T>) {
    auto w_new = hn::Mul(s_, hn::Load(d, z + i));
    w_new = hn::NegMulAdd(a_, hn::Load(d, w_last + i), w_new);
    w_new = hn::NegMulAdd(b_, hn::Load(d, w + i), w_new);
    hn::Store(w_new, d, w_last + i);
    hn::Store(hn::MulAdd(step_, w_new, hn::Load(d, x + i)), d, x + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
