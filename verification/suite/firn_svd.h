// SPDX-License-Identifier: BSD-3-Clause
/* What a shared library exports so that `firn verify --svd ./libmine.so` can test its singular
 * value decomposition: one of these functions, or both.
 *
 *     A = U diag(sigma) V^T,   matrices row-major,   det U = det V = +1,
 *     sigma[0] >= sigma[1] >= |sigma[2]|, the sign of det A on sigma[2].
 *
 * A matrix that is not finite gives NaN everywhere.
 */
#ifndef FIRN_SVD_H
#define FIRN_SVD_H

#ifdef __cplusplus
extern "C" {
#endif

typedef void (*firn_svd_double_function)(const double A[9], double U[9], double sigma[3],
                                         double V[9]);
typedef void (*firn_svd_float_function)(const float A[9], float U[9], float sigma[3], float V[9]);

#define FIRN_SVD_DOUBLE_NAME "firn_svd_double"
#define FIRN_SVD_FLOAT_NAME "firn_svd_float"

#ifdef __cplusplus
}
#endif

#endif
