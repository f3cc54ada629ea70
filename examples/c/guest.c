// SPDX-License-Identifier: BSD-3-Clause
/* A complete solver for Firn as a shared library:
 *
 *     cc -std=c11 -O2 -ffp-contract=off -fPIC -shared -I FIRN -o libmpm.so *.c -lm
 *     firn check tiny_impact --solver ./libmpm.so
 *
 * with FIRN the folder that holds firn/firn_guest.h. The method is in mpm.c; this
 * file hands states over. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mpm.h"

static void* create(int32_t float_precision, int32_t threads) {
  (void)threads; /* sequential */
  return float_precision ? NULL : calloc(1, sizeof(mpm));
}

static void release(mpm* s) {
  void* arrays[] = {s->x,  s->v,    s->m,    s->V_0, s->F_E, s->F_P, s->id,     s->material, s->N,
                    s->dN, s->near, s->node, s->m_i, s->v_i, s->f_i, s->v_star, s->v_new};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; ++k) free(arrays[k]);
  memset(s, 0, sizeof *s);
}

static void destroy(void* self) {
  release(self);
  free(self);
}

static const char* last_error(void* self) { return ((mpm*)self)->error; }

/* A copy of `size` bytes, of at least one: NULL means no memory only. */
static void* copy(const void* from, size_t size) {
  void* to = malloc(size + 1);
  if (to && size) memcpy(to, from, size);
  return to;
}

/* Node arrays of the state go to the same nodes of ours; where it has none, 0. */
static void take_nodes(mpm* s, const firn_guest_state* state) {
  struct {
    const double* from;
    double* to;
    size_t components;
  } fields[] = {{state->node_m, s->m_i, 1},
                {state->node_v, s->v_i, 3},
                {state->node_f, s->f_i, 3},
                {state->node_v_star, s->v_star, 3},
                {state->node_v_new, s->v_new, 3}};
  for (size_t k = 0; k < sizeof fields / sizeof *fields; ++k) {
    const size_t components = fields[k].components;
    memset(fields[k].to, 0, components * s->nodes * sizeof(double));
    if (!fields[k].from) continue;                          /* no stage so far has written it */
    for (size_t i = 0, j = 0; i < state->node_count; ++i) { /* both are sorted */
      while (j < s->nodes && memcmp(s->node + 3 * j, state->node + 3 * i, 3 * sizeof(int32_t))) ++j;
      if (j < s->nodes)
        memcpy(fields[k].to + components * j, fields[k].from + components * i,
               components * sizeof(double));
    }
  }
}

static int finite_in(const double* numbers, size_t per_particle, size_t p) {
  for (size_t k = 0; k < per_particle; ++k)
    if (!isfinite(numbers[per_particle * p + k])) return 0;
  return 1;
}

/* Numbers that no step could make right again. */
static int check_particles(mpm* s) {
  for (size_t p = 0; p < s->n; ++p) {
    if (!finite_in(s->x, 3, p) || !finite_in(s->v, 3, p) || !finite_in(s->F_E, 9, p) ||
        !finite_in(s->F_P, 9, p))
      return fail(s, "x, v, F_E or F_P is not finite, particle", p);
    if (!(s->m[p] > 0 && isfinite(s->m[p]))) return fail(s, "mass is not positive, particle", p);
    if (!(s->V_0[p] >= 0 && isfinite(s->V_0[p])))
      return fail(s, "V_0 is negative or not finite, particle", p);
  }
  return 0;
}

