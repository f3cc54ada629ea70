// SPDX-License-Identifier: BSD-3-Clause
// The double kernels of the semi-implicit solve, compiled once for every instruction set.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimized/implicit/kernels_double.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "optimized/implicit/table-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

const HessianKernels<double, double>* hessian_double_table() {
  static const HessianKernels<double, double> kernels = make_hessian_kernels<double, double>();
  return &kernels;
}

const HessianKernels<double, float>* hessian_double_of_float_table() {
  static const HessianKernels<double, float> kernels = make_hessian_kernels<double, float>();
  return &kernels;
}

const FieldKernels<double>* field_double_table() {
  static const FieldKernels<double> kernels = make_field_kernels<double>();
  return &kernels;
}

const SetupKernels<double>* setup_double_table() {
  static const SetupKernels<double> kernels = make_setup_kernels<double>();
  return &kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace firn::optimized {

HWY_EXPORT(hessian_double_table);
HWY_EXPORT(field_double_table);
HWY_EXPORT(setup_double_table);
HWY_EXPORT(hessian_double_of_float_table);

const HessianKernels<double, double>& hessian_double() {
  return *HWY_DYNAMIC_DISPATCH(hessian_double_table)();
}
const FieldKernels<double>& field_kernels_double() {
  return *HWY_DYNAMIC_DISPATCH(field_double_table)();
}
const SetupKernels<double>& setup_kernels_double() {
  return *HWY_DYNAMIC_DISPATCH(setup_double_table)();
}
const HessianKernels<double, float>& hessian_double_of_float() {
  return *HWY_DYNAMIC_DISPATCH(hessian_double_of_float_table)();
}

}  // namespace firn::optimized
#endif  // HWY_ONCE
