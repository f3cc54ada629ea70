// SPDX-License-Identifier: BSD-3-Clause
/* The ten steps, in the paper's order. */
#include "mpm.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mat3.h"

int fail(mpm* s, const char* what, size_t index) {
  snprintf(s->error, sizeof s->error, "%s %zu", what, index);
  return 1;
}

static int finite(const double* a, size_t count) {
  for (size_t k = 0; k < count; ++k)
    if (!isfinite(a[k])) return 0;
  return 1;
}

/* w_ip and its gradient with respect to x_p, for the a-th of the 64 nodes around p. */
static double weight(const mpm* s, size_t p, int a) {
  const double* N = s->N + 12 * p;
  return N[a / 16] * N[4 + a / 4 % 4] * N[8 + a % 4];
}

static void weight_gradient(const mpm* s, size_t p, int a, double grad[3]) {
  const double *N = s->N + 12 * p, *dN = s->dN + 12 * p;
  const int i = a / 16, j = 4 + a / 4 % 4, k = 8 + a % 4;
  grad[0] = dN[i] * N[j] * N[k];
  grad[1] = N[i] * dN[j] * N[k];
  grad[2] = N[i] * N[j] * dN[k];
}

/* Step 1. m_i = sum_p m_p w_ip,  v_i = sum_p m_p v_p w_ip / m_i */
static int rasterize(mpm* s) {
  if (find_nodes(s)) return 1;
  memset(s->m_i, 0, s->nodes * sizeof(double));
  memset(s->v_i, 0, 3 * s->nodes * sizeof(double));
  for (size_t p = 0; p < s->n; ++p)
    for (int a = 0; a < 64; ++a) {
      const size_t i = s->near[64 * p + a];
      const double m = s->m[p] * weight(s, p, a);
      s->m_i[i] += m;
      for (int k = 0; k < 3; ++k) s->v_i[3 * i + k] += m * s->v[3 * p + k];
    }
  for (size_t i = 0; i < s->nodes; ++i)
    for (int k = 0; k < 3; ++k)
      if (s->m_i[i] > 0) s->v_i[3 * i + k] /= s->m_i[i]; /* however light: no threshold */
  return 0;
}

/* Step 2. rho_p0 = sum_i m_i w_ip / h^3,  V_p0 = m_p / rho_p0, where it is not known yet */
static int volumes(mpm* s) {
  const double h = s->scene.spacing;
  for (size_t p = 0; p < s->n; ++p) {
    if (s->V_0[p] > 0) continue;
    double rho = 0;
    for (int a = 0; a < 64; ++a) rho += s->m_i[s->near[64 * p + a]] * weight(s, p, a) / (h * h * h);
    s->V_0[p] = s->m[p] / rho;
  }
  return 0;
}

/* mu and lambda after hardening: times exp(xi (1 - J_P)) */
static void lame(const mpm* s, size_t p, double* mu, double* lambda) {
  const firn_guest_material* material = &s->scene.materials[s->material[p]];
  const double E = material->youngs_modulus, nu = material->poisson_ratio;
  const double harder = exp(material->hardening * (1 - determinant(s->F_P + 9 * p)));
  *mu = harder * E / (2 * (1 + nu));
  *lambda = harder * E * nu / ((1 + nu) * (1 - 2 * nu));
}

/* Step 3. f_i = - sum_p V_p0 [2 mu (F_E - R_E) F_E^T + lambda (J_E - 1) J_E I] grad w_ip */
static int grid_forces(mpm* s) {
  memset(s->f_i, 0, 3 * s->nodes * sizeof(double));
  for (size_t p = 0; p < s->n; ++p) {
    const double* F = s->F_E + 9 * p;
    const double J = determinant(F), one[3] = {1, 1, 1};
    double mu, lambda, U[9], sigma[3], V[9], R[9], difference[9], tau[9];
    lame(s, p, &mu, &lambda);
    svd(F, U, sigma, V);
    compose(U, one, V, R); /* R_E = U V^T */
    for (int k = 0; k < 9; ++k) difference[k] = 2 * mu * (F[k] - R[k]);
    multiply_transposed(difference, F, tau);
    for (int k = 0; k < 9; k += 4) tau[k] += lambda * (J - 1) * J;
    for (int a = 0; a < 64; ++a) {
      double grad[3], *f = s->f_i + 3 * s->near[64 * p + a];
      weight_gradient(s, p, a, grad);
      for (int k = 0; k < 3; ++k) f[k] -= s->V_0[p] * dot(tau + 3 * k, grad);
    }
  }
  return 0;
}

