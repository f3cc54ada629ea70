// SPDX-License-Identifier: BSD-3-Clause
/// Singular value decomposition A = U Σ Vᵀ of 3x3 matrices, one in every lane, to
/// full working accuracy.
///
/// Convention: det U = det V = +1, σ1 ≥ σ2 ≥ |σ3|, the sign of det A on σ3. A lane
/// that holds NaN or infinity answers NaN everywhere; no lane ever depends on its
/// neighbours.
///
/// 1. C = AᵀA. Its deviator, scaled to unit size, has the eigenvalues
///    2 cos(θ), 2 cos(θ ± 2π/3); one of them is always isolated (|2cos θ| in
///    [√3, 2]) and follows from 4c³ − 3c = h = |det|/2 without acos or cos.
/// 2. Its eigenvector is the largest column of the adjugate; one exact Jacobi
///    rotation in the orthogonal plane gives the other two: V.
/// 3. B = A V. AᵀA loses what lies below √eps σ1, so the orthogonality of B's
///    columns is *tested*; lanes that fail get one-sided Jacobi sweeps
///    (Hestenes 1958) until B is orthogonal to working accuracy.
/// 4. U: b1 normalized, completed to a basis; b2 projected into its plane; σ3 = u3·b3.

#if defined(FIRN_KERNELS_SVD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FIRN_KERNELS_SVD_INL_H_
#undef FIRN_KERNELS_SVD_INL_H_
#else
#define FIRN_KERNELS_SVD_INL_H_
#endif

