// SPDX-License-Identifier: BSD-3-Clause
/// Stage 7: deformation gradients and plasticity.

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/failure.hpp"
#include "reference/svd.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// F̂_E from a formula of one's own, then the right return mapping: the right stage with
/// nodes at rest, which leaves F̂_E = F_E.
Patch with_growth(std::function<Mat3(const Step&, std::size_t p)> F_E_hat) {
  return around(Stage::deformation, [=](const StageFunction& right, const Step& s) {
    std::vector<Mat3> grown;
    for (std::size_t p = 0; p < s.particles.size(); ++p) grown.push_back(F_E_hat(s, p));
    s.particles.F_E = grown;
    std::vector<Vec3> at_rest(s.grid.size(), Vec3::Zero());
    s.grid.v_new.swap(at_rest);
    right(s);
    s.grid.v_new.swap(at_rest);
  });
}

/// The right F̂_E, then a return mapping of one's own.
using Return = std::function<void(const Material&, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P)>;

Patch with_return(Return map) {
  return around(Stage::deformation, [=](const StageFunction&, const Step& s) {
    for (std::size_t p = 0; p < s.particles.size(); ++p) {
      const Mat3 F_E_hat =
          (Mat3::Identity() + s.dt * velocity_gradient(s, p, s.grid.v_new)) * s.particles.F_E[p];
      if (!reference::finite(F_E_hat))
        reference::fail_at_particle(Stage::deformation, p, "deformation gradient is not finite");
      map(material_of(s, p), F_E_hat, s.particles.F_E[p], s.particles.F_P[p]);
    }
  });
}

Vec3 clamped(const Vec3& sigma, double low, double high) {
  return sigma.cwiseMax(low).cwiseMin(high);
}

/// U clamp(Σ) Vᵀ and V f(Σ) Uᵀ F with pieces that may be wrong.
struct Clamped {
  reference::Svd usv;
  Vec3 sigma;
  Mat3 F;
  Mat3 F_E() const { return usv.U * sigma.asDiagonal() * usv.V.transpose(); }
  Mat3 F_P(const Vec3& s) const { return usv.V * s.asDiagonal() * usv.U.transpose() * F; }
};

Clamped clamp_right(const Material& m, const Mat3& F_E_hat, const Mat3& F_P) {
  Clamped c{reference::svd(F_E_hat), {}, F_E_hat * F_P};
  c.sigma = clamped(c.usv.sigma, m.smallest_elastic_stretch(), m.largest_elastic_stretch());
  return c;
}

/// A return mapping that leaves elastic particles alone, as the right one does.
Patch with_yield(std::function<void(const Clamped&, Mat3& F_E, Mat3& F_P)> yield) {
  return with_return([=](const Material& m, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P) {
    const Clamped c = clamp_right(m, F_E_hat, F_P);
    F_E = F_E_hat;
    if (c.sigma != c.usv.sigma) yield(c, F_E, F_P);
  });
}

/// Σ² and V from FᵀF, U = F V Σ⁻¹: loses half of the digits, all of them where σ_3 is small.
reference::Svd svd_of_normal_equations(const Mat3& F) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(F.transpose() * F);
  reference::Svd usv;
  for (int k = 0; k < 3; ++k) {
    usv.V.col(k) = eigen.eigenvectors().col(2 - k);
    usv.sigma[k] = std::sqrt(std::max(eigen.eigenvalues()[2 - k], 1e-30));
    usv.U.col(k) = F * usv.V.col(k) / usv.sigma[k];
  }
  return usv;
}

void add_growth(Adder& add) {
  const Mat3 I = Mat3::Identity();
  add("velocity_gradient_transposed", "∇v_p = Σ ∇w_ip v_iᵀ", "the order of an outer product",
      with_growth([=](const Step& s, std::size_t p) {
        return Mat3((I + s.dt * velocity_gradient(s, p, s.grid.v_new).transpose()) *
                    s.particles.F_E[p]);
      }));
  add("growth_on_the_wrong_side", "F̂_E = F_E (I + Δt ∇v_p)", slip,
      with_growth([=](const Step& s, std::size_t p) {
        return Mat3(s.particles.F_E[p] * (I + s.dt * velocity_gradient(s, p, s.grid.v_new)));
      }));
  add("growth_added_to_F_E", "F̂_E = F_E + Δt ∇v_p", "right as long as F_E is nearly I",
      with_growth([=](const Step& s, std::size_t p) {
        return Mat3(s.particles.F_E[p] + s.dt * velocity_gradient(s, p, s.grid.v_new));
      }));
  add("gradient_of_the_old_velocity", "∇v_p from v_iⁿ instead of v_i^{n+1}", slip,
      with_growth([=](const Step& s, std::size_t p) {
        return Mat3((I + s.dt * velocity_gradient(s, p, s.grid.v)) * s.particles.F_E[p]);
      }));
  add("only_the_symmetric_gradient", "the spin is left out: F grows by ½(∇v + ∇vᵀ)",
      "small-strain habits", with_growth([=](const Step& s, std::size_t p) {
        const Mat3 L = velocity_gradient(s, p, s.grid.v_new);
        return Mat3((I + 0.5 * s.dt * (L + L.transpose())) * s.particles.F_E[p]);
      }));
}

