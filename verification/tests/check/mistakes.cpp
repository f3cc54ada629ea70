// SPDX-License-Identifier: BSD-3-Clause
#include "verification/tests/check/mistakes.hpp"

#include <Eigen/LU>
#include <limits>

namespace firn::test {

namespace {

/// The stage run by the reference on another input or in another scene.
State rerun(const Scene& scene, const State& input, Stage stage, double dt) {
  const auto solver = make_reference();
  State result;
  solver->load(scene, input);
  solver->advance_through(stage, dt);
  solver->store(result);
  return result;
}

/// `change` applied to every collider before the stage runs.
template <class Change>
Mistake with_other_colliders(Stage stage, Change change) {
  return [=](const StageRun& run) {
    Scene scene = run.scene;
    for (Collider& collider : scene.colliders) change(collider);
    run.after = rerun(scene, run.before, stage, run.dt);
  };
}

/// The stage sees particles on which `change` was applied, but gives back the right
/// particles: only what it writes to the grid is wrong.
template <class Change>
Mistake grid_from_other_particles(Stage stage, Change change) {
  return [=](const StageRun& run) {
    State other = run.before;
    change(other.particles, run);
    run.after.grid = rerun(run.scene, other, stage, run.dt).grid;
  };
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::vector<PlantedMistake> make_mistakes() {
  std::vector<PlantedMistake> all;
  const auto plant = [&](const char* name, Stage stage, Field field, Mistake apply) {
    all.push_back({name, stage, field, std::move(apply)});
  };

  plant("weights_of_the_wrong_time", Stage::rasterize, Field::node_mass,
        grid_from_other_particles(Stage::rasterize, [](Particles& p, const StageRun& run) {
          for (std::size_t q = 0; q < p.size(); ++q) p.x[q] += run.dt * p.v[q];
        }));
  plant("light_nodes_thresholded", Stage::rasterize, Field::node_mass, [](const StageRun& run) {
    for (double& m : run.after.grid.m)
      if (m < 1e-6) m = 0;
  });
  plant("momentum_not_divided", Stage::rasterize, Field::node_velocity, [](const StageRun& run) {
    Grid& grid = run.after.grid;
    for (std::size_t i = 0; i < grid.size(); ++i) grid.v[i] *= grid.m[i];
  });
  plant("one_node_velocity_nan", Stage::rasterize, Field::node_velocity,
        [](const StageRun& run) { run.after.grid.v[3][1] = not_a_number; });

  plant("cell_area_for_volume", Stage::volumes, Field::particle_volume, [](const StageRun& run) {
    for (double& V : run.after.particles.V_0) V *= run.scene.grid.spacing;
  });
  plant(
      "known_volumes_recomputed", Stage::volumes, Field::particle_volume, [](const StageRun& run) {
        State forgotten = run.before;
        for (double& V : forgotten.particles.V_0) V = 0;
        run.after.particles.V_0 = rerun(run.scene, forgotten, Stage::volumes, run.dt).particles.V_0;
      });

  plant("force_sign", Stage::grid_forces, Field::node_force, [](const StageRun& run) {
    for (Vec3& f : run.after.grid.f) f = -f;
  });
  plant("gradient_without_1_over_h", Stage::grid_forces, Field::node_force,
        [](const StageRun& run) {
          for (Vec3& f : run.after.grid.f) f *= run.scene.grid.spacing;
        });
  plant("F_E_transposed_in_stress", Stage::grid_forces, Field::node_force,
        grid_from_other_particles(Stage::grid_forces, [](Particles& p, const StageRun&) {
          for (Mat3& F_E : p.F_E) F_E.transposeInPlace();
        }));
  plant("hardening_dropped", Stage::grid_forces, Field::node_force,
        grid_from_other_particles(Stage::grid_forces, [](Particles& p, const StageRun&) {
          for (Mat3& F_P : p.F_P) F_P.setIdentity();
        }));

  plant("gravity_dropped_on_light_nodes", Stage::grid_velocities, Field::node_velocity_star,
        [](const StageRun& run) {
          Grid& grid = run.after.grid;
          for (std::size_t i = 0; i < grid.size(); ++i)
            if (grid.m[i] < 1e-6) grid.v_star[i] -= run.dt * run.scene.gravity;
        });
  plant("force_added_as_velocity", Stage::grid_velocities, Field::node_velocity_star,
        [](const StageRun& run) {
          Grid& grid = run.after.grid;
          for (std::size_t i = 0; i < grid.size(); ++i) grid.v_star[i] = grid.v[i] + grid.f[i];
        });

  plant("friction_sign", Stage::grid_collisions, Field::node_velocity_star,
        with_other_colliders(Stage::grid_collisions,
                             [](Collider& collider) { collider.friction = -collider.friction; }));
  plant("collider_velocity_forgotten", Stage::grid_collisions, Field::node_velocity_star,
        with_other_colliders(Stage::grid_collisions,
                             [](Collider& collider) { collider.angular_velocity.setZero(); }));
  plant("sticky_slides", Stage::grid_collisions, Field::node_velocity_star,
        with_other_colliders(Stage::grid_collisions,
                             [](Collider& collider) { collider.sticky = false; }));

  plant("forces_never_integrated", Stage::integration, Field::node_velocity_new,
        [](const StageRun& run) { run.after.grid.v_new = run.after.grid.v; });

  plant("velocity_gradient_transposed", Stage::deformation, Field::particle_F_E,
        [](const StageRun& run) {
          // Without limits F_E is (I + Δt ∇v) F_E: solve for ∇v, turn it over.
          Scene elastic = run.scene;
          for (Material& material : elastic.materials)
            material.critical_compression = material.critical_stretch =
                std::numeric_limits<double>::infinity();
          const Particles old = run.before.particles;
          const Particles grown = rerun(elastic, run.before, Stage::deformation, run.dt).particles;
          State turned = run.before;
          for (std::size_t q = 0; q < old.size(); ++q) {
            const Mat3 growth = grown.F_E[q] * old.F_E[q].inverse();
            turned.particles.F_E[q] = growth.transpose() * old.F_E[q];
          }
          for (Vec3& v : turned.grid.v_new) v.setZero();
          run.after = rerun(run.scene, turned, Stage::deformation, run.dt);
          run.after.grid = run.before.grid;
        });
  plant("nothing_ever_yields", Stage::deformation, Field::particle_F_E, [](const StageRun& run) {
    Scene elastic = run.scene;
    for (Material& material : elastic.materials)
      material.critical_compression = material.critical_stretch =
          std::numeric_limits<double>::infinity();
    run.after = rerun(elastic, run.before, Stage::deformation, run.dt);
  });
  plant("F_P_multiplied_in_wrong_order", Stage::deformation, Field::particle_F_P,
        [](const StageRun& run) {
          Particles& p = run.after.particles;
          for (std::size_t q = 0; q < p.size(); ++q) {
            const Mat3& old = run.before.particles.F_P[q];
            p.F_P[q] = old * (p.F_P[q] * old.inverse());
          }
        });

  plant("flip_with_v_star_as_old_velocity", Stage::particle_velocities, Field::particle_velocity,
        [](const StageRun& run) {
          State other = run.before;
          other.grid.v = other.grid.v_star;
          run.after = rerun(run.scene, other, Stage::particle_velocities, run.dt);
          run.after.grid.v = run.before.grid.v;
        });
  plant("all_pic", Stage::particle_velocities, Field::particle_velocity, [](const StageRun& run) {
    Scene scene = run.scene;
    scene.flip = 0;
    run.after = rerun(scene, run.before, Stage::particle_velocities, run.dt);
  });

  plant("particle_collisions_skipped", Stage::particle_collisions, Field::particle_velocity,
        [](const StageRun& run) { run.after.particles.v = run.before.particles.v; });

  plant("moved_twice", Stage::positions, Field::particle_position, [](const StageRun& run) {
    Particles& p = run.after.particles;
    for (std::size_t q = 0; q < p.size(); ++q) p.x[q] += run.dt * p.v[q];
  });
  plant("last_particle_left_behind", Stage::positions, Field::particle_position,
        [](const StageRun& run) { run.after.particles.x.back() = run.before.particles.x.back(); });
  plant("position_infinite", Stage::positions, Field::particle_position, [](const StageRun& run) {
    run.after.particles.x[17][2] = std::numeric_limits<double>::infinity();
  });
  return all;
}

}  // namespace

const std::vector<PlantedMistake>& planted_mistakes() {
  static const std::vector<PlantedMistake> mistakes = make_mistakes();
  return mistakes;
}

}  // namespace firn::test
