// SPDX-License-Identifier: BSD-3-Clause
#include "verification/mutants/stages.hpp"

#include "reference/time_step.hpp"

namespace firn::mutants {

namespace r = reference;

Stages reference_stages() {
  Stages stages;
  stages.find_nodes = [](const Step& s) {
    s.stencils.build(s.scene, s.particles, Stage::rasterize, s.grid.node);
  };
  stages[Stage::rasterize] = [](const Step& s) { r::rasterize(s.particles, s.stencils, s.grid); };
  stages[Stage::volumes] = [](const Step& s) {
    r::volumes(s.scene, s.stencils, s.grid, s.particles);
  };
  stages[Stage::grid_forces] = [](const Step& s) {
    r::grid_forces(s.scene, s.particles, s.stencils, s.grid);
  };
  stages[Stage::grid_velocities] = [](const Step& s) { r::grid_velocities(s.scene, s.dt, s.grid); };
  stages[Stage::grid_collisions] = [](const Step& s) {
    r::grid_collisions(s.scene, s.time, s.grid);
  };
  stages[Stage::integration] = [](const Step& s) {
    const r::IntegrationReport solve =
        r::integration(s.scene, s.particles, s.stencils, s.dt, s.grid);
    s.report.solver_iterations = solve.iterations;
    s.report.solver_residual = solve.residual;
    s.report.solver_indefinite = solve.indefinite;
  };
  stages[Stage::deformation] = [](const Step& s) {
    r::deformation(s.scene, s.stencils, s.grid, s.dt, s.particles);
  };
  stages[Stage::particle_velocities] = [](const Step& s) {
    r::particle_velocities(s.scene, s.stencils, s.grid, s.particles);
  };
  stages[Stage::particle_collisions] = [](const Step& s) {
    r::particle_collisions(s.scene, s.time, s.particles);
  };
  stages[Stage::positions] = [](const Step& s) { r::positions(s.scene, s.dt, s.particles); };
  stages.choose_time_step = r::choose_time_step;
  return stages;
}

Patch around(Stage stage, std::function<void(const StageFunction&, const Step&)> change) {
  return [=](Stages& stages) {
    const StageFunction right = stages[stage];
    stages[stage] = [=](const Step& s) { change(right, s); };
  };
}

Patch after(Stage stage, StageFunction spoil) {
  return around(stage, [=](const StageFunction& right, const Step& s) {
    right(s);
    spoil(s);
  });
}

Patch in_other_scene(Stage stage, std::function<void(Scene&, const Step&)> change) {
  return around(stage, [=](const StageFunction& right, const Step& s) {
    Scene other = s.scene;
    change(other, s);
    right({other, s.time, s.dt, s.threads, s.particles, s.stencils, s.grid, s.report});
  });
}

Patch with_other_colliders(Stage stage, std::function<void(Collider&)> change) {
  return in_other_scene(stage, [=](Scene& scene, const Step&) {
    for (Collider& collider : scene.colliders) change(collider);
  });
}

Patch from_other_particles(Stage stage, std::function<void(Particles&, const Step&)> change) {
  return around(stage, [=](const StageFunction& right, const Step& s) {
    Particles other = s.particles;
    change(other, s);
    right({s.scene, s.time, s.dt, s.threads, other, s.stencils, s.grid, s.report});
  });
}

Mutant& Adder::operator()(const char* name, const char* mistake, const char* origin, Patch patch) {
  list_.push_back({name, stage_, false, mistake, origin, "", true, std::move(patch)});
  return list_.back();
}

Mat3 velocity_gradient(const Step& s, std::size_t p, const std::vector<Vec3>& v) {
  Mat3 grad_v_p = Mat3::Zero();
  s.stencils.for_each_node_with_gradient(p, [&](std::size_t i, double, const Vec3& grad_w_ip) {
    grad_v_p += v[i] * grad_w_ip.transpose();
  });
  return grad_v_p;
}

}  // namespace firn::mutants
