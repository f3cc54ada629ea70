// SPDX-License-Identifier: BSD-3-Clause
/* Small vectors and 3x3 matrices: 3 and 9 consecutive doubles, row-major. */
#ifndef MAT3_H
#define MAT3_H

double dot(const double a[3], const double b[3]);
void cross(const double a[3], const double b[3], double c[3]);

double determinant(const double F[9]);
void multiply(const double A[9], const double B[9], double AB[9]);             /* A B */
void multiply_transposed(const double A[9], const double B[9], double ABT[9]); /* A B^T */

/* F = U diag(sigma) V^T with rotations U and V, sigma_1 >= sigma_2 >= |sigma_3|;
 * sigma_3 carries the sign of det F. */
void svd(const double F[9], double U[9], double sigma[3], double V[9]);

/* U diag(d) V^T */
void compose(const double U[9], const double d[3], const double V[9], double F[9]);

#endif
