// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set: foreach_target.h includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimized/math/batch.cpp"
#include "optimized/math/batch.hpp"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimized/math/elastic_box-inl.h"
#include "optimized/math/exp-inl.h"
#include "optimized/math/hessian-inl.h"
#include "optimized/math/polar-inl.h"
#include "optimized/math/return_map-inl.h"
#include "optimized/math/stress-inl.h"
#include "optimized/math/svd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

template <class T>
using Widest = hn::CappedTag<T, packet_size / 2>;
/// Two vectors side by side, where the dependency chains are long.
template <class T>
using Twice = PairOf<Widest<T>>;

/// Vector j of an array: where its first component's lanes begin.
template <class D>
HWY_INLINE std::size_t offset(D d, std::size_t j, std::size_t rows) {
  const std::size_t first = j * Lanes(d);
  return first / packet_size * rows * packet_size + first % packet_size;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Mat3<V> load(D d, const hn::TFromD<D>* p) {
  Mat3<V> A;
  for (int k = 0; k < 9; ++k) A.m[k] = LoadU(d, p + k * packet_size);
  return A;
}

template <class D, class V>
HWY_INLINE void store(D d, const Mat3<V>& A, hn::TFromD<D>* p) {
  for (int k = 0; k < 9; ++k) StoreU(A.m[k], d, p + k * packet_size);
}

template <class D, class V>
HWY_INLINE void store_svd(D d, std::size_t j, const Mat3<V>& U, const Vec3<V>& s, const Mat3<V>& V_,
                          hn::TFromD<D>* U_out, hn::TFromD<D>* s_out, hn::TFromD<D>* V_out) {
  store(d, U, U_out + offset(d, j, 9));
  store(d, V_, V_out + offset(d, j, 9));
  for (int k = 0; k < 3; ++k) StoreU(s[k], d, s_out + offset(d, j, 3) + k * packet_size);
}

/// Number of vectors in `packets`.
template <class D>
HWY_INLINE std::size_t vectors(D d, std::size_t packets) {
  return packets * packet_size / Lanes(d);
}

template <class T, class D>
void svd_one_by_one(D d, const T* A, T* U, T* sigma, T* V_, std::size_t packets) {
  using V = hn::Vec<D>;
  for (std::size_t j = 0; j < vectors(d, packets); ++j) {
    Mat3<V> u, v;
    Vec3<V> s;
    svd(d, load(d, A + offset(d, j, 9)), u, s, v);
    store_svd(d, j, u, s, v, U, sigma, V_);
  }
}

template <class T>
void svd_plain(const T* A, T* U, T* sigma, T* V_, std::size_t packets) {
  svd_one_by_one(Widest<T>(), A, U, sigma, V_, packets);
}

template <class T>
void svd_scalar(const T* A, T* U, T* sigma, T* V_, std::size_t packets) {
  svd_one_by_one(hn::CappedTag<T, 1>(), A, U, sigma, V_, packets);
}

template <class T>
void svd_staged(const T* A, T* U, T* sigma, T* V_, std::size_t packets) {
  const Widest<T> d;
  using V = hn::Vec<Widest<T>>;
  // One body would wait for its own roots and divisions; a short loop over several independent
  // vectors, their states in the first-level cache, keeps the units busy.
  constexpr std::size_t group = 8;
  SvdState<V> state[group];
  const std::size_t n = vectors(d, packets);
  for (std::size_t first = 0; first < n; first += group) {
    const std::size_t count = HWY_MIN(group, n - first);
    for (std::size_t i = 0; i < count; ++i) {
      state[i].A = load(d, A + offset(d, first + i, 9));
      svd_detail::isolated_eigenvalue(d, state[i]);
    }
    for (std::size_t i = 0; i < count; ++i) svd_detail::isolated_eigenvector(d, state[i]);
    for (std::size_t i = 0; i < count; ++i) svd_detail::plane_eigenvectors(d, state[i]);
    for (std::size_t i = 0; i < count; ++i) svd_detail::rotate_columns(d, state[i]);
    for (std::size_t i = 0; i < count; ++i) {
      Mat3<V> u, v;
      Vec3<V> s;
      svd_detail::left_vectors(d, state[i], u, s);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) v(r, c) = state[i].v[c][r];
      store_svd(d, first + i, u, s, v, U, sigma, V_);
    }
  }
}

template <class T>
void polar_all(const T* F, T* R, std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j)
    store(d, polar(d, load(d, F + offset(d, j, 9))), R + offset(d, j, 9));
}

template <class T>
void polar_near_rotation_all(const T* F, T* R, std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j)
    store(d, polar_near_rotation(d, load(d, F + offset(d, j, 9))), R + offset(d, j, 9));
}

/// 1 in the lanes of the mask, 0 elsewhere.
template <class D>
HWY_INLINE hn::Vec<D> as_number(D d, hn::Mask<D> mask) {
  return IfThenElseZero(mask, constant(d, 1));
}

template <class T>
void inside_elastic_box_all(const T* F_minus_I, const ElasticBox<T>& box, T* inside,
                            std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j) {
    const auto mask = inside_elastic_box(d, load(d, F_minus_I + offset(d, j, 9)), box);
    StoreU(as_number(d, mask), d, inside + offset(d, j, 1));
  }
}

