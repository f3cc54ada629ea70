// SPDX-License-Identifier: BSD-3-Clause
/* The C ABI through which a shared library becomes a Firn solver:
 *
 *     firn check snowball_drop --solver ./libmine.so
 *
 * The library exports one function, firn_guest_entry(), which returns a table of
 * functions. Firn loads the library in a separate process, so a fault of the library
 * is reported and does not take Firn down.
 *
 * This header compiles as C99 and as C++. Lengths in m, times in s, masses in kg;
 * vectors are 3 consecutive doubles, matrices 9 in row-major order. All
 * functions return 0 for success and anything else for failure; last_error()
 * then says why in one line.
 */
#ifndef FIRN_GUEST_H
#define FIRN_GUEST_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Grows by one when anything below changes its meaning or its place. */
#define FIRN_GUEST_ABI_VERSION 1

/* The ten stages of a step (Stomakhin et al. 2013, section 4.1). */
enum firn_guest_stage {
  FIRN_RASTERIZE = 1,       /* m_i, v_i */
  FIRN_VOLUMES = 2,         /* V_p0 of the particles that have none yet (V_0 = 0) */
  FIRN_GRID_FORCES = 3,     /* f_i */
  FIRN_GRID_VELOCITIES = 4, /* v_i* = v_i + dt (f_i/m_i + g) */
  FIRN_GRID_COLLISIONS = 5, /* v_i* after contact; free_directions in semi-implicit scenes */
  FIRN_INTEGRATION = 6,     /* v_i^{n+1} */
  FIRN_DEFORMATION = 7,     /* F_E, F_P */
  FIRN_PARTICLE_VELOCITIES = 8,
  FIRN_PARTICLE_COLLISIONS = 9,
  FIRN_POSITIONS = 10
};

typedef struct firn_guest_material {
  double youngs_modulus;       /* E_0 [Pa] */
  double poisson_ratio;        /* nu */
  double density;              /* rho_0 [kg/m^3] */
  double hardening;            /* xi */
  double critical_compression; /* theta_c; infinity: none */
  double critical_stretch;     /* theta_s; infinity: none */
} firn_guest_material;

typedef struct firn_guest_collider {
  double friction; /* Coulomb mu */
  int32_t sticky;  /* 1: v_rel' = 0 whatever v_n */
  int32_t moves;   /* 1: its velocity is not zero everywhere */
} firn_guest_collider;

/* What a collision test needs at one point. */
typedef struct firn_guest_contact {
  double phi;         /* signed distance, <= 0 inside [m] */
  double normal[3];   /* unit outward normal */
  double velocity[3]; /* the collider's velocity at that point [m/s] */
} firn_guest_contact;

typedef struct firn_guest_scene {
  size_t struct_size;
  double spacing;     /* h [m] */
  double origin[3];   /* position of node (0,0,0) [m] */
  double periodic[3]; /* period along each axis [m], a whole multiple of h; 0 = open */
  double gravity[3];  /* g [m/s^2] */
  double flip;        /* alpha */
  int32_t semi_implicit;
  double implicitness; /* beta */
  double tolerance;    /* relative residual of the semi-implicit solve */
  int32_t max_iterations;
  size_t material_count;
  const firn_guest_material* materials;
  size_t collider_count;
  const firn_guest_collider* colliders; /* to be applied in this order */
  /* Collider `index` at point x and time t. It, what it points to, and everything
   * else in here is valid until the next load() or destroy(). */
  void (*contact)(void* host, size_t index, const double x[3], double t,
                  firn_guest_contact* result);
  void* host;         /* first argument of contact() */
  const char* toml;   /* the whole scene as resolved TOML text */
  double step;        /* fixed dt [s]; 0: chosen by choose_time_step(), by these limits: */
  double max_step;    /* largest dt [s] */
  double cfl;         /* dt <= cfl h / max |v_p| */
  double elastic_cfl; /* dt <= elastic_cfl h / max c_p, explicit only */
} firn_guest_scene;

/* A simulation between two stages. Arrays belong to Firn and live for the call. */
typedef struct firn_guest_state {
  size_t struct_size;
  double time;        /* t^n, start of the step; advances with stage 10 [s] */
  double dt;          /* of the step under way, 0 between steps [s] */
  int64_t step;       /* steps completed */
  int32_t next_stage; /* the stage that comes next; FIRN_RASTERIZE = between steps */

  size_t particle_count;
  double* x;         /* 3 per particle */
  double* v;         /* 3 */
  double* m;         /* 1 */
  double* V_0;       /* 1, 0 = not known yet */
  double* F_E;       /* 9 */
  double* F_P;       /* 9 */
  int64_t* id;       /* 1 */
  int32_t* material; /* 1 */

  /* Nodes of positive mass, sorted by (i,j,k). An array that no stage so far has
   * written is NULL when a state is loaded; when one is stored, every array is
   * there, and what no stage has written is ignored. */
  size_t node_count;
  int32_t* node;           /* 3 per node: i, j, k */
  double* node_m;          /* 1: m_i */
  double* node_v;          /* 3: v_i^n */
  double* node_f;          /* 3: f_i */
  double* node_v_star;     /* 3: v_i* */
  double* free_directions; /* 9: projector onto the directions that contact leaves free */
  double* node_v_new;      /* 3: v_i^{n+1} */
} firn_guest_state;

/* What a step did. */
typedef struct firn_guest_report {
  int64_t grid_nodes;
  int64_t solver_iterations;
  double solver_residual;
  int32_t solver_indefinite;
} firn_guest_report;

typedef struct firn_guest_solver {
  uint32_t abi_version; /* FIRN_GUEST_ABI_VERSION */
  size_t struct_size;   /* sizeof(firn_guest_solver) */
  const char* name;
  const char* description;
  int32_t supports_float;         /* 1: --precision float is accepted */
  int32_t supports_semi_implicit; /* 1: semi-implicit scenes are accepted */
  /* Stages at which it can stop, ascending; the last is FIRN_POSITIONS. A code
   * that takes only whole steps lists that one alone. */
  const int32_t* stops;
  size_t stop_count;

  void* (*create)(int32_t float_precision, int32_t threads); /* NULL: failed */
  void (*destroy)(void* self);
  const char* (*last_error)(void* self); /* one line; lives until the next call */

  int (*load)(void* self, const firn_guest_scene* scene, const firn_guest_state* state);
  /* Dt by the scene's rule, in scenes without a fixed step. NULL: Firn applies the
   * rule to what store() gives. */
  int (*choose_time_step)(void* self, double* dt);
  /* Every stage up to and including `last_stage`. */
  int (*advance_through)(void* self, int32_t last_stage, double dt, firn_guest_report* report);
  /* Number of nodes that store() will write. */
  int (*node_count)(void* self, size_t* count);
  /* Fills the arrays of `state`, which have the sizes announced. */
  int (*store)(void* self, firn_guest_state* state);
} firn_guest_solver;

/* The one function that the library exports. */
typedef const firn_guest_solver* (*firn_guest_entry_function)(void);
#define FIRN_GUEST_ENTRY_NAME "firn_guest_entry"

#ifdef __cplusplus
}
#endif

#endif
