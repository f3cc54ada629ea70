// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/stencil.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace firn::check {

namespace {

// A position that is uncertain by half a cell says nothing any more; beyond, the
// bounds stay at this value (float further than 4 million cells from the origin).
constexpr double largest_t_error = 0.49;

/// Σ of 1, x, … along one axis: candidate nodes first … first+count−1.
struct Axis {
  int first = 0, count = 0;
  std::array<double, 5> N{}, N_error{};    // N(d), bound of its error
  std::array<double, 5> dN{}, dN_error{};  // N'(t − i) with its sign
};

/// The cubic B-spline N(d) and its derivative for d ≥ 0, in the factored form that
/// keeps relative accuracy at the edge of the support.
double N(double d) {
  if (d < 1) return d * d * (0.5 * d - 1) + 2.0 / 3.0;
  const double s = std::max(0.0, 2 - d);
  return s * s * s / 6;
}
double N_slope(double d) {
  if (d < 1) return d * (1.5 * d - 2);
  const double s = std::max(0.0, 2 - d);
  return -0.5 * s * s;
}

/// Upper bounds of |N'|, |N''| anywhere in [d − e, d + e]: |N''| ≤ 2 inside, and
/// ≤ 2 − d + e on the outer branch, where it goes to zero with the weight itself.
double curvature_bound(double d, double e) { return d - e < 1 ? 2.0 : std::max(0.0, 2 - d + e); }
double slope_bound(double d, double e) { return std::abs(N_slope(d)) + e * curvature_bound(d, e); }

/// |N''(d)| plus what e ≤ ½ changes of it: |N'''| ≤ 3.
double local_curvature(double d, double e) {
  const double at_d = d < 1 ? std::abs(3 * d - 2) : std::max(0.0, 2 - d);
  return std::min(at_d + 3 * e, curvature_bound(d, e));
}

int first_candidate(double t, double e) { return static_cast<int>(std::ceil(t - 2 - e)); }
int candidate_count(double t, double e) {
  return static_cast<int>(std::floor(t + 2 + e)) - first_candidate(t, e) + 1;
}

Axis axis_around(double t, double e) {
  Axis axis;
  axis.first = first_candidate(t, e);
  axis.count = candidate_count(t, e);
  for (int a = 0; a < axis.count; ++a) {
    const double signed_d = t - (axis.first + a);
    const double d = std::abs(signed_d);
    const auto k = static_cast<std::size_t>(a);
    axis.N[k] = N(d);
    axis.N_error[k] = e * slope_bound(d, e);
    axis.dN[k] = signed_d < 0 ? -N_slope(d) : N_slope(d);
    axis.dN_error[k] = e * local_curvature(d, e);
  }
  return axis;
}

struct NodeHash {
  std::size_t operator()(const NodeIndex& n) const {
    std::uint64_t key = static_cast<std::uint32_t>(n.i);
    key = key * 0x9E3779B97F4A7C15u + static_cast<std::uint32_t>(n.j);
    key = key * 0x9E3779B97F4A7C15u + static_cast<std::uint32_t>(n.k);
    return static_cast<std::size_t>(key ^ (key >> 29));
  }
};

std::int32_t wrapped(int index, int period) {
  if (period == 0) return index;
  const int rest = index % period;
  return rest < 0 ? rest + period : rest;
}

}  // namespace

Stencils::Stencils(const Scene& scene, const Particles& particles, const Grid& grid,
                   const std::vector<Vec3>& x_error, double tiny)
    : x_(particles.x),
      m_(particles.m),
      origin_(scene.grid.origin),
      h_(scene.grid.spacing),
      tiny_(tiny) {
  std::unordered_map<NodeIndex, std::int32_t, NodeHash> place;
  place.reserve(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i)
    place.emplace(grid.node[i], static_cast<std::int32_t>(i));
  const int period[3] = {scene.grid.period_nodes(0), scene.grid.period_nodes(1),
                         scene.grid.period_nodes(2)};

  std::vector<NodeIndex> stray;
  std::vector<StencilNode> nodes;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec3 t = (particles.x[p] - origin_) / h_;
    // (x − o)/h costs three roundings of size |t| in either solver, the distance
    // t − i one more of size ≤ 2; both are errors of the position.
    t_error_.push_back((x_error[p] / h_).cwiseMin(largest_t_error));
    first_.push_back(node_.size());
    stray.clear();
    int first[3], count[3];
    for (int a = 0; a < 3; ++a) {
      first[a] = first_candidate(t[a], t_error_[p][a]);
      count[a] = candidate_count(t[a], t_error_[p][a]);
    }
    for (int a = 0; a < count[0]; ++a)
      for (int b = 0; b < count[1]; ++b)
        for (int c = 0; c < count[2]; ++c) {
          const NodeIndex n{wrapped(first[0] + a, period[0]), wrapped(first[1] + b, period[1]),
                            wrapped(first[2] + c, period[2])};
          const auto it = place.find(n);
          node_.push_back(it == place.end() ? -1 : it->second);
          if (it == place.end()) stray.push_back(n);
        }
    if (stray.empty()) continue;
    around(p, nodes);
    auto next = stray.begin();
    for (const StencilNode& node : nodes)
      if (node.node < 0) stray_mass_[*next++] += particles.m[p] * (node.w + node.w_error);
  }
}

void Stencils::around(std::size_t p, std::vector<StencilNode>& out) const {
  const Vec3 t = (x_[p] - origin_) / h_;
  const Vec3& e = t_error_[p];
  const Axis X = axis_around(t[0], e[0]), Y = axis_around(t[1], e[1]), Z = axis_around(t[2], e[2]);
  out.resize(static_cast<std::size_t>(X.count) * static_cast<std::size_t>(Y.count) *
             static_cast<std::size_t>(Z.count));
  const std::int32_t* node = node_.data() + first_[p];
  // Products below the smallest normal number may be flushed to zero, in w_ip itself
  // or in m_p w_ip.
  const double flushed = tiny_ * (1 + 1 / m_[p]);
  std::size_t at = 0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(X.count); ++a)
    for (std::size_t b = 0; b < static_cast<std::size_t>(Y.count); ++b)
      for (std::size_t c = 0; c < static_cast<std::size_t>(Z.count); ++c, ++at) {
        StencilNode& s = out[at];
        s.node = node[at];
        // Upper bounds of the factors, for products of errors of second order.
        const double x = X.N[a] + X.N_error[a], y = Y.N[b] + Y.N_error[b],
                     z = Z.N[c] + Z.N_error[c];
        s.w = X.N[a] * Y.N[b] * Z.N[c];
        s.w_error = X.N_error[a] * y * z + Y.N_error[b] * x * z + Z.N_error[c] * x * y + flushed;
        s.grad_w =
            Vec3(X.dN[a] * Y.N[b] * Z.N[c], X.N[a] * Y.dN[b] * Z.N[c], X.N[a] * Y.N[b] * Z.dN[c]) /
            h_;
        const double dx = std::abs(X.dN[a]) + X.dN_error[a], dy = std::abs(Y.dN[b]) + Y.dN_error[b],
                     dz = std::abs(Z.dN[c]) + Z.dN_error[c];
        const Vec3 error(X.dN_error[a] * y * z + dx * (Y.N_error[b] * z + Z.N_error[c] * y),
                         Y.dN_error[b] * x * z + dy * (X.N_error[a] * z + Z.N_error[c] * x),
                         Z.dN_error[c] * x * y + dz * (X.N_error[a] * y + Y.N_error[b] * x));
        s.grad_w_error = error.norm() / h_ + flushed / h_;
      }
}

}  // namespace firn::check