/* Step 4. v_i* = v_i + dt (f_i / m_i + g) */
static int grid_velocities(mpm* s) {
  memset(s->v_star, 0, 3 * s->nodes * sizeof(double));
  for (size_t i = 0; i < s->nodes; ++i)
    for (int k = 0; k < 3; ++k)
      if (s->m_i[i] > 0)
        s->v_star[3 * i + k] =
            s->v_i[3 * i + k] + s->dt * (s->f_i[3 * i + k] / s->m_i[i] + s->scene.gravity[k]);
  return 0;
}

/* Contact of velocity v at x with every collider in the scene's order (section 8).
 * The collider's own motion is taken at time t^n. */
static void collide(const mpm* s, const double x[3], double v[3]) {
  for (size_t c = 0; c < s->scene.collider_count; ++c) {
    const firn_guest_collider* collider = &s->scene.colliders[c];
    firn_guest_contact at;
    s->scene.contact(s->scene.host, c, x, s->time, &at);
    if (at.phi > 0) continue;
    double v_rel[3], v_t[3], keep = 0;
    for (int k = 0; k < 3; ++k) v_rel[k] = v[k] - at.velocity[k];
    const double v_n = dot(v_rel, at.normal);
    if (!collider->sticky && v_n >= 0) continue; /* separating */
    for (int k = 0; k < 3; ++k) v_t[k] = v_rel[k] - at.normal[k] * v_n;
    const double slip = sqrt(dot(v_t, v_t));
    /* Coulomb: the tangential part loses mu |v_n|, or all it has. */
    if (!collider->sticky && slip > -collider->friction * v_n)
      keep = 1 + collider->friction * v_n / slip;
    for (int k = 0; k < 3; ++k) v[k] = keep * v_t[k] + at.velocity[k];
  }
}

/* Step 5. v_i* after contact, at x_i = origin + h (i,j,k) */
static int grid_collisions(mpm* s) {
  for (size_t i = 0; i < s->nodes; ++i) {
    double x[3];
    for (int k = 0; k < 3; ++k) x[k] = s->scene.origin[k] + s->scene.spacing * s->node[3 * i + k];
    if (s->m_i[i] > 0) collide(s, x, s->v_star + 3 * i);
  }
  return 0;
}

/* Step 6. v_i^{n+1} = v_i* (explicit) */
static int integration(mpm* s) {
  memcpy(s->v_new, s->v_star, 3 * s->nodes * sizeof(double));
  return 0;
}

