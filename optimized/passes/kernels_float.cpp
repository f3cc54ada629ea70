// SPDX-License-Identifier: BSD-3-Clause
// The float kernels, compiled once for every instruction set.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimized/passes/kernels_float.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "optimized/passes/table-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

const KernelTable<float>* float_table() {
  static const KernelTable<float> kernels = make_table<float>();
  return &kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace firn::optimized {

HWY_EXPORT(float_table);

const KernelTable<float>& float_kernels() { return *HWY_DYNAMIC_DISPATCH(float_table)(); }

}  // namespace firn::optimized
#endif  // HWY_ONCE
