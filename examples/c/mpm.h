// SPDX-License-Identifier: BSD-3-Clause
/* The material point method for snow (Stomakhin et al. 2013, section 4.1) in
 * plain C: one function per step of the paper, double precision, sequential.
 * The names are the paper's. Vectors are 3 consecutive doubles, matrices 9 in
 * row-major order; SI units. */
#ifndef MPM_H
#define MPM_H

#include "firn/firn_guest.h"

/* Cells between the origin and a particle, so that i, j and k are 32-bit numbers. */
#define MOST_CELLS 1e9

typedef struct mpm {
  firn_guest_scene scene;
  double time, dt; /* t^n and the step under way */
  int64_t step;
  int next_stage;

  /* Particles. */
  size_t n;
  double *x, *v, *m, *V_0, *F_E, *F_P;
  int64_t* id;
  int32_t* material;

  /* The 4x4x4 nodes around each particle: N((x_p - x_i)/h) and its derivative
   * with respect to x_p along each axis, and the places of the nodes. */
  double *N, *dN; /* 12 per particle: 4 along x, 4 along y, 4 along z */
  size_t* near;   /* 64 per particle */

  /* Nodes within reach of a particle, sorted by (i,j,k). Those that happen to
   * get no mass (a particle exactly 2 h away) keep velocity and force 0. */
  size_t nodes;
  int32_t* node; /* 3 per node: i, j, k */
  double *m_i, *v_i, *f_i, *v_star, *v_new;

  char error[200]; /* why a function returned something other than 0 */
} mpm;

/* All return 0, or something else after writing `error`. */
int find_nodes(mpm* s); /* neighbourhoods at the present positions */
int run_stage(mpm* s, int stage);
int choose_time_step(mpm* s, double* dt);

/* Writes `error` and returns 1. */
int fail(mpm* s, const char* what, size_t index);

#endif
