// SPDX-License-Identifier: BSD-3-Clause
/// Stage 3: constitutive law and forces.

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "reference/constitutive.hpp"
#include "reference/failure.hpp"
#include "reference/polar.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

using reference::Lame;

/// f_i = − Σ_p V_p0 τ_p ∇w_ip with a τ of one's own.
using Stress = std::function<Mat3(const Step&, std::size_t p)>;

Patch with_stress(Stress stress) {
  return around(Stage::grid_forces, [=](const StageFunction&, const Step& s) {
    s.grid.f.assign(s.grid.size(), Vec3::Zero());
    for (std::size_t p = 0; p < s.particles.size(); ++p) {
      const Mat3 V_tau = s.particles.V_0[p] * stress(s, p);
      if (!reference::finite(V_tau))
        reference::fail_at_particle(Stage::grid_forces, p, "stress is not finite");
      s.stencils.for_each_node_with_gradient(p, [&](std::size_t i, double, const Vec3& grad_w_ip) {
        s.grid.f[i] -= V_tau * grad_w_ip;
      });
    }
  });
}

/// τ = 2μ(F − R)Fᵀ + λ(J − 1)J I from parts that may be wrong.
Mat3 tau(const Lame& l, const Mat3& F, const Mat3& R, double pressure) {
  return 2 * l.mu * (F - R) * F.transpose() + l.lambda * pressure * Mat3::Identity();
}

Patch with_lame(std::function<Lame(const Material&, const Mat3& F_E, const Mat3& F_P)> lame) {
  return with_stress([=](const Step& s, std::size_t p) {
    const Mat3& F_E = s.particles.F_E[p];
    return reference::kirchhoff_stress(lame(material_of(s, p), F_E, s.particles.F_P[p]), F_E);
  });
}

Patch with_rotation(std::function<Mat3(const Mat3&)> rotation) {
  return with_stress([=](const Step& s, std::size_t p) {
    const Mat3& F = s.particles.F_E[p];
    const double J = F.determinant();
    return tau(reference::lame(material_of(s, p), s.particles.F_P[p]), F, rotation(F), (J - 1) * J);
  });
}

Patch with_pressure(std::function<double(double J_E, double J_P)> pressure) {
  return with_stress([=](const Step& s, std::size_t p) {
    const Mat3 &F = s.particles.F_E[p], &F_P = s.particles.F_P[p];
    return tau(reference::lame(material_of(s, p), F_P), F, reference::rotation(F),
               pressure(F.determinant(), F_P.determinant()));
  });
}

/// R = F C^{-1/2}, C = FᵀF, by Sylvester's formula Σ_k λ_k^{-1/2} Π_{j≠k} (C − λ_j)/(λ_k − λ_j):
/// divides by zero where two singular values agree, as in F = I.
Mat3 rotation_by_sylvester(const Mat3& F) {
  const Mat3 C = F.transpose() * F;
  const Vec3 l = Eigen::SelfAdjointEigenSolver<Mat3>(C, Eigen::EigenvaluesOnly).eigenvalues();
  Mat3 root = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    Mat3 term = Mat3::Identity() / std::sqrt(l[k]);
    for (int j = 0; j < 3; ++j)
      if (j != k) term = term * (C - l[j] * Mat3::Identity()) / (l[k] - l[j]);
    root += term;
  }
  return F * root;
}