#include "optimized/math/mat3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace firn::kernels {
namespace HWY_NAMESPACE {

/// What the stages of the decomposition hand to each other.
template <class V>
struct SvdState {
  Mat3<V> A;     ///< the matrix; scaled by 1/scale_up/scale_down where its size needs it
  V scale[2];    ///< powers of two, set if `scaled` (two factors: their product may be denormal)
  bool scaled;   ///< whether any lane's size needed it
  Sym3<V> S;     ///< deviator of AᵀA scaled to tr S² = 6
  V root;        ///< the isolated eigenvalue of S
  Vec3<V> v[3];  ///< columns of V
  Vec3<V> b[3];  ///< columns of B = A V
  V square[3];   ///< |b_j|²
};

namespace svd_detail {

/// Sizes at which squares of a scaled matrix's entries are worthless: 1e-37 and
/// 1e-300 are the smallest normal numbers with some room.
template <class D>
HWY_INLINE hn::Vec<D> tiny(D d) {
  return constant(d, sizeof(hn::TFromD<D>) == 4 ? 1e-37 : 1e-300);
}

/// a / s, given r = 1/s rounded: correctly rounded wherever nothing underflows, so
/// that x/|x| is exactly ±1 (diagonal matrices keep exact bits).
template <class V>
HWY_INLINE V divide(V a, V s, V r) {
#if HWY_NATIVE_FMA
  (void)s;
  const V q = a * r;
  return MulAdd(NegMulAdd(q, s, a), r, q);
#else
  (void)r;
  return a / s;
#endif
}

/// e, f: complete the unit vector n to a right-handed orthonormal basis (n, e, f).
/// Duff et al. 2017, branch-free; smooth except across n_z = 0.
template <class D, class V>
HWY_INLINE void complete_basis(D d, const Vec3<V>& n, Vec3<V>& e, Vec3<V>& f) {
  const V one = constant(d, 1);
  const V s = CopySign(one, n[2]);
  const V a = Neg(one) / (s + n[2]);
  const V na = n[0] * a, sx = s * n[0];
  const V b = n[1] * na;
  e = {{MulAdd(sx, na, one), s * b, Neg(sx)}};
  f = {{b, MulAdd(n[1] * n[1], a, s), Neg(n[1])}};
}

/// The rotation by at most 45° that diagonalizes [[p, o/2], [o/2, q]] for p − q = |d|:
/// tan = o / (|d| + √(d² + o²)); exactly the identity for o = 0.
template <class D, class V>
HWY_INLINE void jacobi_rotation(D d, V difference, V twice_off, V& c, V& s) {
  const V r = Sqrt(MulAdd(difference, difference, twice_off * twice_off));
  const V t = twice_off / larger(Abs(difference) + r, tiny(d));
  c = constant(d, 1) / Sqrt(MulAdd(t, t, constant(d, 1)));
  s = t * c;
}

/// c = cos(acos(h)/3) for h in [0, 1]: the root in [√3/2, 1] of 4c³ − 3c = h, from minimax
/// polynomials, without acos or cos. Error 9.6e-9 in float, 6.2e-17 in double.
template <class D, class V>
HWY_INLINE V cos_third(D d, V h) {
  if constexpr (sizeof(hn::TFromD<D>) == 4)
    return balanced_polynomial(
        d, h,
        {0.866025413419139954, 0.16666532722491297, -0.0480818208989228858, 0.024418875062749513,
         -0.0143645291567175008, 0.00777340828985516952, -0.0030016837279166536,
         0.000565019421600740913});
  else
    return balanced_polynomial(
        d, h,
        {0.86602540378443870884, 0.16666666666662473561, -0.048112522427760983591,
         0.024691357814891221586, -0.015592016214468052427, 0.010973865713942033755,
         -0.0082573139449306665159, 0.0064984651461971907251, -0.0052695309850525856741,
         0.0043306942127963649953, -0.0035129778698888342502, 0.0026980992539712767533,
         -0.0018575561978015929273, 0.0010773348350155708269, -0.00049164906431030197064,
         0.00016238308024701181159, -0.000034093541740446365958, 3.3897378294108932148e-6});
}

/// The largest power of two ≤ m, for normal m.
template <class D, class V>
HWY_INLINE V power_of_two_below(D d, V m) {
  using T = hn::TFromD<D>;
  const hn::RebindToUnsigned<D> du;
  const auto exponent =
      Set(du, sizeof(T) == 4 ? static_cast<hn::TFromD<decltype(du)>>(0x7f800000u)
                             : static_cast<hn::TFromD<decltype(du)>>(0x7ff0000000000000ull));
  return BitCast(d, And(BitCast(du, m), exponent));
}

/// Lanes outside the comfortable range: scale by powers of two so that the largest
/// entry lies in [1, 2); NaN everywhere for lanes that are not finite.
template <class D, class V>
HWY_NOINLINE void rescale(D d, hn::Mask<D> odd, SvdState<V>& k) {
  constexpr bool single = sizeof(hn::TFromD<D>) == 4;
  const V one = constant(d, 1);
  V largest = Abs(k.A.m[0]);
  auto finite = IsFinite(k.A.m[0]);
  for (int i = 1; i < 9; ++i) {
    largest = larger(largest, Abs(k.A.m[i]));
    finite = And(finite, IsFinite(k.A.m[i]));
  }
  // Denormals first: 2^60 or 2^300 lifts them all into the normal range.
  const V up = constant(d, single ? 0x1p60 : 0x1p300),
          down = constant(d, single ? 0x1p-60 : 0x1p-300);
  const auto small = And(odd, largest < constant(d, single ? 0x1p-60 : 0x1p-300));
  const V lift = IfThenElse(small, up, one);
  largest = larger(largest * lift, constant(d, single ? 0x1p-126 : 0x1p-1022));
  V power = power_of_two_below(d, largest);
  power = IfThenElse(And(odd, finite), power, one);
  const V poison = constant(d, std::numeric_limits<double>::quiet_NaN());
  for (V& a : k.A.m) {
    // Dividing by a power of two is exact; its reciprocal may not be a normal number.
    const V scaled = (a * lift) / power;
    a = IfThenElse(odd, IfThenElse(finite, scaled, poison), a);
  }
  k.scaled = true;
  k.scale[0] = power;
  k.scale[1] = IfThenElse(small, down, one);
}

/// Step 1: the scaled deviator of AᵀA and its isolated eigenvalue.
template <class D, class V>
HWY_INLINE void isolated_eigenvalue(D d, SvdState<V>& k) {
  constexpr bool single = sizeof(hn::TFromD<D>) == 4;
  const V one = constant(d, 1);
  k.scaled = false;
  Sym3<V> C = gram(k.A);
  V trace = (C.xx + C.yy) + C.zz;
  // The comparisons are written so that NaN counts as odd.
  const auto usual =
      And(trace > constant(d, single ? 1e-8 : 1e-60), trace < constant(d, single ? 1e8 : 1e60));
  if (HWY_UNLIKELY(!AllTrue(d, usual))) {
    rescale(d, Not(usual), k);
    C = gram(k.A);
  }
  V mean;
  const Sym3<V> A = deviator(d, C, mean);
  const V size = one / Sqrt(larger(deviator_size(d, A), tiny(d)));
  k.S = {A.xx * size, A.xy * size, A.xz * size, A.yy * size, A.yz * size, A.zz * size};

  const V det_S = det(k.S);
  const V h = smaller(Abs(det_S) * constant(d, 0.5), one);
  const V c = cos_third(d, h);
  k.root = CopySign(c + c, det_S);
}

/// Step 2, first half: v[0] = eigenvector of the isolated root, v[1], v[2] complete it.
template <class D, class V>
HWY_INLINE void isolated_eigenvector(D d, SvdState<V>& k) {
  const Sym3<V> M = {k.S.xx - k.root, k.S.xy, k.S.xz, k.S.yy - k.root, k.S.yz, k.S.zz - k.root};
  const Sym3<V> adj = adjugate(M);
  // The column with the largest diagonal entry is the longest, and that entry its largest: the
  // trace is (root−λ2)(root−λ3) ≥ 3, so it is at least 1. Divided by it the column reads (1, a, b)
  // in some order, which gives a diagonal matrix its axes exactly.
  const auto third = adj.zz > larger(adj.xx, adj.yy);
  const auto second = AndNot(third, adj.yy > adj.xx);
  const auto first = Not(Or(second, third));
  const V one = constant(d, 1);
  const V inverse = one / larger(larger(adj.xx, adj.yy), adj.zz);
  const V a = IfThenElse(third, adj.xz, adj.xy) * inverse;
  const V b = IfThenElse(first, adj.xz, adj.yz) * inverse;
  const V w = one / Sqrt(MulAdd(a, a, MulAdd(b, b, one)));
  const V aw = a * w, bw = b * w;
  k.v[0] = {{IfThenElse(first, w, aw), IfThenElse(second, w, IfThenElse(third, bw, aw)),
             IfThenElse(third, w, bw)}};
  complete_basis(d, k.v[0], k.v[1], k.v[2]);
}

/// Step 2, second half: the exact 2x2 rotation in the plane (v1, v2), then the
/// columns in cyclic order (det V stays +1) with the largest eigenvalue first.
template <class D, class V>
HWY_INLINE void plane_eigenvectors(D d, SvdState<V>& k) {
  // The 2x2 block [[p, off], [off, q]]; its trace is minus the isolated eigenvalue, since tr S = 0.
  const Vec3<V> w = mul(k.S, k.v[1]);
  const V p = dot(w, k.v[1]), off = dot(w, k.v[2]);
  const V difference = (p + p) + k.root;
  V c, s;
  jacobi_rotation(d, difference, off + off, c, s);
  // (c, s) belongs to the larger eigenvalue if the first diagonal entry is the larger one;
  // if not, (|s|, ±c) does.
  const auto swap = difference < Zero(d);
  const V c2 = IfThenElse(swap, Abs(s), c);
  const V s2 = IfThenElse(swap, CopySign(c, s), s);
  const auto smallest = k.root < Zero(d);  // the isolated eigenvalue comes last
  for (int i = 0; i < 3; ++i) {
    const V a = k.v[1][i], b = k.v[2][i], n = k.v[0][i];
    const V large = MulAdd(s2, b, c2 * a), small = NegMulAdd(s2, a, c2 * b);
    k.v[0][i] = IfThenElse(smallest, large, n);
    k.v[1][i] = IfThenElse(smallest, small, large);
    k.v[2][i] = IfThenElse(smallest, n, small);
  }
}

/// Step 3, first half: B = A V.
template <class D, class V>
HWY_INLINE void rotate_columns(D, SvdState<V>& k) {
  for (int j = 0; j < 3; ++j) {
    k.b[j] = mul(k.A, k.v[j]);
    k.square[j] = dot(k.b[j], k.b[j]);
  }
}

/// Lanes whose B is not orthogonal to `multiple` eps σ1 (what U Σ Vᵀ = A needs), or not sorted.
template <class D, class V>
HWY_INLINE hn::Mask<D> not_orthogonal(D d, const SvdState<V>& k, double multiple) {
  const V b01 = dot(k.b[0], k.b[1]), b02 = dot(k.b[0], k.b[2]), b12 = dot(k.b[1], k.b[2]);
  const V eps = epsilon(d, multiple);
  const V limit = eps * k.square[0];                            // |b0·b_j| ≤ m eps |b0|²
  const V limit12 = (eps * eps) * (k.square[0] * k.square[1]);  // |b1·b2| ≤ m eps |b0||b1|
  auto bad = larger(Abs(b01), Abs(b02)) > limit;
  bad = Or(bad, b12 * b12 > larger(limit12, tiny(d)));
  // Squares differ by roundoff where columns are equal: 8 eps, relative (never absolute) slack.
  const V slack = constant(d, 1) + epsilon(d, 8);
  bad = Or(bad, k.square[1] > k.square[0] * slack);
  return Or(bad, k.square[2] > k.square[1] * slack);
}

/// In the lanes of `mask`: exchange columns p and q if q is longer; a sign keeps det V = +1.
template <class D, class V>
HWY_INLINE void sort_columns(D, hn::Mask<D> mask, SvdState<V>& k, int p, int q) {
  const auto swap = And(mask, k.square[p] < k.square[q]);
  for (int i = 0; i < 3; ++i) {
    const V bp = k.b[p][i], vp = k.v[p][i];
    k.b[p][i] = IfThenElse(swap, k.b[q][i], bp);
    k.b[q][i] = IfThenElse(swap, Neg(bp), k.b[q][i]);
    k.v[p][i] = IfThenElse(swap, k.v[q][i], vp);
    k.v[q][i] = IfThenElse(swap, Neg(vp), k.v[q][i]);
  }
  const V square_p = k.square[p];
  k.square[p] = IfThenElse(swap, k.square[q], square_p);
  k.square[q] = IfThenElse(swap, square_p, k.square[q]);
}

/// In the lanes of `mask`: rotate columns p, q of B and V so that b_p·b_q = 0.
template <class D, class V>
HWY_INLINE void jacobi_step(D d, hn::Mask<D> mask, SvdState<V>& k, int p, int q) {
  const V off = dot(k.b[p], k.b[q]);
  const V difference = dot(k.b[p], k.b[p]) - dot(k.b[q], k.b[q]);
  V c, s;
  jacobi_rotation(d, difference, off + off, c, s);
  s = IfThenElse(difference < Zero(d), Neg(s), s);
  for (int i = 0; i < 3; ++i) {
    const V bp = k.b[p][i], bq = k.b[q][i], vp = k.v[p][i], vq = k.v[q][i];
    k.b[p][i] = IfThenElse(mask, MulAdd(s, bq, c * bp), bp);
    k.b[q][i] = IfThenElse(mask, NegMulAdd(s, bp, c * bq), bq);
    k.v[p][i] = IfThenElse(mask, MulAdd(s, vq, c * vp), vp);
    k.v[q][i] = IfThenElse(mask, NegMulAdd(s, vp, c * vq), vq);
  }
}

/// Step 3, second half: one-sided Jacobi on the lanes of `bad` only. Convergence is
/// quadratic from an already nearly orthogonal B: three sweeps are usual, eight bound it.
template <class D, class V>
HWY_NOINLINE void clean_up(D d, hn::Mask<D> bad, SvdState<V>& k) {
  for (int sweep = 0; sweep < 8 && !AllFalse(d, bad); ++sweep) {
    sort_columns(d, bad, k, 0, 1), sort_columns(d, bad, k, 0, 2), sort_columns(d, bad, k, 1, 2);
    jacobi_step(d, bad, k, 0, 1), jacobi_step(d, bad, k, 0, 2), jacobi_step(d, bad, k, 1, 2);
    for (int j = 0; j < 3; ++j) k.square[j] = IfThenElse(bad, dot(k.b[j], k.b[j]), k.square[j]);
    bad = And(bad, not_orthogonal(d, k, 2));
  }
}

/// Steps 3 and 4: test, clean up where needed, then U and Σ.
template <class D, class V>
HWY_INLINE void left_vectors(D d, SvdState<V>& k, Mat3<V>& U, Vec3<V>& sigma) {
  const V one = constant(d, 1), zero = Zero(d);
  const auto bad = not_orthogonal(d, k, 3);
  if (HWY_UNLIKELY(!AllFalse(d, bad))) clean_up(d, bad, k);

  const V s1 = Sqrt(k.square[0]);
  const V r1 = one / s1;
  const auto null1 = k.square[0] <= tiny(d);
  Vec3<V> u1, e, f;
  for (int i = 0; i < 3; ++i)
    u1[i] = IfThenElse(null1, i == 0 ? one : zero, divide(k.b[0][i], s1, r1));
  complete_basis(d, u1, e, f);

  const V x = dot(e, k.b[1]), y = dot(f, k.b[1]);
  const V square2 = MulAdd(x, x, y * y);
  const auto null2 = square2 <= tiny(d);
  const V s2 = Sqrt(square2);
  const V r2 = one / s2;
  const V cx = IfThenElse(null2, one, divide(x, s2, r2));
  const V cy = IfThenElse(null2, zero, divide(y, s2, r2));
  Vec3<V> u2, u3;
  for (int i = 0; i < 3; ++i) {
    u2[i] = MulAdd(cx, e[i], cy * f[i]);
    u3[i] = MulSub(cx, f[i], cy * e[i]);
    U(i, 0) = u1[i], U(i, 1) = u2[i], U(i, 2) = u3[i];
  }
  // Roundoff may order equal values wrongly by an ulp: the convention is exact.
  const V sigma2 = smaller(IfThenElse(null2, zero, s2), s1);
  const V sigma3 = larger(smaller(dot(u3, k.b[2]), sigma2), Neg(sigma2));
  sigma = {{s1, sigma2, sigma3}};
  if (HWY_UNLIKELY(k.scaled))
    for (V& s : sigma.v) s = s * k.scale[0] * k.scale[1];
}

}  // namespace svd_detail

/// A = U diag(σ) Vᵀ in every lane. Backward error ‖UΣVᵀ − A‖ ≤ 10 eps ‖A‖, orthogonality
/// of U and V 12 eps, each σ within 6 eps σ1 (measured largest errors stand in the tests).
template <class D, class V = hn::Vec<D>>
HWY_INLINE void svd(D d, const Mat3<V>& A, Mat3<V>& U, Vec3<V>& sigma, Mat3<V>& V_) {
  SvdState<V> k;
  k.A = A;
  svd_detail::isolated_eigenvalue(d, k);
  svd_detail::isolated_eigenvector(d, k);
  svd_detail::plane_eigenvectors(d, k);
  svd_detail::rotate_columns(d, k);
  svd_detail::left_vectors(d, k, U, sigma);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) V_(i, j) = k.v[j][i];
}

}  // namespace HWY_NAMESPACE
}  // namespace firn::kernels
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
