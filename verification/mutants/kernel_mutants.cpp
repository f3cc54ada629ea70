// SPDX-License-Identifier: BSD-3-Clause
/// Mistakes in the weights, which every stage between particles and grid uses: 1, 2, 3, 7, 8.

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "reference/constitutive.hpp"
#include "reference/kernel.hpp"
#include "verification/mutants/stages.hpp"

namespace firn::mutants {

namespace {

/// What may be wrong about w_ip = N(X) N(Y) N(Z), X = (x_p − x_i)/h.
struct Kernel {
  std::function<double(double X)> N = reference::N, dN = reference::dN;
  std::function<double(double X)> cell = [](double X) { return std::floor(X); };
  double shift = 0;            ///< of the nodes against their places, in cells
  double gradient_factor = 0;  ///< ∇w in units of N'; 0: 1/h
  double dropped_below = 0;    ///< weights smaller than this do not count
  bool wraps = true, uses_origin = true;
};

struct NodeWeight {
  NodeIndex node;
  double w;
  Vec3 grad_w;
};

std::vector<NodeWeight> weights(const Kernel& kernel, const Scene& scene, const Vec3& x_p) {
  const double h = scene.grid.spacing;
  const Vec3 origin = kernel.uses_origin ? scene.grid.origin : Vec3(Vec3::Zero());
  const Vec3 X = (x_p - origin) / h - Vec3::Constant(kernel.shift);
  std::array<std::int32_t, 3> first;
  std::array<std::array<double, 4>, 3> N, dN;
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = X[static_cast<Eigen::Index>(a)];
    first[a] = static_cast<std::int32_t>(kernel.cell(x)) - 1;
    for (std::size_t k = 0; k < 4; ++k) {
      const double d = x - (first[a] + static_cast<double>(k));
      N[a][k] = kernel.N(d);
      dN[a][k] = kernel.dN(d) * (kernel.gradient_factor > 0 ? kernel.gradient_factor : 1 / h);
    }
  }
  std::vector<NodeWeight> result;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < 4; ++b)
      for (std::size_t c = 0; c < 4; ++c) {
        const double w = N[0][a] * N[1][b] * N[2][c];
        if (std::abs(w) < kernel.dropped_below) continue;
        std::array<std::int32_t, 3> n{first[0] + static_cast<std::int32_t>(a),
                                      first[1] + static_cast<std::int32_t>(b),
                                      first[2] + static_cast<std::int32_t>(c)};
        bool lost = false;
        for (int axis = 0; axis < 3; ++axis) {
          const int period = scene.grid.period_nodes(axis);
          std::int32_t& i = n[static_cast<std::size_t>(axis)];
          if (period == 0) continue;
          const std::int32_t inside = (i % period + period) % period;
          lost = lost || (!kernel.wraps && inside != i);
          i = inside;
        }
        if (lost) continue;
        result.push_back({{n[0], n[1], n[2]},
                          w,
                          {dN[0][a] * N[1][b] * N[2][c], N[0][a] * dN[1][b] * N[2][c],
                           N[0][a] * N[1][b] * dN[2][c]}});
      }
  return result;
}

/// Calls visit(i, w_ip, ∇w_ip).
template <class Visit>
void for_each_node(const Kernel& kernel, const Step& s, std::size_t p, Visit&& visit) {
  for (const NodeWeight& n : weights(kernel, s.scene, s.particles.x[p])) {
    const auto at = std::lower_bound(s.grid.node.begin(), s.grid.node.end(), n.node);
    visit(static_cast<std::size_t>(at - s.grid.node.begin()), n.w, n.grad_w);
  }
}

/// The right nodes and those that the wrong kernel reaches.
void find_nodes(const Kernel& kernel, const Step& s) {
  std::vector<NodeIndex>& node = s.grid.node;
  s.stencils.build(s.scene, s.particles, Stage::rasterize, node);
  for (const Vec3& x : s.particles.x)
    for (const NodeWeight& n : weights(kernel, s.scene, x)) node.push_back(n.node);
  std::sort(node.begin(), node.end());
  node.erase(std::unique(node.begin(), node.end()), node.end());
}

