// SPDX-License-Identifier: BSD-3-Clause
/// Stages 1, 2 and 4: masses, velocities, volumes, and the forces' work on them.

#include <algorithm>
#include <map>

#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// A node with less mass than this, in units of the mean particle mass, was thought to be
/// negligible.
constexpr double light = 1e-4;

double mean_mass(const Particles& p) {
  double sum = 0;
  for (const double m : p.m) sum += m;
  return sum / static_cast<double>(std::max<std::size_t>(p.size(), 1));
}

/// m_i and v_i from particles that are where they will be at the end of the step.
void rasterize_ahead(const Step& s) {
  Particles ahead = s.particles;
  for (std::size_t p = 0; p < ahead.size(); ++p)
    ahead.x[p] = s.scene.wrap(ahead.x[p] + s.dt * ahead.v[p]);
  Grid there;
  reference::Stencils stencils;
  stencils.build(s.scene, ahead, Stage::rasterize, there.node);
  reference::rasterize(ahead, stencils, there);
  for (std::size_t i = 0; i < s.grid.size(); ++i) {
    const auto at = std::lower_bound(there.node.begin(), there.node.end(), s.grid.node[i]);
    const bool found = at != there.node.end() && *at == s.grid.node[i];
    const auto j = static_cast<std::size_t>(at - there.node.begin());
    s.grid.m[i] = found ? there.m[j] : 0;
    s.grid.v[i] = found ? there.v[j] : Vec3(Vec3::Zero());
  }
}

/// Momentum and mass of particle p at its nodes, times `sign`.
void scatter(const Step& s, std::size_t p, double sign, std::vector<double>& m,
             std::vector<Vec3>& momentum) {
  s.stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
    m[i] += sign * s.particles.m[p] * w_ip;
    momentum[i] += sign * s.particles.m[p] * w_ip * s.particles.v[p];
  });
}

void divide(Grid& grid, const std::vector<Vec3>& momentum) {
  for (std::size_t i = 0; i < grid.size(); ++i)
    grid.v[i] = grid.m[i] > 0 ? Vec3(momentum[i] / grid.m[i]) : Vec3(Vec3::Zero());
}

/// Two threads, half of the particles each: where the last particle of the first meets the
/// first of the second at a node, one update overwrites the other.
void rasterize_with_race(const Step& s) {
  Grid& grid = s.grid;
  const std::size_t n = s.particles.size(), half = n / 2;
  grid.m.assign(grid.size(), 0.0);
  std::vector<Vec3> momentum(grid.size(), Vec3::Zero());
  for (std::size_t p = 0; p < n; ++p) scatter(s, p, 1, grid.m, momentum);
  if (half > 0) {
    std::vector<bool> contended(grid.size(), false);
    s.stencils.for_each_node(half, [&](std::size_t i, double w_ip) { contended[i] = w_ip > 0; });
    const std::size_t p = half - 1;
    s.stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
      if (!contended[i]) return;
      grid.m[i] -= s.particles.m[p] * w_ip;
      momentum[i] -= s.particles.m[p] * w_ip * s.particles.v[p];
    });
  }
  divide(grid, momentum);
}

void mean_without_masses(const Step& s) {
  std::vector<double> weight(s.grid.size(), 0.0);
  std::vector<Vec3> sum(s.grid.size(), Vec3::Zero());
  for (std::size_t p = 0; p < s.particles.size(); ++p)
    s.stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
      weight[i] += w_ip;
      sum[i] += w_ip * s.particles.v[p];
    });
  for (std::size_t i = 0; i < s.grid.size(); ++i)
    if (weight[i] > 0) s.grid.v[i] = sum[i] / weight[i];
}

void add_rasterize(std::vector<Mutant>& list) {
  Adder add(list, Stage::rasterize);
  add("weights_of_the_wrong_time", "step 1 takes the weights at x_p + Δt v_p instead of x_p",
      "the particles were moved too early",
      around(Stage::rasterize, [](const StageFunction& right, const Step& s) {
        right(s);
        rasterize_ahead(s);
      }));
  add("light_nodes_thresholded", "nodes lighter than 1e-4 of a particle are dropped",
      "a guard against division by almost zero; loses the momentum it cuts off",
      after(Stage::rasterize, [](const Step& s) {
        for (std::size_t i = 0; i < s.grid.size(); ++i)
          if (s.grid.m[i] < light * mean_mass(s.particles)) {
            s.grid.m[i] = 0;
            s.grid.v[i].setZero();
          }
      }));
  add("momentum_not_divided", "v_i holds Σ m_p v_p w_ip, not divided by m_i", slip,
      after(Stage::rasterize, [](const Step& s) {
        for (std::size_t i = 0; i < s.grid.size(); ++i) s.grid.v[i] *= s.grid.m[i];
      }));
  add("mean_without_masses", "v_i = Σ v_p w_ip / Σ w_ip: the masses are left out of the mean",
      "right as long as all particles weigh the same", after(Stage::rasterize, mean_without_masses))
      .needs = "particles of different masses";
  add("last_particle_forgotten", "the loop of step 1 ends one particle early", slip,
      from_other_particles(Stage::rasterize, [](Particles& p, const Step&) {
        if (p.size() > 0) p.resize(p.size() - 1);
      }));
  add("race_in_the_scatter", "two threads add to the same nodes without a lock: one update is lost",
      "a parallel loop over particles",
      around(Stage::rasterize, [](const StageFunction& right, const Step& s) {
        right(s);
        rasterize_with_race(s);
      }));
  Mutant& order =
      add("sums_depend_on_threads",
          "each thread sums into its own grid; the order of additions follows their number", field,
          around(Stage::rasterize, [](const StageFunction& right, const Step& s) {
            right(s);
            if (s.threads > 1) rasterize_by_threads(s);
          }));
  order.check_sees_it = false;
  order.needs = "several threads";
}