/// U Vᵀ as a library returns them: a reflection where det F < 0.
Mat3 unsigned_rotation(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> usv(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return usv.matrixU() * usv.matrixV().transpose();
}

/// Two Newton steps ½(R + R^{-T}) from F, enough for elastic snow and for nothing else.
Mat3 two_newton_steps(const Mat3& F) {
  Mat3 R = F;
  for (int step = 0; step < 2; ++step) R = 0.5 * (R + R.inverse().transpose().eval());
  return R;
}

void add_laws(Adder& add) {
  const auto scaled = [](const Material& m, double on_mu, double on_lambda) {
    return Lame{m.mu_0() * on_mu, m.lambda_0() * on_lambda};
  };
  add("hardening_dropped", "μ_0 and λ_0 are used as they are, whatever F_P", slip,
      with_lame([=](const Material& m, const Mat3&, const Mat3&) { return scaled(m, 1, 1); }))
      .needs = "particles with J_P other than 1";
  add("hardening_sign", "e^{ξ(J_P − 1)}: compressed snow softens", slip,
      with_lame([=](const Material& m, const Mat3&, const Mat3& F_P) {
        const double e = std::exp(m.hardening * (F_P.determinant() - 1));
        return scaled(m, e, e);
      }))
      .needs = "particles with J_P other than 1";
  add("hardening_by_J_E", "e^{ξ(1 − J_E)}: the elastic volume change instead of the plastic one",
      slip, with_lame([=](const Material& m, const Mat3& F_E, const Mat3&) {
        const double e = std::exp(m.hardening * (1 - F_E.determinant()));
        return scaled(m, e, e);
      }));
  add("hardening_of_mu_only", "λ = λ_0 is not hardened", slip,
      with_lame([=](const Material& m, const Mat3&, const Mat3& F_P) {
        return scaled(m, reference::hardening(m, F_P), 1);
      }))
      .needs = "particles with J_P other than 1";
  add("lame_parameters_swapped", "μ and λ in each other's place", slip,
      with_lame([](const Material& m, const Mat3&, const Mat3& F_P) {
        const Lame l = reference::lame(m, F_P);
        return Lame{l.lambda, l.mu};
      }));
  add("lambda_of_plane_stress", "λ_0 = Eν/(1 − ν²), the formula of a thin sheet",
      "2D formulas in a 3D code", with_lame([](const Material& m, const Mat3&, const Mat3& F_P) {
        const double e = reference::hardening(m, F_P), nu = m.poisson_ratio;
        return Lame{m.mu_0() * e, m.youngs_modulus * nu / (1 - nu * nu) * e};
      }));
  add("two_mu_without_two", "P = μ(F_E − R_E) + …: the 2 of the derivative of the square", slip,
      with_lame([](const Material& m, const Mat3&, const Mat3& F_P) {
        const Lame l = reference::lame(m, F_P);
        return Lame{l.mu / 2, l.lambda};
      }));
  add("material_of_particle_zero", "every particle has the parameters of the first material",
      "written for one material", with_stress([](const Step& s, std::size_t p) {
        return reference::kirchhoff_stress(
            reference::lame(s.scene.materials.front(), s.particles.F_P[p]), s.particles.F_E[p]);
      }))
      .needs = "two materials";
}

void add_tensors(Adder& add) {
  add("J_for_J_E", "λ(J − 1)J with J = J_E J_P", "both are called J",
      with_pressure([](double J_E, double J_P) {
        const double J = J_E * J_P;
        return (J - 1) * J;
      }))
      .needs = "particles with J_P other than 1";
  add("pressure_without_J", "λ(J_E − 1) I: the factor J_E of P F_Eᵀ is gone", "P and σ confused",
      with_pressure([](double J_E, double) { return J_E - 1; }));
  add("logarithmic_pressure", "λ log J_E, the law of another material",
      "a neo-Hookean code changed half-way",
      with_pressure([](double J_E, double) { return J_E > 0 ? std::log(J_E) : 0; }));
  add("rotation_left_out", "R_E = I: linear elasticity", "right until something turns",
      with_rotation([](const Mat3&) { return Mat3(Mat3::Identity()); }));
  add("rotation_by_sylvester", "R_E from distinct eigenvalues: 0/0 where two agree, as in F_E = I",
      field, with_rotation(rotation_by_sylvester))
      .needs = "a particle with F_E = I";
  add("reflection_for_rotation", "R_E = U Vᵀ without looking at det F_E < 0",
      "taken as a library returns it", with_rotation(unsigned_rotation))
      .needs = "a particle with det F_E < 0";
  add("two_newton_steps_for_rotation",
      "R_E by a fixed number of iterations, too few for large strains",
      "tested on elastic snow only", with_rotation(two_newton_steps));
  add("F_E_transposed_in_stress", "the stress is that of F_Eᵀ",
      "row-major and column-major matrices",
      from_other_particles(Stage::grid_forces, [](Particles& p, const Step&) {
        for (Mat3& F_E : p.F_E) F_E.transposeInPlace();
      }));
  add("piola_for_kirchhoff", "f_i = −Σ V_p0 P_p ∇w_ip: the factor F_Eᵀ is missing", slip,
      with_stress([](const Step& s, std::size_t p) {
        return reference::piola_stress(reference::lame(material_of(s, p), s.particles.F_P[p]),
                                       s.particles.F_E[p]);
      }));
  add("J_counted_twice", "V_p = J_E V_p0 together with the Kirchhoff stress",
      "V_p σ_p = J V_p0 σ_p was applied after the J had cancelled",
      with_stress([](const Step& s, std::size_t p) {
        const Mat3& F_E = s.particles.F_E[p];
        return Mat3(F_E.determinant() *
                    reference::kirchhoff_stress(
                        reference::lame(material_of(s, p), s.particles.F_P[p]), F_E));
      }));
  add("force_sign", "f_i = +Σ V_p0 P_p F_Eᵀ ∇w_ip", slip,
      after(Stage::grid_forces, [](const Step& s) {
        for (Vec3& f : s.grid.f) f = -f;
      }));
  add("forces_in_float", "forces are summed in single precision",
      "a float left over from a graphics card", after(Stage::grid_forces, [](const Step& s) {
        for (Vec3& f : s.grid.f) f = f.cast<float>().cast<double>();
      }));
}

}  // namespace

void add_stress_mutants(std::vector<Mutant>& list) {
  Adder add(list, Stage::grid_forces);
  add_laws(add);
  add_tensors(add);
}

}  // namespace firn::mutants