void rasterize(const Kernel& kernel, const Step& s) {
  Grid& grid = s.grid;
  grid.m.assign(grid.size(), 0.0);
  grid.v.assign(grid.size(), Vec3::Zero());
  for (std::size_t p = 0; p < s.particles.size(); ++p)
    for_each_node(kernel, s, p, [&](std::size_t i, double w_ip, const Vec3&) {
      grid.m[i] += s.particles.m[p] * w_ip;
      grid.v[i] += s.particles.m[p] * w_ip * s.particles.v[p];
    });
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (grid.m[i] != 0) grid.v[i] /= grid.m[i];
}

void volumes(const Kernel& kernel, const Step& s) {
  const double h = s.scene.grid.spacing;
  for (std::size_t p = 0; p < s.particles.size(); ++p) {
    if (s.particles.V_0[p] != 0) continue;
    double rho = 0;
    for_each_node(kernel, s, p, [&](std::size_t i, double w_ip, const Vec3&) {
      rho += s.grid.m[i] * w_ip / (h * h * h);
    });
    s.particles.V_0[p] = s.particles.m[p] / rho;
  }
}

void grid_forces(const Kernel& kernel, const Step& s) {
  s.grid.f.assign(s.grid.size(), Vec3::Zero());
  for (std::size_t p = 0; p < s.particles.size(); ++p) {
    const Mat3 V_tau =
        s.particles.V_0[p] *
        reference::kirchhoff_stress(reference::lame(material_of(s, p), s.particles.F_P[p]),
                                    s.particles.F_E[p]);
    for_each_node(kernel, s, p, [&](std::size_t i, double, const Vec3& grad_w_ip) {
      s.grid.f[i] -= V_tau * grad_w_ip;
    });
  }
}

/// The right stage, told that its nodes are at rest, does the return mapping.
void deformation(const Kernel& kernel, const Step& s, const StageFunction& right) {
  for (std::size_t p = 0; p < s.particles.size(); ++p) {
    Mat3 grad_v_p = Mat3::Zero();
    for_each_node(kernel, s, p, [&](std::size_t i, double, const Vec3& grad_w_ip) {
      grad_v_p += s.grid.v_new[i] * grad_w_ip.transpose();
    });
    s.particles.F_E[p] = (Mat3::Identity() + s.dt * grad_v_p) * s.particles.F_E[p];
  }
  std::vector<Vec3> v_new(s.grid.size(), Vec3::Zero());
  v_new.swap(s.grid.v_new);
  right(s);
  v_new.swap(s.grid.v_new);
}

void particle_velocities(const Kernel& kernel, const Step& s) {
  const double alpha = s.scene.flip;
  for (std::size_t p = 0; p < s.particles.size(); ++p) {
    Vec3 v_PIC = Vec3::Zero(), change = Vec3::Zero();
    for_each_node(kernel, s, p, [&](std::size_t i, double w_ip, const Vec3&) {
      v_PIC += s.grid.v_new[i] * w_ip;
      change += (s.grid.v_new[i] - s.grid.v[i]) * w_ip;
    });
    s.particles.v[p] = (1 - alpha) * v_PIC + alpha * (s.particles.v[p] + change);
  }
}