void add_volumes(std::vector<Mutant>& list) {
  Adder add(list, Stage::volumes);
  add("known_volumes_recomputed",
      "step 2 estimates V_p0 anew in every step, also where it is known",
      "\"first step only\" was overlooked",
      around(Stage::volumes, [](const StageFunction& right, const Step& s) {
        for (double& V : s.particles.V_0) V = 0;
        right(s);
      }));
  const auto estimated = [](auto change) {
    return around(Stage::volumes, [=](const StageFunction& right, const Step& s) {
      const std::vector<double> before = s.particles.V_0;
      right(s);
      for (std::size_t p = 0; p < before.size(); ++p)
        if (before[p] == 0) s.particles.V_0[p] = change(s, p);
    });
  };
  add("cell_area_for_volume", "density is Σ m_i w_ip / h²: a 2D code taken to 3D", field,
      estimated(
          [](const Step& s, std::size_t p) { return s.particles.V_0[p] / s.scene.grid.spacing; }))
      .needs = "volumes that are not stated";
  add("density_of_the_nearest_node", "density is that of the nearest node, without weights",
      "the formula is printed with w_i, not w_ip", estimated([](const Step& s, std::size_t p) {
        double largest = 0, m = 0;
        s.stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
          if (w_ip > largest) largest = w_ip, m = s.grid.m[i];
        });
        const double h = s.scene.grid.spacing;
        return s.particles.m[p] * h * h * h / m;
      }))
      .needs = "volumes that are not stated";
  add("volume_from_rest_density",
      "V_p0 = m_p / ρ_0 of the material, whatever the particles' spacing", "a shortcut for step 2",
      estimated([](const Step& s, std::size_t p) {
        return s.particles.m[p] / material_of(s, p).density;
      }))
      .needs = "volumes that are not stated";
}

void add_grid_velocities(std::vector<Mutant>& list) {
  Adder add(list, Stage::grid_velocities);
  const auto v_star = [](auto formula) {
    return after(Stage::grid_velocities, [=](const Step& s) {
      for (std::size_t i = 0; i < s.grid.size(); ++i)
        if (s.grid.m[i] > 0) s.grid.v_star[i] = formula(s, s.grid.v[i], s.grid.f[i], s.grid.m[i]);
    });
  };
  using V = const Vec3&;
  add("gravity_missing", "v_i* = v_i + Δt f_i/m_i", "the summary's step 4 does not mention gravity",
      v_star([](const Step& s, V v, V f, double m) { return Vec3(v + s.dt * f / m); }));
  add("gravity_twice", "gravity is added as a body force and as an acceleration", slip,
      v_star([](const Step& s, V v, V f, double m) {
        return Vec3(v + s.dt * (f / m + 2 * s.scene.gravity));
      }));
  add("gravity_divided_by_mass", "v_i* = v_i + Δt (f_i + g)/m_i", "g taken for a force",
      v_star([](const Step& s, V v, V f, double m) {
        return Vec3(v + s.dt * (f + s.scene.gravity) / m);
      }));
  add("gravity_dropped_on_light_nodes", "nodes lighter than 1e-4 of a particle do not fall",
      "a guard around the whole update of light nodes",
      v_star([](const Step& s, V v, V f, double m) {
        const bool heavy = m >= light * mean_mass(s.particles);
        return Vec3(v + s.dt * (f / m + (heavy ? s.scene.gravity : Vec3(Vec3::Zero()))));
      }));
  add("force_taken_for_velocity",
      "v_i* = v_i + f_i/m_i + Δt g: the force was summed into a velocity", field,
      v_star([](const Step& s, V v, V f, double m) {
        return Vec3(v + f / m + s.dt * s.scene.gravity);
      }));
  add("half_a_kick", "v_i* = v_i + ½Δt (f_i/m_i + g)", "half of a leapfrog step",
      v_star([](const Step& s, V v, V f, double m) {
        return Vec3(v + 0.5 * s.dt * (f / m + s.scene.gravity));
      }));
  add("mass_plus_a_little", "f_i/(m_i + 1e-10): a guard against division by zero", field,
      v_star([](const Step& s, V v, V f, double m) {
        return Vec3(v + s.dt * (f / (m + 1e-10) + s.scene.gravity));
      }));
  add("old_velocity_overwritten", "v_i* is written over v_i, which step 8 needs",
      "one array for both",
      after(Stage::grid_velocities, [](const Step& s) { s.grid.v = s.grid.v_star; }));
}

}  // namespace

void rasterize_by_threads(const Step& s) {
  Grid& grid = s.grid;
  const std::size_t n = s.particles.size(), threads = static_cast<std::size_t>(s.threads);
  grid.m.assign(grid.size(), 0.0);
  std::vector<Vec3> momentum(grid.size(), Vec3::Zero());
  for (std::size_t t = 0; t < threads; ++t) {
    std::vector<double> m(grid.size(), 0.0);
    std::vector<Vec3> mv(grid.size(), Vec3::Zero());
    for (std::size_t p = n * t / threads; p < n * (t + 1) / threads; ++p) scatter(s, p, 1, m, mv);
    for (std::size_t i = 0; i < grid.size(); ++i) grid.m[i] += m[i], momentum[i] += mv[i];
  }
  divide(grid, momentum);
}

void add_grid_mutants(std::vector<Mutant>& list) {
  add_rasterize(list);
  add_volumes(list);
  add_grid_velocities(list);
}

}  // namespace firn::mutants
