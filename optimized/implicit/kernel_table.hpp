#pragma once
/// The kernels of the semi-implicit solve as its drivers see them, one table per pair
/// of types and instruction set.

#include "optimized/implicit/layout.hpp"

namespace firn::optimized {

/// The operator, applied in type T to particles stored in type S.
template <class T, class S>
struct HessianKernels {
  /// Values in a block's tile, in a node block's field as blocks gather it, and in its sums.
  int tile_size, gathered_size, sums_size;

  /// The node values around a block; see KernelTable.
  void (*load_local)(const T* const gathered[8], const HessianScratch<T>&);
  void (*load_region)(const T* gathered, const Region&, const HessianScratch<T>&);
  void (*difference)(const HessianScratch<T>&);

  /// Σ_p (V_p0 A_p F_Eᵀ) ∂w_ip for the velocities around the block, onto its tile.
  void (*apply)(const HessianBlock<S>&, const HessianScratch<T>&, T* tile);

  void (*add_tile)(const T* tile, const Region&, T* sums);
  /// Sums to a planar field.
  void (*planar)(const T* sums, T* field);
  /// A planar field in the order in which blocks gather it.
  void (*pack)(const T* field, T* gathered);
};

/// Work on node fields, a node block at a time. Inner products are (a, b) = Σ m a·b; they
/// are summed in a fixed order.
template <class T>
struct FieldKernels {
  /// z = s (y + factor f/m) − ratio z; returns (s y, z). 0 where there is no mass.
  double (*multiply)(const T* y, const T* f, const T* m, double factor, double s, double ratio,
                     T* z);
  /// z −= c x.
  void (*subtract)(double c, const T* x, T* z);
  /// y = M⁻¹z with the preconditioner's inverse; returns (z, y). Null: y = z.
  double (*precondition)(const T* inverse, const T* z, const T* m, T* y);
  /// w_last = (s y − a w_last − b w) / c, d += step w_last, r = keep r − lose z; returns (r, r).
  double (*advance)(const T* y, double s, double a, double b, double c, double step, double keep,
                    double lose, const T* z, const T* w, const T* m, T* w_last, T* d, T* r);
  /// x = P x.
  void (*project)(const T* projector, T* x);
};

/// What only the storage type matters for.
template <class S>
struct SetupKernels {
  /// The particles of a block in cell order with their factors. `cells` and `begin` are
  /// written, too.
  void (*factors)(const BlockView<S>&, const StepConstants<S>&, std::uint8_t* cells,
                  std::int32_t* begin, S* chunks);

  /// Values in the stiffness tile, its sums, and how they become planar.
  int stiffness_tile_size, stiffness_sums_size;
  /// Σ_p V_p0 [(λ+μ) ∂w ∂wᵀ + μ |∂w|² I] onto a tile.
  void (*stiffness)(const HessianBlock<S>&, S* tile);
  void (*add_stiffness)(const S* tile, const Region&, S* sums);
  /// (P (I + factor D/m) P)⁻¹ on the range of P; P null: everything is free.
  void (*invert)(const S* sums, const S* m, double factor, const S* projector, S* inverse);
};

const HessianKernels<float, float>& hessian_float();
const HessianKernels<double, float>& hessian_double_of_float();
const HessianKernels<double, double>& hessian_double();
const FieldKernels<float>& field_kernels_float();
const FieldKernels<double>& field_kernels_double();
const SetupKernels<float>& setup_kernels_float();
const SetupKernels<double>& setup_kernels_double();

template <class T, class S>
const HessianKernels<T, S>& hessian_kernels() {
  if constexpr (sizeof(T) == 4)
    return hessian_float();
  else if constexpr (sizeof(S) == 4)
    return hessian_double_of_float();
  else
    return hessian_double();
}

template <class T>
const FieldKernels<T>& field_kernels() {
  if constexpr (sizeof(T) == 4)
    return field_kernels_float();
  else
    return field_kernels_double();
}

template <class S>
const SetupKernels<S>& setup_kernels() {
  if constexpr (sizeof(S) == 4)
    return setup_kernels_float();
  else
    return setup_kernels_double();
}

}  // namespace firn::optimized