template <class T>
void exp_all(const T* x, T* y, std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j)
    StoreU(exp(d, LoadU(d, x + offset(d, j, 1))), d, y + offset(d, j, 1));
}

template <class D, class V>
HWY_INLINE void store(D d, const Sym3<V>& S, hn::TFromD<D>* p) {
  const V value[6] = {S.xx, S.xy, S.xz, S.yy, S.yz, S.zz};
  for (int k = 0; k < 6; ++k) StoreU(value[k], d, p + k * packet_size);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Sym3<V> load_symmetric(D d, const hn::TFromD<D>* p) {
  V value[6];
  for (int k = 0; k < 6; ++k) value[k] = LoadU(d, p + k * packet_size);
  return {value[0], value[1], value[2], value[3], value[4], value[5]};
}

template <class T>
void kirchhoff_stress_all(const T* F_E_minus_I, const T* mu, const T* lambda, T* tau,
                          std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j) {
    const std::size_t scalar = offset(d, j, 1);
    const auto t = kirchhoff_stress(d, load(d, F_E_minus_I + offset(d, j, 9)),
                                    LoadU(d, mu + scalar), LoadU(d, lambda + scalar));
    store(d, t, tau + offset(d, j, 6));
  }
}

template <class T>
void hessian_factors_all(const T* F_E_minus_I, const T* two_mu, const T* lambda, T* factors,
                         std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j) {
    const std::size_t scalar = offset(d, j, 1);
    const auto f = hessian_factors(d, load(d, F_E_minus_I + offset(d, j, 9)),
                                   LoadU(d, two_mu + scalar), LoadU(d, lambda + scalar));
    T* out = factors + offset(d, j, 15);
    store(d, f.stretch, out), store(d, f.K_inverse, out + 6 * packet_size);
    StoreU(f.shear, d, out + 12 * packet_size), StoreU(f.volume, d, out + 13 * packet_size);
    StoreU(f.transposed, d, out + 14 * packet_size);
  }
}

template <class T>
void hessian_action_all(const T* factors, const T* L, T* result, std::size_t packets) {
  const Widest<T> d;
  for (std::size_t j = 0; j < vectors(d, packets); ++j) {
    const T* in = factors + offset(d, j, 15);
    const HessianFactors<hn::Vec<Widest<T>>> f = {
        load_symmetric(d, in), load_symmetric(d, in + 6 * packet_size),
        LoadU(d, in + 12 * packet_size), LoadU(d, in + 13 * packet_size),
        LoadU(d, in + 14 * packet_size)};
    store(d, hessian_action(f, load(d, L + offset(d, j, 9))), result + offset(d, j, 9));
  }
}

template <ReturnMap path, class T, class D>
void return_map_with(D d, const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                     std::size_t packets) {
  for (std::size_t j = 0; j < vectors(d, packets); ++j) {
    T *E = F_E_minus_I + offset(d, j, 9), *P = F_P_minus_I + offset(d, j, 9);
    auto D_E = load(d, E), D_P = load(d, P);
    const auto mask = return_map<path>(d, box, D_E, D_P);
    store(d, D_E, E), store(d, D_P, P);
    StoreU(as_number(d, mask), d, changed + offset(d, j, 1));
  }
}

template <class T>
void return_map_all(const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                    std::size_t packets) {
  return_map_with<ReturnMap::fast>(Twice<T>(), box, F_E_minus_I, F_P_minus_I, changed, packets);
}

template <class T>
void return_map_scalar_all(const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                           std::size_t packets) {
  return_map_with<ReturnMap::fast>(hn::CappedTag<T, 1>(), box, F_E_minus_I, F_P_minus_I, changed,
                                   packets);
}

template <class T>
void return_map_svd_all(const ElasticBox<T>& box, T* F_E_minus_I, T* F_P_minus_I, T* changed,
                        std::size_t packets) {
  return_map_with<ReturnMap::svd>(Widest<T>(), box, F_E_minus_I, F_P_minus_I, changed, packets);
}

template <class T>
const BatchKernels<T>& table() {
  static const BatchKernels<T> kernels = {hwy::TargetName(HWY_TARGET),
                                          hn::Lanes(Widest<T>()),
                                          svd_staged<T>,
                                          svd_plain<T>,
                                          svd_scalar<T>,
                                          polar_all<T>,
                                          polar_near_rotation_all<T>,
                                          inside_elastic_box_all<T>,
                                          exp_all<T>,
                                          kirchhoff_stress_all<T>,
                                          hessian_factors_all<T>,
                                          hessian_action_all<T>,
                                          return_map_all<T>,
                                          return_map_scalar_all<T>,
                                          return_map_svd_all<T>};
  return kernels;
}

const BatchKernels<float>* table_float() { return &table<float>(); }
const BatchKernels<double>* table_double() { return &table<double>(); }

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace firn::kernels {
HWY_EXPORT(table_float);
HWY_EXPORT(table_double);

template <>
const BatchKernels<float>& batch_kernels<float>() {
  return *HWY_DYNAMIC_DISPATCH(table_float)();
}
template <>
const BatchKernels<double>& batch_kernels<double>() {
  return *HWY_DYNAMIC_DISPATCH(table_double)();
}
}  // namespace firn::kernels
#endif
