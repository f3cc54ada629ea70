// SPDX-License-Identifier: BSD-3-Clause
/* A guest library that breaks as FIRN_BROKEN says, "PLACE FAULT": where in its life,
 * and how. Without it, it is a sound solver for particles that meet nothing. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "firn/firn_guest.h"

static const char* words(void) {
  const char* text = getenv("FIRN_BROKEN");
  return text ? text : "";
}

static int is(const char* place_and_fault) { return strcmp(words(), place_and_fault) == 0; }

static unsigned overflow_stack(unsigned depth);
static unsigned (*volatile deeper)(unsigned) = overflow_stack; /* no loop, no warning */

static unsigned overflow_stack(unsigned depth) {
  volatile char room[4096];
  memset((void*)room, (int)depth, sizeof room);
  return depth + (unsigned)room[17] + deeper(depth + 1);
}

static void write_channel(const void* bytes, size_t count) {
  if (write(3, bytes, count) < 0) _exit(9);
  for (;;) pause();
}

/* Does not come back, except from faults that it does not know. */
static void break_here(const char* place) {
  const size_t length = strlen(place);
  if (strncmp(words(), place, length) != 0 || words()[length] != ' ') return;
  const char* fault = words() + length + 1;
  if (strcmp(fault, "segfault") == 0) raise(SIGSEGV);
  if (strcmp(fault, "null") == 0) *(volatile int*)(uintptr_t)strlen("") = 1;
  if (strcmp(fault, "stack") == 0) exit((int)overflow_stack(0));
  if (strcmp(fault, "abort") == 0) {
    fputs("assertion `mass > 0' failed\n", stderr);
    abort();
  }
  if (strcmp(fault, "exit") == 0) exit(0);
  if (strcmp(fault, "hang") == 0)
    for (;;) pause();
  if (strcmp(fault, "spin") == 0)
    for (volatile unsigned n = 0;; ++n) continue;
  if (strcmp(fault, "print") == 0)
    for (;;) puts("and another line of output");
  if (strcmp(fault, "garbage") == 0) write_channel("0123456789abcdefghijklmnopqrstuvwxyz", 36);
  if (strcmp(fault, "huge") == 0) { /* a message of 2^39 bytes is announced */
    const uint32_t header[4] = {0x4e524946, 6, 0, 128};
    write_channel(header, sizeof header);
  }
  if (strcmp(fault, "close") == 0) {
    close(3);
    for (;;) pause();
  }
  if (strcmp(fault, "trample") == 0) /* over the end of an array, as far as it goes */
    for (volatile char* at = malloc(1);; at += 4096) *at = 1;
}

typedef struct particles {
  firn_guest_scene scene;
  size_t n;
  double time, *x, *v, *rest;
  int64_t step, *id;
  int32_t *material, next_stage;
} particles;

static void* create(int32_t float_precision, int32_t threads) {
  (void)float_precision;
  (void)threads;
  break_here("create");
  return is("create null-self") ? NULL : calloc(1, sizeof(particles));
}

static void destroy(void* self) { (void)self; }

static const char* last_error(void* self) {
  (void)self;
  if (is("load refuses-silently")) return NULL;
  return "the moon is full\nand \x1b[31mthe tide\xff is high";
}

static int load(void* self, const firn_guest_scene* scene, const firn_guest_state* state) {
  particles* s = self;
  const size_t n = state->particle_count;
  break_here("load");
  if (is("load refuses") || is("load refuses-silently")) return 1;
  if (getenv("FIRN_CHATTY")) puts("loading; this line is no answer");
  s->scene = *scene;
  s->n = n;
  s->time = state->time;
  s->step = state->step;
  s->next_stage = state->next_stage;
  s->x = memcpy(malloc(24 * n), state->x, 24 * n);
  s->v = memcpy(malloc(24 * n), state->v, 24 * n);
  s->rest = malloc(160 * n);
  memcpy(s->rest, state->m, 8 * n);
  memcpy(s->rest + n, state->V_0, 8 * n);
  memcpy(s->rest + 2 * n, state->F_E, 72 * n);
  memcpy(s->rest + 11 * n, state->F_P, 72 * n);
  s->id = memcpy(malloc(8 * n), state->id, 8 * n);
  s->material = memcpy(malloc(4 * n), state->material, 4 * n);
  return 0;
}

static int choose_time_step(void* self, double* dt) {
  (void)self;
  break_here("choose");
  *dt = is("choose nothing") ? 0 : 1e-4;
  return 0;
}

static int advance_through(void* self, int32_t last_stage, double dt, firn_guest_report* report) {
  particles* s = self;
  (void)last_stage;
  break_here("advance");
  if (is("advance refuses")) return 1;
  for (size_t k = 0; k < 3 * s->n; ++k) {
    s->v[k] += dt * s->scene.gravity[k % 3];
    s->x[k] += dt * s->v[k];
  }
  if (is("advance collider")) {
    firn_guest_contact contact;
    s->scene.contact(s->scene.host, 77, s->x, s->time, &contact);
  }
  s->time += dt;
  s->step += 1;
  report->grid_nodes = 0;
  return 0;
}

static int node_count(void* self, size_t* count) {
  (void)self;
  break_here("count");
  *count = is("count too-many") ? (size_t)-1 / 64 : 0;
  return 0;
}

static int store(void* self, firn_guest_state* state) {
  const particles* s = self;
  const size_t n = s->n;
  break_here("store");
  if (is("store nothing")) return 0;
  state->time = s->time;
  state->dt = 0;
  state->step = s->step;
  state->next_stage = s->step > 0 && is("store stage") ? 77 : s->next_stage;
  memcpy(state->x, s->x, 24 * n);
  memcpy(state->v, s->v, 24 * n);
  memcpy(state->m, s->rest, 8 * n);
  memcpy(state->V_0, s->rest + n, 8 * n);
  memcpy(state->F_E, s->rest + 2 * n, 72 * n);
  memcpy(state->F_P, s->rest + 11 * n, 72 * n);
  memcpy(state->id, s->id, 8 * n);
  memcpy(state->material, s->material, 4 * n);
  if (s->step > 0 && is("store nan")) state->x[4] = state->x[4] * 0 / 0.0;
  if (is("store ids")) state->id[0] = 12345;
  if (is("store material")) state->material[0] = 77;
  return 0;
}

static firn_guest_solver solver = {FIRN_GUEST_ABI_VERSION,
                                   sizeof(firn_guest_solver),
                                   "broken",
                                   "breaks where it is told to",
                                   0,
                                   0,
                                   NULL,
                                   0,
                                   create,
                                   destroy,
                                   last_error,
                                   load,
                                   choose_time_step,
                                   advance_through,
                                   node_count,
                                   store};

__attribute__((constructor)) static void when_loaded(void) { break_here("constructor"); }

const firn_guest_solver* firn_guest_entry(void);
const firn_guest_solver* firn_guest_entry(void) {
  static const int32_t stops[] = {10}, wrong_stops[] = {3, 99};
  break_here("entry");
  if (is("entry nothing")) return NULL;
  if (is("entry version")) solver.abi_version = 99;
  if (is("entry size")) solver.struct_size = 8;
  if (is("entry function")) solver.load = NULL;
  solver.stops = is("entry stops") ? wrong_stops : stops;
  solver.stop_count = is("entry stops") ? 2 : 1;
  return &solver;
}
