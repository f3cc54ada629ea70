// SPDX-License-Identifier: BSD-3-Clause
// The float kernels of the semi-implicit solve, compiled once for every instruction set.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimized/implicit/kernels_float.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "optimized/implicit/table-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

const HessianKernels<float, float>* hessian_float_table() {
  static const HessianKernels<float, float> kernels = make_hessian_kernels<float, float>();
  return &kernels;
}

const HessianKernels<float, double>* hessian_float_of_double_table() {
  static const HessianKernels<float, double> kernels = make_hessian_kernels<float, double>();
  return &kernels;
}

const FieldKernels<float>* field_float_table() {
  static const FieldKernels<float> kernels = make_field_kernels<float>();
  return &kernels;
}

const SetupKernels<float>* setup_float_table() {
  static const SetupKernels<float> kernels = make_setup_kernels<float>();
  return &kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace firn::optimized {

HWY_EXPORT(hessian_float_table);
HWY_EXPORT(field_float_table);
HWY_EXPORT(setup_float_table);
HWY_EXPORT(hessian_float_of_double_table);

const HessianKernels<float, float>& hessian_float() {
  return *HWY_DYNAMIC_DISPATCH(hessian_float_table)();
}
const FieldKernels<float>& field_kernels_float() {
  return *HWY_DYNAMIC_DISPATCH(field_float_table)();
}
const SetupKernels<float>& setup_kernels_float() {
  return *HWY_DYNAMIC_DISPATCH(setup_float_table)();
}

const HessianKernels<float, double>& hessian_float_of_double() {
  return *HWY_DYNAMIC_DISPATCH(hessian_float_of_double_table)();
}

}  // namespace firn::optimized
#endif  // HWY_ONCE