/// The right stages keep numbers of nodes in `stencils`, which do not fit the longer list of
/// nodes here: 6 is not patched and runs explicitly, the others run as above.
Patch with_kernel(Kernel kernel) {
  return [=](Stages& stages) {
    const StageFunction deform = stages[Stage::deformation];
    stages.find_nodes = [=](const Step& s) { find_nodes(kernel, s); };
    stages[Stage::rasterize] = [=](const Step& s) { rasterize(kernel, s); };
    stages[Stage::volumes] = [=](const Step& s) { volumes(kernel, s); };
    stages[Stage::grid_forces] = [=](const Step& s) { grid_forces(kernel, s); };
    stages[Stage::integration] = [=](const Step& s) { s.grid.v_new = s.grid.v_star; };
    stages[Stage::deformation] = [=](const Step& s) { deformation(kernel, s, deform); };
    stages[Stage::particle_velocities] = [=](const Step& s) { particle_velocities(kernel, s); };
  };
}

/// The cubic as it is printed, without its factored form.
double printed_N(double x) {
  const double d = std::abs(x);
  if (d < 1) return d * d * d / 2 - d * d + 2.0 / 3;
  if (d < 2) return -d * d * d / 6 + d * d - 2 * d + 4.0 / 3;
  return 0;
}

double quadratic_N(double x) {
  const double d = std::abs(x);
  if (d < 0.5) return 0.75 - d * d;
  if (d < 1.5) return 0.5 * (1.5 - d) * (1.5 - d);
  return 0;
}

double quadratic_dN(double x) {
  const double d = std::abs(x);
  if (d < 0.5) return -2 * x;
  if (d < 1.5) return x > 0 ? d - 1.5 : 1.5 - d;
  return 0;
}

/// N' as if the kernel depended on |x|: the sign is gone.
double unsigned_dN(double x) { return reference::dN(std::abs(x)); }

}  // namespace

void add_kernel_mutants(std::vector<Mutant>& list) {
  Adder add(list, Stage::rasterize);
  const auto kernel = [&](const char* name, const char* mistake, const char* origin,
                          auto change) -> Mutant& {
    Kernel k;
    change(k);
    Mutant& mutant = add(name, mistake, origin, with_kernel(k));
    mutant.several = true;
    return mutant;
  };
  kernel("kernel_as_printed",
         "N evaluated as the printed polynomial: no relative accuracy near |x| = 2",
         "as it stands in the paper", [](Kernel& k) { k.N = printed_N; })
      .needs = "a particle almost two cells from a light node";
  kernel("small_weights_dropped", "weights below 1e-4 are skipped: Σ w_ip is no longer 1", field,
         [](Kernel& k) { k.dropped_below = 1e-4; });
  kernel("truncation_for_floor", "the cell is (int)(x/h): wrong for negative coordinates",
         "a cast instead of floor",
         [](Kernel& k) { k.cell = [](double X) { return std::trunc(X); }; })
      .needs = "particles on both sides of the grid's origin";
  kernel("quadratic_kernel", "the quadratic B-spline instead of the cubic one",
         "the default of other codes", [](Kernel& k) { k.N = quadratic_N, k.dN = quadratic_dN; });
  kernel("nodes_at_cell_centres", "grid velocities live half a cell off the nodes",
         "two conventions in one code", [](Kernel& k) { k.shift = 0.5; });
  kernel("origin_ignored", "weights from x_p instead of x_p − origin", "the origin was always zero",
         [](Kernel& k) { k.uses_origin = false; })
      .needs = "a grid whose origin is not zero";
  kernel("seam_not_closed", "what a particle gives to nodes beyond a periodic seam is lost", slip,
         [](Kernel& k) { k.wraps = false; })
      .needs = "a periodic axis";
  Mutant& one_over_h =
      kernel("gradient_without_1_over_h", "∇w_ip = N' N N, in 1/cell instead of 1/m",
             "the formula is printed without it", [](Kernel& k) { k.gradient_factor = 1; });
  one_over_h.stage = Stage::grid_forces;
  Mutant& sign = kernel("gradient_sign_lost", "N'(x) = N'(|x|) without sign(x)",
                        "the kernel is written for |x|", [](Kernel& k) { k.dN = unsigned_dN; });
  sign.stage = Stage::grid_forces;
}

}  // namespace firn::mutants