/* Step 7. F = (I + dt grad v_p) F_E; what exceeds the elastic limits goes to F_P. */
static int deformation(mpm* s) {
  for (size_t p = 0; p < s->n; ++p) {
    const firn_guest_material* material = &s->scene.materials[s->material[p]];
    double step[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, U[9], sigma[3], V[9], limited[3], inverse[3];
    for (int a = 0; a < 64; ++a) {
      const double* v = s->v_new + 3 * s->near[64 * p + a];
      double grad[3];
      weight_gradient(s, p, a, grad);
      for (int k = 0; k < 9; ++k) step[k] += s->dt * v[k / 3] * grad[k % 3];
    }
    double *F_E = s->F_E + 9 * p, *F_P = s->F_P + 9 * p, F[9];
    multiply(step, F_E, F_E); /* all of it elastic at first */
    svd(F_E, U, sigma, V);
    for (int k = 0; k < 3; ++k) {
      limited[k] =
          fmin(fmax(sigma[k], 1 - material->critical_compression), 1 + material->critical_stretch);
      inverse[k] = 1 / limited[k];
    }
    if (memcmp(limited, sigma, sizeof sigma) == 0) continue;
    multiply(F_E, F_P, F);        /* F = F_E F_P does not change */
    compose(U, limited, V, F_E);  /* F_E = U Sigma V^T */
    compose(V, inverse, U, step); /* F_P = V Sigma^-1 U^T F */
    multiply(step, F, F_P);
  }
  return 0;
}

/* Step 8. v_p = (1 - alpha) v_PIC + alpha v_FLIP */
static int particle_velocities(mpm* s) {
  const double alpha = s->scene.flip;
  for (size_t p = 0; p < s->n; ++p)
    for (int k = 0; k < 3; ++k) {
      double pic = 0, flip = s->v[3 * p + k];
      for (int a = 0; a < 64; ++a) {
        const size_t i = 3 * s->near[64 * p + a] + k;
        const double w = weight(s, p, a);
        pic += s->v_new[i] * w;
        flip += (s->v_new[i] - s->v_i[i]) * w; /* v_i as step 1 made it */
      }
      s->v[3 * p + k] = (1 - alpha) * pic + alpha * flip;
    }
  return 0;
}

/* Step 9. v_p after contact, at x_p^n: the particle has not moved yet */
static int particle_collisions(mpm* s) {
  for (size_t p = 0; p < s->n; ++p) collide(s, s->x + 3 * p, s->v + 3 * p);
  return 0;
}

/* Step 10. x_p = x_p + dt v_p, wrapped into [origin, origin + period) */
static int positions(mpm* s) {
  for (size_t q = 0; q < 3 * s->n; ++q) {
    const double cells = (s->x[q] + s->dt * s->v[q] - s->scene.origin[q % 3]) / s->scene.spacing;
    if (!(fabs(cells) < MOST_CELLS)) return fail(s, "leaves the grid's range, particle", q / 3);
  }
  for (size_t q = 0; q < 3 * s->n; ++q) {
    const double period = s->scene.periodic[q % 3], low = s->scene.origin[q % 3];
    double x = s->x[q] + s->dt * s->v[q];
    if (period > 0 && !(x >= low && x < low + period)) {
      x -= period * floor((x - low) / period);
      if (x < low || x >= low + period) x = low; /* rounded onto the other end */
    }
    s->x[q] = x;
  }
  s->time += s->dt;
  s->step += 1;
  return 0;
}

int run_stage(mpm* s, int stage) {
  static int (*const stages[])(mpm*) = {
      rasterize,   volumes,     grid_forces,         grid_velocities,     grid_collisions,
      integration, deformation, particle_velocities, particle_collisions, positions};
  if (stages[stage - 1](s)) return 1;
  /* A number that is not finite fails the stage that makes it. */
  const double* written[] = {s->v_i,   s->V_0, s->f_i, s->v_star, s->v_star,
                             s->v_new, s->F_P, s->v,   s->v,      s->x};
  const size_t count[] = {3 * s->nodes, s->n,     3 * s->nodes, 3 * s->nodes, 3 * s->nodes,
                          3 * s->nodes, 9 * s->n, 3 * s->n,     3 * s->n,     3 * s->n};
  if (!finite(written[stage - 1], count[stage - 1]) || !finite(s->F_E, 9 * s->n))
    return fail(s, "a number is not finite after stage", (size_t)stage);
  return 0;
}

/* dt <= max_step, cfl h / max |v_p|, elastic_cfl h / max c_p with c_p^2 = (lambda + 2 mu) / rho_p
 */
int choose_time_step(mpm* s, double* dt) {
  double v = 0, c = 0;
  for (size_t p = 0; p < s->n; ++p) {
    const double V = s->V_0[p], m = s->m[p];
    const double rho = V > 0 ? m / V : s->scene.materials[s->material[p]].density;
    double mu, lambda;
    lame(s, p, &mu, &lambda);
    v = fmax(v, sqrt(dot(s->v + 3 * p, s->v + 3 * p)));
    c = fmax(c, sqrt((lambda + 2 * mu) / rho));
  }
  *dt =
      fmin(s->scene.max_step, s->scene.spacing * fmin(s->scene.cfl / v, s->scene.elastic_cfl / c));
  return isfinite(v) && isfinite(c) ? 0
                                    : fail(s, "a speed is not finite after step", (size_t)s->step);
}