void add_return(Adder& add) {
  add("nothing_ever_yields", "no return mapping: F_E grows without limits", slip,
      in_other_scene(Stage::deformation,
                     [](Scene& scene, const Step&) {
                       for (Material& m : scene.materials)
                         m.critical_compression = m.critical_stretch =
                             std::numeric_limits<double>::infinity();
                     }))
      .needs = "particles that yield";
  add("limits_swapped", "Σ clamped to [1 − θ_s, 1 + θ_c]", "two thetas",
      in_other_scene(Stage::deformation,
                     [](Scene& scene, const Step&) {
                       for (Material& m : scene.materials)
                         std::swap(m.critical_compression, m.critical_stretch);
                     }))
      .needs = "particles that yield";
  add("limits_of_material_zero", "every particle yields as the first material does",
      "written for one material",
      in_other_scene(Stage::deformation,
                     [](Scene& scene, const Step&) {
                       for (Material& m : scene.materials) m = scene.materials.front();
                     }))
      .needs = "two materials";
  add("F_P_not_updated", "what is clamped off F_E is lost", slip,
      with_yield([](const Clamped& c, Mat3& F_E, Mat3&) { F_E = c.F_E(); }))
      .needs = "particles that yield";
  add("sigma_for_its_inverse", "F_P = V Σ Uᵀ F", slip,
      with_yield([](const Clamped& c, Mat3& F_E, Mat3& F_P) {
        F_E = c.F_E();
        F_P = c.F_P(c.sigma);
      }))
      .needs = "particles that yield";
  add("old_sigma_inverted", "F_P = V Σ̂⁻¹ Uᵀ F with the singular values before the clamp",
      "two Sigmas in one line", with_yield([](const Clamped& c, Mat3& F_E, Mat3& F_P) {
        F_E = c.F_E();
        F_P = c.F_P(c.usv.sigma.cwiseInverse());
      }))
      .needs = "particles that yield";
  add("U_and_V_exchanged", "F_E = V Σ Uᵀ", "which factor a library calls V",
      with_yield([](const Clamped& c, Mat3& F_E, Mat3& F_P) {
        F_P = c.F_P(c.sigma.cwiseInverse());
        F_E = c.F_E().transpose().eval();
      }))
      .needs = "particles that yield";
  add("F_P_in_the_wrong_order", "F_P = F_Pⁿ F_E⁻¹ F̂_E: the new part on the right", slip,
      with_yield([](const Clamped& c, Mat3& F_E, Mat3& F_P) {
        F_P = F_P * (c.F_E().inverse() * F_E);
        F_E = c.F_E();
      }))
      .needs = "particles that yield and have yielded before";
  add("plastic_part_rotated", "F_E = Σ in its own axes: the rotations were left out",
      "the energy does not see it", with_yield([](const Clamped& c, Mat3& F_E, Mat3& F_P) {
        F_P = c.usv.V * c.sigma.cwiseInverse().asDiagonal() * c.usv.U.transpose() * c.F;
        F_E = c.usv.V * c.sigma.asDiagonal() * c.usv.V.transpose();
      }))
      .needs = "particles that yield and are turned";
  add("largest_stretch_only", "only σ_1 is clamped", "tested in one dimension",
      with_return([](const Material& m, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P) {
        Clamped c = clamp_right(m, F_E_hat, F_P);
        const double sigma_1 = c.sigma[0];
        c.sigma = c.usv.sigma;
        c.sigma[0] = sigma_1;
        F_E = F_E_hat;
        if (c.sigma == c.usv.sigma) return;
        F_E = c.F_E();
        F_P = c.F_P(c.sigma.cwiseInverse());
      }))
      .needs = "particles that yield";
  add("svd_of_normal_equations",
      "Σ and V from F̂_EᵀF̂_E, U = F̂_E V Σ⁻¹: no accuracy where σ_3 is small",
      "the shortest way to write an SVD",
      with_return([](const Material& m, const Mat3& F_E_hat, Mat3& F_E, Mat3& F_P) {
        Clamped c{svd_of_normal_equations(F_E_hat), {}, F_E_hat * F_P};
        c.sigma = clamped(c.usv.sigma, m.smallest_elastic_stretch(), m.largest_elastic_stretch());
        F_E = F_E_hat;
        if (c.sigma == c.usv.sigma) return;
        F_E = c.F_E();
        F_P = c.F_P(c.sigma.cwiseInverse());
      }))
      .needs = "a particle with a singular or inverted F_E";
}

}  // namespace

void add_deformation_mutants(std::vector<Mutant>& list) {
  Adder add(list, Stage::deformation);
  add_growth(add);
  add_return(add);
}

}  // namespace firn::mutants