static int load(void* self, const firn_guest_scene* scene, const firn_guest_state* state) {
  mpm* s = self;
  const size_t n = state->particle_count, most_nodes = 64 * n + 1;
  release(s);
  s->scene = *scene;
  if (scene->semi_implicit) return fail(s, "semi-implicit scenes: supported are", 0);
  s->time = state->time;
  s->dt = state->dt;
  s->step = state->step;
  s->next_stage = state->next_stage;
  s->n = n;
  s->x = copy(state->x, 3 * n * sizeof(double));
  s->v = copy(state->v, 3 * n * sizeof(double));
  s->m = copy(state->m, n * sizeof(double));
  s->V_0 = copy(state->V_0, n * sizeof(double));
  s->F_E = copy(state->F_E, 9 * n * sizeof(double));
  s->F_P = copy(state->F_P, 9 * n * sizeof(double));
  s->id = copy(state->id, n * sizeof(int64_t));
  s->material = copy(state->material, n * sizeof(int32_t));
  s->N = calloc(12 * n + 1, sizeof(double));
  s->dN = calloc(12 * n + 1, sizeof(double));
  s->near = calloc(64 * n + 1, sizeof(size_t));
  s->node = calloc(3 * most_nodes, sizeof(int32_t));
  s->m_i = calloc(most_nodes, sizeof(double));
  s->v_i = calloc(3 * most_nodes, sizeof(double));
  s->f_i = calloc(3 * most_nodes, sizeof(double));
  s->v_star = calloc(3 * most_nodes, sizeof(double));
  s->v_new = calloc(3 * most_nodes, sizeof(double));
  if (!s->x || !s->v || !s->m || !s->V_0 || !s->F_E || !s->F_P || !s->id || !s->material || !s->N ||
      !s->dN || !s->near || !s->node || !s->m_i || !s->v_i || !s->f_i || !s->v_star || !s->v_new)
    return fail(s, "no memory for particles:", n);
  if (check_particles(s)) return 1;
  if (s->next_stage == FIRN_RASTERIZE) return 0;
  if (find_nodes(s)) return 1; /* in the middle of a step */
  take_nodes(s, state);
  return 0;
}

static int next_time_step(void* self, double* dt) { return choose_time_step(self, dt); }

/* Nodes that no mass has reached are not the state's. */
static int node_count(void* self, size_t* count) {
  const mpm* s = self;
  *count = 0;
  for (size_t i = 0; i < s->nodes; ++i) *count += s->m_i[i] > 0;
  return 0;
}

static int advance_through(void* self, int32_t last_stage, double dt, firn_guest_report* report) {
  mpm* s = self;
  size_t nodes = 0;
  s->dt = dt;
  for (int stage = s->next_stage; stage <= last_stage; ++stage) {
    if (run_stage(s, stage)) return 1;
    s->next_stage = stage == FIRN_POSITIONS ? FIRN_RASTERIZE : stage + 1;
  }
  if (s->next_stage == FIRN_RASTERIZE) s->dt = 0;
  node_count(s, &nodes);
  report->grid_nodes = (int64_t)nodes;
  return 0;
}

static int store(void* self, firn_guest_state* state) {
  const mpm* s = self;
  state->time = s->time;
  state->dt = s->dt;
  state->step = s->step;
  state->next_stage = s->next_stage;
  if (s->n > 0) {
    memcpy(state->x, s->x, 3 * s->n * sizeof(double));
    memcpy(state->v, s->v, 3 * s->n * sizeof(double));
    memcpy(state->m, s->m, s->n * sizeof(double));
    memcpy(state->V_0, s->V_0, s->n * sizeof(double));
    memcpy(state->F_E, s->F_E, 9 * s->n * sizeof(double));
    memcpy(state->F_P, s->F_P, 9 * s->n * sizeof(double));
    memcpy(state->id, s->id, s->n * sizeof(int64_t));
    memcpy(state->material, s->material, s->n * sizeof(int32_t));
  }
  for (size_t i = 0, j = 0; i < s->nodes; ++i) {
    if (!(s->m_i[i] > 0)) continue;
    memcpy(state->node + 3 * j, s->node + 3 * i, 3 * sizeof(int32_t));
    state->node_m[j] = s->m_i[i];
    memcpy(state->node_v + 3 * j, s->v_i + 3 * i, 3 * sizeof(double));
    memcpy(state->node_f + 3 * j, s->f_i + 3 * i, 3 * sizeof(double));
    memcpy(state->node_v_star + 3 * j, s->v_star + 3 * i, 3 * sizeof(double));
    memcpy(state->node_v_new + 3 * j, s->v_new + 3 * i, 3 * sizeof(double));
    ++j;
  }
  return 0;
}

static const int32_t stops[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

static const firn_guest_solver solver = {FIRN_GUEST_ABI_VERSION,
                                         sizeof(firn_guest_solver),
                                         "plain-c",
                                         "the ten steps in plain C, one function each",
                                         0, /* double precision only */
                                         0, /* explicit only */
                                         stops,
                                         sizeof stops / sizeof *stops,
                                         create,
                                         destroy,
                                         last_error,
                                         load,
                                         next_time_step,
                                         advance_through,
                                         node_count,
                                         store};

const firn_guest_solver* firn_guest_entry(void);
const firn_guest_solver* firn_guest_entry(void) { return &solver; }
