// SPDX-License-Identifier: BSD-3-Clause
/// The kernels of one instruction set, collected.

#if defined(FIRN_OPTIMIZED_TABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_OPTIMIZED_TABLE_INL_H_
#undef FIRN_OPTIMIZED_TABLE_INL_H_
#else
#define FIRN_OPTIMIZED_TABLE_INL_H_
#endif

#include "optimized/passes/grid-inl.h"
#include "optimized/passes/kernel_table.hpp"
#include "optimized/passes/measure-inl.h"
#include "optimized/passes/p2g-inl.h"
#include "optimized/passes/update-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::optimized {
namespace HWY_NAMESPACE {

template <class T>
KernelTable<T> make_table() {
  KernelTable<T> t;
  t.target = hwy::TargetName(HWY_TARGET);
  t.shape = {channels<T>,
             mass_rows<T>,
             force_rows<T>,
             gather_rows<T>,
             tile_nodes * tile_nodes * tile_rows<T> * tile_row_size<T>,
             rows_per_block * gather_rows<T> * row_size<T>,
             rows_per_block * tile_rows<T> * row_size<T>};
  t.scatter = &scatter<T>;
  t.add_tile = &add_tile<T, tile_rows<T>>;
  t.planar = &planar<T>;
  t.node_velocities = &node_velocities<T>;
  t.node_forces = &node_forces<T>;
  t.node_velocities_star = &node_velocities_star<T>;
  t.pack_gathered = &pack_gathered<T>;
  t.load_local = &load_local<T, gather_rows<T>>;
  t.load_region = &load_region<T, gather_rows<T>>;
  t.difference = &difference<T>;
  t.update = &update<T>;
  t.stress = &stress_pass<T>;
  t.measure = &measure_pass<T>;
  return t;
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::optimized
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
