// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The kernels of the semi-implicit solve as its drivers see them, one table per pair
/// of types and instruction set.

#include <type_traits>

#include "optimized/implicit/layout.hpp"

namespace firn::optimized {

/// The operator, applied in type T to particles stored in type S.
template <class T, class S>
struct HessianKernels {
  using Field = FieldType<T, S>;

  /// Values in a block's tile, in a node block's field as blocks gather it, and in its sums.
  int tile_size, gathered_size, sums_size;

  /// The node values around a block; see KernelTable.
  void (*load_local)(const T* const gathered[tile_corners], T* local);
  void (*load_region)(const T* gathered, const Region&, T* local);
  void (*difference)(const HessianScratch<T>&);

  /// Σ_p (V_p0 A_p F_Eᵀ) ∂w_ip for the velocities around the block, onto its tile.
  void (*apply)(const HessianBlock<S>&, const HessianScratch<T>&, T* tile);

  /// The sum of a tile's nodes.
  void (*total)(const T* tile, double* total);
  void (*add_tile)(const T* tile, const Region&, Field* sums);
  /// Sums to a planar field.
  void (*planar)(const Field* sums, Field* field);
  /// A planar field in the order in which blocks gather it.
  void (*pack)(const Field* field, T* gathered);
};

/// Work on node fields, a node block at a time. Inner products are (a, b) = Σ m a·b; they
/// are summed in a fixed order.
template <class T>
struct FieldKernels {
  /// z_new = s (z + factor f/m) − ratio z_new; returns (s z, z_new). 0 where there is no mass.
  double (*multiply)(const T* z, const T* f, const T* m, double factor, double s, double ratio,
                     T* z_new);
  /// z = P (z − c x), P null: everything is free; returns (z, z).
  double (*subtract)(double c, const T* x, const T* projector, const T* m, T* z);
  /// w_last = s z − a w_last − b w, x += step w_last.
  void (*advance)(const T* z, double s, double a, double b, double step, const T* w, T* w_last,
                  T* x);
  /// x = P x.
  void (*project)(const T* projector, T* x);
};

/// What only the storage type matters for.
template <class S>
struct SetupKernels {
  const char* target;  ///< name of the instruction set
  /// The factors of a block's particles. `cells` and `begin` are written, too.
  void (*factors)(const BlockView<S>&, const StepConstants<S>&, std::uint8_t* cells,
                  std::int32_t* begin, S* factors);
};

const HessianKernels<float, float>& hessian_float();
const HessianKernels<float, double>& hessian_float_of_double();
const HessianKernels<double, float>& hessian_double_of_float();
const HessianKernels<double, double>& hessian_double();
const FieldKernels<float>& field_kernels_float();
const FieldKernels<double>& field_kernels_double();
const SetupKernels<float>& setup_kernels_float();
const SetupKernels<double>& setup_kernels_double();

/// All of them for particles stored in type S. A solver keeps those of the instruction set that was
/// in use when it was made: the layout of tiles and gathered fields depends on it.
template <class S>
struct ImplicitKernels {
  const HessianKernels<float, S>& hessian_in_float;
  const HessianKernels<double, S>& hessian_in_double;
  const FieldKernels<S>& fields;
  const FieldKernels<double>& fields_in_double;
  const SetupKernels<S>& setup;

  template <class T>
  const HessianKernels<T, S>& hessian() const {
    if constexpr (std::is_same_v<T, float>)
      return hessian_in_float;
    else
      return hessian_in_double;
  }
};

template <class S>
ImplicitKernels<S> implicit_kernels();
template <>
inline ImplicitKernels<float> implicit_kernels() {
  return {hessian_float(), hessian_double_of_float(), field_kernels_float(), field_kernels_double(),
          setup_kernels_float()};
}
template <>
inline ImplicitKernels<double> implicit_kernels() {
  return {hessian_float_of_double(), hessian_double(), field_kernels_double(),
          field_kernels_double(), setup_kernels_double()};
}

}  // namespace firn::optimized
