// SPDX-License-Identifier: BSD-3-Clause
#include "mat3.h"

#include <float.h>
#include <math.h>
#include <string.h>

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

double determinant(const double F[9]) {
  double c[3];
  cross(F + 3, F + 6, c);
  return dot(F, c);
}

void multiply(const double A[9], const double B[9], double AB[9]) {
  double product[9];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      product[3 * r + c] = A[3 * r] * B[c] + A[3 * r + 1] * B[3 + c] + A[3 * r + 2] * B[6 + c];
  memcpy(AB, product, sizeof product);
}

void multiply_transposed(const double A[9], const double B[9], double ABT[9]) {
  double product[9];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) product[3 * r + c] = dot(A + 3 * r, B + 3 * c);
  memcpy(ABT, product, sizeof product);
}

void compose(const double U[9], const double d[3], const double V[9], double F[9]) {
  double Ud[9];
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) Ud[3 * r + c] = U[3 * r + c] * d[c];
  multiply_transposed(Ud, V, F);
}

/* One-sided Jacobi. Rotations from the right make the columns of F orthogonal:
 * F V = B, and then B = U diag(sigma). Here the columns are kept as rows of
 * `b` and `v`, so that each is 3 consecutive numbers. */

/* Turns columns p and q of both by the angle at which those of b are orthogonal,
 * tan 2a = 2 b_p.b_q / (|b_p|^2 - |b_q|^2), the longer one first. Returns 0 if
 * they were so already. */
static int orthogonalize(double b[3][3], double v[3][3], int p, int q) {
  const double pp = dot(b[p], b[p]), qq = dot(b[q], b[q]), pq = dot(b[p], b[q]);
  const int in_order = pp >= (1 - 4 * DBL_EPSILON) * qq; /* no endless exchange of equals */
  /* Below eps |b_p||b_q| the angle between them is roundoff. */
  if (in_order && fabs(pq) <= DBL_EPSILON * sqrt(pp) * sqrt(qq)) return 0;
  const double a = 0.5 * atan2(2 * pq, pp - qq); /* in (-pi/2, pi/2]: the longer one first */
  const double c = cos(a), s = sin(a);
  double(*matrices[2])[3] = {b, v};
  for (int m = 0; m < 2; ++m)
    for (int k = 0; k < 3; ++k) {
      const double x = matrices[m][p][k], y = matrices[m][q][k];
      matrices[m][p][k] = c * x + s * y;
      matrices[m][q][k] = c * y - s * x;
    }
  return 1;
}

/* A unit vector at right angles to the unit vector u. */
static void perpendicular(const double u[3], double e[3]) {
  int smallest = 0;
  for (int k = 1; k < 3; ++k)
    if (fabs(u[k]) < fabs(u[smallest])) smallest = k;
  double axis[3] = {0, 0, 0};
  axis[smallest] = 1;
  cross(u, axis, e);
  const double length = sqrt(dot(e, e));
  for (int k = 0; k < 3; ++k) e[k] /= length;
}

void svd(const double F[9], double U[9], double sigma[3], double V[9]) {
  double b[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, u[3][3] = {{1, 0, 0}};
  double largest = 0;
  int exponent =
      0; /* F/2^exponent has entries below 1: their squares do not underflow or overflow */
  for (int k = 0; k < 9; ++k) largest = fmax(largest, fabs(F[k]));
  if (largest > 0 && isfinite(largest)) frexp(largest, &exponent);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) b[c][r] = ldexp(F[3 * r + c], -exponent);
  /* Convergence is quadratic: 4 or 5 sweeps do. */
  for (int sweep = 0, changed = 1; changed && sweep < 30; ++sweep)
    changed = orthogonalize(b, v, 0, 1) | orthogonalize(b, v, 0, 2) | orthogonalize(b, v, 1, 2);

  /* u_1 and u_2 are the columns of B, normalized; u_3 = u_1 x u_2 makes U a
   * rotation, and gives sigma_3 the sign of det F. */
  sigma[0] = sqrt(dot(b[0], b[0]));
  for (int k = 0; k < 3 && sigma[0] > 0; ++k) u[0][k] = b[0][k] / sigma[0];
  sigma[1] = sqrt(dot(b[1], b[1]));
  if (sigma[1] > 0)
    for (int k = 0; k < 3; ++k) u[1][k] = b[1][k] / sigma[1];
  else
    perpendicular(u[0], u[1]);
  cross(u[0], u[1], u[2]);
  sigma[2] = dot(u[2], b[2]);
  for (int k = 0; k < 3; ++k) sigma[k] = ldexp(sigma[k], exponent);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      U[3 * r + c] = u[c][r];
      V[3 * r + c] = v[c][r];
    }
}
