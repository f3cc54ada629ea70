// SPDX-License-Identifier: BSD-3-Clause
/* Which nodes a particle touches, and with which weights. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mpm.h"

/* The cubic B-spline N(d), d = |x|: d^3/2 - d^2 + 2/3 on [0,1), and on [1,2) the
 * factored form (2-d)^3/6, which stays accurate where it goes to 0. A particle
 * the fraction s of a cell beyond the second of its four nodes is 1+s, s, 1-s,
 * 2-s away from them. */
static void kernel(double s, double h, double N[4], double dN[4]) {
  const double t = 1 - s;
  N[0] = t * t * t / 6;
  N[1] = (0.5 * s - 1) * s * s + 2.0 / 3;
  N[2] = (0.5 * t - 1) * t * t + 2.0 / 3;
  N[3] = s * s * s / 6;
  dN[0] = -0.5 * t * t / h; /* the chain rule's 1/h: derivatives are with respect to x_p */
  dN[1] = (1.5 * s - 2) * s / h;
  dN[2] = -(1.5 * t - 2) * t / h;
  dN[3] = 0.5 * s * s / h;
}

static int compare_nodes(const void* left, const void* right) {
  const int32_t *a = left, *b = right;
  for (int k = 0; k < 3; ++k)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

/* i modulo the period in nodes; i itself along an open axis. */
static int32_t wrapped(int32_t i, int32_t period) {
  return period == 0 ? i : (i % period + period) % period;
}

/* The (i,j,k) of the 64 nodes around particle p, and its weights. */
static int weigh(mpm* s, size_t p, int32_t around[64][3]) {
  const double h = s->scene.spacing;
  int32_t index[3][4];
  for (int axis = 0; axis < 3; ++axis) {
    const double X = (s->x[3 * p + axis] - s->scene.origin[axis]) / h;
    if (!(fabs(X) < MOST_CELLS))
      return fail(s, "position is outside the grid's range, particle", p);
    const double cell = floor(X); /* floor, not truncation: coordinates may be negative */
    kernel(X - cell, h, s->N + 12 * p + 4 * axis, s->dN + 12 * p + 4 * axis);
    const int32_t period = (int32_t)lround(s->scene.periodic[axis] / h);
    for (int a = 0; a < 4; ++a) index[axis][a] = wrapped((int32_t)cell - 1 + a, period);
  }
  for (int a = 0; a < 64; ++a) {
    around[a][0] = index[0][a / 16];
    around[a][1] = index[1][a / 4 % 4];
    around[a][2] = index[2][a % 4];
  }
  return 0;
}

int find_nodes(mpm* s) {
  const size_t most = 64 * s->n;
  int32_t(*around)[3] = malloc((most + 1) * sizeof *around);
  int32_t(*sorted)[3] = malloc((most + 1) * sizeof *sorted);
  int status = around && sorted ? 0 : fail(s, "no memory for nodes around particles:", s->n);
  for (size_t p = 0; p < s->n && status == 0; ++p) status = weigh(s, p, around + 64 * p);
  if (status == 0) {
    memcpy(sorted, around, most * sizeof *sorted);
    qsort(sorted, most, sizeof *sorted, compare_nodes);
    s->nodes = 0;
    for (size_t a = 0; a < most; ++a)
      if (a == 0 || compare_nodes(sorted[a], sorted[a - 1]) != 0)
        memcpy(s->node + 3 * s->nodes++, sorted[a], sizeof *sorted);
    for (size_t a = 0; a < most; ++a) {
      const int32_t* place = bsearch(around[a], s->node, s->nodes, sizeof *around, compare_nodes);
      s->near[a] = (size_t)(place - s->node) / 3;
    }
  }
  free(around);
  free(sorted);
  return status;
}
