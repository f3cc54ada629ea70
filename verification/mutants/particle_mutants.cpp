// SPDX-License-Identifier: BSD-3-Clause
/// Stages 8 and 10: what the particles take from the grid, and where they go.

#include "reference/failure.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// v_PIC and the FLIP increment Σ (v_i^{n+1} − v_i^{old}) w_ip.
struct Gathered {
  Vec3 v_PIC = Vec3::Zero(), change = Vec3::Zero();
};

Gathered gather(const Step& s, std::size_t p, const std::vector<Vec3>& v_old) {
  Gathered g;
  s.stencils.for_each_node(p, [&](std::size_t i, double w_ip) {
    g.v_PIC += s.grid.v_new[i] * w_ip;
    g.change += (s.grid.v_new[i] - v_old[i]) * w_ip;
  });
  return g;
}

/// v_p from another mixture.
Patch with_blend(std::function<Vec3(double alpha, const Vec3& v_p, const Gathered&)> blend) {
  return around(Stage::particle_velocities, [=](const StageFunction&, const Step& s) {
    for (std::size_t p = 0; p < s.particles.size(); ++p)
      s.particles.v[p] = blend(s.scene.flip, s.particles.v[p], gather(s, p, s.grid.v));
  });
}

Patch with_flip(std::function<double(double)> alpha) {
  return in_other_scene(Stage::particle_velocities,
                        [=](Scene& scene, const Step&) { scene.flip = alpha(scene.flip); });
}

/// x_p before the step's move; the displacement is `move(s, p)`.
Patch with_move(std::function<Vec3(const Step&, std::size_t p)> move) {
  return around(Stage::positions, [=](const StageFunction&, const Step& s) {
    std::vector<Vec3> u;
    for (std::size_t p = 0; p < s.particles.size(); ++p) u.push_back(move(s, p));
    for (std::size_t p = 0; p < u.size(); ++p) {
      const Vec3 x = s.scene.wrap(s.particles.x[p] + u[p]);
      if (!reference::inside_domain(s.scene.grid, x))
        reference::fail_at_particle(Stage::positions, p, reference::outside_domain(x));
      s.particles.x[p] = x;
    }
  });
}

void add_velocities(std::vector<Mutant>& list) {
  Adder add(list, Stage::particle_velocities);
  add("flip_from_v_star", "v_FLIP = v_p + Σ (v_i^{n+1} − v_i*) w_ip: the increment is gone",
      "which velocity is the old one",
      around(Stage::particle_velocities, [](const StageFunction& right, const Step& s) {
        const std::vector<Vec3> v = s.grid.v;
        s.grid.v = s.grid.v_star;
        right(s);
        s.grid.v = v;
      }));
  add("all_pic", "α is ignored, v_p = v_PIC", slip, with_flip([](double) { return 0; })).needs =
      "α > 0";
  add("all_flip", "α is ignored, v_p = v_FLIP", slip, with_flip([](double) { return 1; })).needs =
      "α < 1";
  add("alpha_exchanged", "v_p = α v_PIC + (1 − α) v_FLIP", "which of the two is α",
      with_flip([](double a) { return 1 - a; }))
      .needs = "α other than ½";
  add("flip_on_top_of_pic", "v_FLIP = v_PIC + Σ (v_i^{n+1} − v_iⁿ) w_ip", slip,
      with_blend([](double alpha, const Vec3&, const Gathered& g) {
        return Vec3((1 - alpha) * g.v_PIC + alpha * (g.v_PIC + g.change));
      }))
      .needs = "α > 0";
  add("increment_from_the_particle", "v_FLIP = v_p + v_PIC − v_p: v_pⁿ taken for Σ v_iⁿ w_ip",
      "a shortcut that saves a gather",
      with_blend([](double, const Vec3&, const Gathered& g) { return g.v_PIC; }))
      .needs = "α > 0";
  add("gathered_at_the_new_position", "weights of step 8 at x_p + Δt v_p",
      "particles were moved before",
      around(Stage::particle_velocities, [](const StageFunction&, const Step& s) {
        Particles ahead = s.particles;
        for (std::size_t p = 0; p < ahead.size(); ++p)
          ahead.x[p] = s.scene.wrap(ahead.x[p] + s.dt * ahead.v[p]);
        Grid spread;
        reference::Stencils stencils;
        stencils.build(s.scene, ahead, Stage::particle_velocities, spread.node);
        spread.v.assign(spread.size(), Vec3::Zero());
        spread.v_new.assign(spread.size(), Vec3::Zero());
        for (std::size_t i = 0, j = 0; i < spread.size(); ++i) {
          while (j < s.grid.size() && s.grid.node[j] < spread.node[i]) ++j;
          if (j == s.grid.size() || !(s.grid.node[j] == spread.node[i])) continue;
          spread.v[i] = s.grid.v[j];
          spread.v_new[i] = s.grid.v_new[j];
        }
        reference::particle_velocities(s.scene, stencils, spread, ahead);
        s.particles.v = ahead.v;
      }));
}

void add_positions(std::vector<Mutant>& list) {
  Adder add(list, Stage::positions);
  add("moved_twice", "x_p += 2 Δt v_p", "advected in step 8 and again in step 10",
      with_move([](const Step& s, std::size_t p) { return Vec3(2 * s.dt * s.particles.v[p]); }));
  add("moved_with_the_grid", "x_p += Δt v_PIC, the habit of APIC and FLIP codes", field,
      with_move(
          [](const Step& s, std::size_t p) { return Vec3(s.dt * gather(s, p, s.grid.v).v_PIC); }));
  add("last_particle_left_behind", "the loop of step 10 ends one particle early", slip,
      around(Stage::positions, [](const StageFunction& right, const Step& s) {
        if (s.particles.size() == 0) return;
        const Vec3 x = s.particles.x.back();
        right(s);
        s.particles.x.back() = x;
      }));
  add("positions_in_float", "positions are kept in single precision",
      "a float left over from a graphics card", after(Stage::positions, [](const Step& s) {
        for (Vec3& x : s.particles.x) x = x.cast<float>().cast<double>();
      }));
  add("not_wrapped", "a particle that leaves a periodic domain is not brought back", slip,
      around(Stage::positions,
             [](const StageFunction& right, const Step& s) {
               const std::vector<Vec3> x = s.particles.x;
               right(s);
               for (std::size_t p = 0; p < x.size(); ++p)
                 s.particles.x[p] = x[p] + s.dt * s.particles.v[p];
             }))
      .needs = "a periodic axis";
}

}  // namespace

void add_particle_mutants(std::vector<Mutant>& list) {
  add_velocities(list);
  add_positions(list);
}

}  // namespace firn::mutants
