// SPDX-License-Identifier: BSD-3-Clause
/// The kernels of the semi-implicit solve for one instruction set, collected.

#if defined(FIRN_OPTIMIZED_IMPLICIT_TABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_IMPLICIT_TABLE_INL_H_
#undef FIRN_OPTIMIZED_IMPLICIT_TABLE_INL_H_
#else
#define FIRN_OPTIMIZED_IMPLICIT_TABLE_INL_H_
#endif

#include "optimized/implicit/fields-inl.h"
#include "optimized/implicit/kernel_table.hpp"
#include "optimized/implicit/setup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

template <class T, class S>
HessianKernels<T, S> make_hessian_kernels() {
  using Field = FieldType<T, S>;
  return {tile_nodes * vector_plane<T>,
          rows_per_block * vector_rows<T> * row_size<T>,
          rows_per_block * vector_rows<T> * row_size<T>,
          &load_local<T, vector_rows<T>>,
          &load_region<T, vector_rows<T>>,
          &vector_difference<T>,
          &apply_hessian<T, S>,
          &tile_total<T>,
          &add_tile<T, vector_rows<T>, Field>,
          &planar_vector<Field, channels<T>>,
          &pack_vector<T, Field>};
}

template <class T>
FieldKernels<T> make_field_kernels() {
  return {&multiply<T>, &subtract<T>, &advance<T>, &project<T>};
}

template <class S>
SetupKernels<S> make_setup_kernels() {
  return {hwy::TargetName(HWY_TARGET), &hessian_factors_of_block<S>};
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
