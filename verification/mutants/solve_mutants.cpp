// SPDX-License-Identifier: BSD-3-Clause
/// Stage 6: integration, most of all the semi-implicit solve.

#include <Eigen/LU>
#include <cmath>

#include "reference/constitutive.hpp"
#include "reference/minres.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

using reference::NodeField;

/// The parts of the operator B = I + βΔt² M⁻¹H that can be got wrong.
struct Operator {
  std::function<Mat3(const reference::Lame&, const Mat3& F_E, const Mat3& dF)> dP;
  double beta_dt2 = 0;
  bool divided_by_mass = true;
};

Mat3 right_dP(const reference::Lame& lame, const Mat3& F_E, const Mat3& dF) {
  return reference::StressDifferential(lame, F_E)(dF);
}

NodeField apply(const Operator& B, const Step& s, const NodeField& u) {
  NodeField Hu(u.size(), Vec3::Zero());
  for (std::size_t p = 0; p < s.particles.size(); ++p) {
    const Mat3& F_E = s.particles.F_E[p];
    const reference::Lame lame = reference::lame(material_of(s, p), s.particles.F_P[p]);
    const Mat3 V_A_FT =
        s.particles.V_0[p] * B.dP(lame, F_E, velocity_gradient(s, p, u) * F_E) * F_E.transpose();
    s.stencils.for_each_node_with_gradient(
        p, [&](std::size_t i, double, const Vec3& grad_w_ip) { Hu[i] += V_A_FT * grad_w_ip; });
  }
  for (std::size_t i = 0; i < u.size(); ++i)
    Hu[i] = s.grid.m[i] > 0
                ? Vec3(u[i] + B.beta_dt2 * Hu[i] / (B.divided_by_mass ? s.grid.m[i] : 1))
                : Vec3(Vec3::Zero());
  return Hu;
}

void solve(const Operator& B, const Step& s, std::int64_t max_iterations) {
  Grid& grid = s.grid;
  const auto projected = [&](const NodeField& u) {
    NodeField Bu = apply(B, s, u);
    for (std::size_t i = 0; i < u.size(); ++i) Bu[i] = grid.free_directions[i] * Bu[i];
    return Bu;
  };
  grid.v_new = grid.v_star;
  NodeField r = grid.v_star;
  reference::add_scaled(-1, apply(B, s, grid.v_new), r);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = grid.free_directions[i] * r[i];
  const double target = s.scene.integrator.tolerance *
                        std::sqrt(reference::inner_product(grid.m, grid.v_star, grid.v_star));
  s.report.solver_iterations =
      reference::minres(projected, grid.m, r, target, max_iterations, grid.v_new).iterations;
  s.report.solver_residual = s.scene.integrator.tolerance;
}

Patch with_operator(std::function<void(Operator&, const Step&)> change,
                    std::int64_t max_iterations = 0) {
  return around(Stage::integration, [=](const StageFunction& right, const Step& s) {
    if (!s.scene.semi_implicit()) return right(s);
    Operator B;
    B.dP = right_dP;
    B.beta_dt2 = s.scene.integrator.implicitness * s.dt * s.dt;
    change(B, s);
    solve(B, s, max_iterations > 0 ? max_iterations : s.scene.integrator.max_iterations);
  });
}

}  // namespace

void add_solve_mutants(std::vector<Mutant>& list) {
  Adder add(list, Stage::integration);
  add("forces_never_integrated", "v_i^{n+1} = v_i, the rasterized velocity", slip,
      around(Stage::integration,
             [](const StageFunction&, const Step& s) { s.grid.v_new = s.grid.v; }));
  const char* implicit = "a semi-implicit scene";
  add("solve_stopped_at_iteration_one",
      "the convergence test is always true after the first iteration", field,
      with_operator([](Operator&, const Step&) {}, 1))
      .needs = implicit;
  add("solve_not_started", "v_i^{n+1} = v_i* also where the scene is semi-implicit",
      "|r| compared with the wrong side",
      around(Stage::integration,
             [](const StageFunction&, const Step& s) { s.grid.v_new = s.grid.v_star; }))
      .needs = implicit;
  add("tolerance_squared", "‖r‖² is compared with the tolerance: stops at its square root", slip,
      in_other_scene(Stage::integration,
                     [](Scene& scene, const Step&) {
                       scene.integrator.tolerance = std::sqrt(scene.integrator.tolerance);
                     }))
      .needs = implicit;
  add("contact_not_held", "the solve moves nodes that contact holds",
      "collisions only before the solve",
      around(Stage::integration,
             [](const StageFunction& right, const Step& s) {
               const std::vector<Mat3> free = s.grid.free_directions;
               for (Mat3& P : s.grid.free_directions) P.setIdentity();
               right(s);
               s.grid.free_directions = free;
             }))
      .needs = "a semi-implicit scene with a collider";
  add("delta_R_dropped", "A = 2μ δF + …: the rotation is taken to be fixed", "the hardest term",
      with_operator([](Operator& B, const Step&) {
        B.dP = [](const reference::Lame& lame, const Mat3& F_E, const Mat3& dF) {
          const reference::StressDifferential dP(lame, F_E);
          return Mat3(dP(dF) + 2 * lame.mu * dP.rotation_differential(dF));
        };
      }))
      .needs = implicit;
  add("delta_cofactor_dropped", "A lacks λ(J_E − 1) δ(J F^{-T})", "small as long as J_E is near 1",
      with_operator([](Operator& B, const Step&) {
        B.dP = [](const reference::Lame& lame, const Mat3& F_E, const Mat3& dF) {
          return Mat3(right_dP(lame, F_E, dF) - lame.lambda * (F_E.determinant() - 1) *
                                                    reference::cofactor_differential(F_E, dF));
        };
      }))
      .needs = implicit;
  add("beta_dt_not_squared", "B = I + βΔt M⁻¹H", slip,
      with_operator([](Operator& B, const Step& s) { B.beta_dt2 /= s.dt; }))
      .needs = implicit;
  add("implicitness_ignored", "β = 1 whatever the scene says", "the paper's examples take 1",
      with_operator([](Operator& B, const Step& s) { B.beta_dt2 = s.dt * s.dt; }))
      .needs = "a semi-implicit scene with β < 1";
  add("stiffness_not_divided_by_mass", "B = I + βΔt² H", slip,
      with_operator([](Operator& B, const Step&) { B.divided_by_mass = false; }))
      .needs = implicit;
}

}  // namespace firn::mutants
