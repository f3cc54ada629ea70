// SPDX-License-Identifier: BSD-3-Clause
#include "firn/sampling.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "firn/error.hpp"
#include "firn/poisson.hpp"
#include "firn/random.hpp"

namespace firn {

namespace {

/// Cells of edge h/n that may hold a part of the shape: indices low … high on
/// the grid that starts at the scene's origin.
struct SubCells {
  double h = 0;
  int n = 1;
  Vec3 origin = Vec3::Zero();
  std::array<std::int64_t, 3> low{}, high{};

  /// Place in sub-cell i at fraction u of its edge: origin + h (i + u)/n.
  double place(int axis, std::int64_t i, double u) const {
    return origin[axis] + h * ((static_cast<double>(i) + u) / n);
  }
};

// One sub-cell is visited in some 50 ns; beyond this the scene means something else.
constexpr double largest_number_of_cells = 4e9;

SubCells sub_cells(const GridSettings& grid, const Bounds& bounds, int n) {
  SubCells cells{grid.spacing, n, grid.origin, {}, {}};
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = grid.spacing / n;
    // One more on either side: the quotient is rounded.
    const double low = std::floor((bounds.min[axis] - grid.origin[axis]) / size) - 1;
    const double high = std::floor((bounds.max[axis] - grid.origin[axis]) / size) + 1;
    count *= std::max(0.0, high - low + 1);
    if (!(count <= largest_number_of_cells && std::abs(low) < 0x1p31 && std::abs(high) < 0x1p31))
      throw InputError("body", "cells of the grid within its bounds", to_text(count),
                       "at most " + to_text(largest_number_of_cells));
    cells.low[axis] = static_cast<std::int64_t>(low);
    cells.high[axis] = static_cast<std::int64_t>(high);
  }
  return cells;
}

/// Visits the sub-cells with z fastest, then y, then x.
template <class Visit>
void for_each_cell(const SubCells& cells, Visit visit) {
  for (std::int64_t i = cells.low[0]; i <= cells.high[0]; ++i)
    for (std::int64_t j = cells.low[1]; j <= cells.high[1]; ++j)
      for (std::int64_t k = cells.low[2]; k <= cells.high[2]; ++k) visit(i, j, k);
}

/// n with n³ = particles_per_cell, or 0.
int cube_root(int particles_per_cell) {
  int n = 1;
  while (n * n * n < particles_per_cell) ++n;
  return n * n * n == particles_per_cell ? n : 0;
}

/// n³ points at the centres of the n³ sub-cells of every cell.
std::vector<Vec3> sample_lattice(const GridSettings& grid, const Body& body, const Bounds& bounds) {
  const int n = cube_root(body.particles_per_cell);
  if (n == 0)
    throw InputError("body", "particles_per_cell with sampling = \"lattice\"",
                     std::to_string(body.particles_per_cell), "a cube: 1, 8, 27, 64, …");
  const SubCells cells = sub_cells(grid, bounds, n);
  std::vector<Vec3> points;
  for_each_cell(cells, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const Vec3 x(cells.place(0, i, 0.5), cells.place(1, j, 0.5), cells.place(2, k, 0.5));
    if (contains(body.shape, x)) points.push_back(x);
  });
  return points;
}

/// One uniformly random point in each of the n³ sub-cells; where
/// particles_per_cell is no cube, that many uniform points in each cell.
std::vector<Vec3> sample_jittered(const GridSettings& grid, const Body& body,
                                  const Bounds& bounds) {
  const int n = cube_root(body.particles_per_cell);
  const SubCells cells = sub_cells(grid, bounds, n > 0 ? n : 1);
  const int draws = n > 0 ? 1 : body.particles_per_cell;
  std::vector<Vec3> points;
  for_each_cell(cells, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    for (int draw = 0; draw < draws; ++draw) {
      const auto random = [&](int axis) { return uniform(body.seed, {i, j, k, draw, axis}); };
      const Vec3 x(cells.place(0, i, random(0)), cells.place(1, j, random(1)),
                   cells.place(2, k, random(2)));
      if (contains(body.shape, x)) points.push_back(x);
    }
  });
  return points;
}

/// x^(1/3) by Newton's method: std::cbrt differs between C libraries.
double plain_cbrt(double x) {
  double root = std::max(x, 1.0);
  for (double last = 2 * root; root < last;) {
    last = root;
    root = (2 * root + x / (root * root)) / 3;
  }
  return root;
}

/// Blue noise with a mean of particles_per_cell points in h³, cut out of a
/// pattern that goes on beyond the shape, so that no layer forms at its surface.
std::vector<Vec3> sample_poisson(const GridSettings& grid, const Body& body, const Bounds& bounds) {
  const double radius = grid.spacing * plain_cbrt(poisson_disk_density / body.particles_per_cell);
  const SubCells cells = sub_cells(grid, bounds, 1);  // for its limit and its place in the world
  Bounds region = bounds;
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.periodic[axis] > 0) continue;
    region.min[axis] -= 3 * radius;
    region.max[axis] += 3 * radius;
  }
  const std::uint64_t seed = hash_words(body.seed, {cells.low[0], cells.low[1], cells.low[2]});
  std::vector<Vec3> points;
  for (const Vec3& x : poisson_disk(region, grid.periodic, radius, seed))
    if (contains(body.shape, x)) points.push_back(x);
  return points;
}

void require_extent_within_period(const GridSettings& grid, const Bounds& bounds) {
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = bounds.max[axis] - bounds.min[axis], period = grid.periodic[axis];
    // A box over the whole period may be longer by the rounding of its faces.
    if (period > 0 && extent > period + 1e-9 * grid.spacing)
      throw InputError("body", std::string("extent along the periodic axis ") + "xyz"[axis],
                       to_text(extent), "at most the period, " + to_text(period));
  }
}

std::vector<Vec3> sample_points(const GridSettings& grid, const Body& body) {
  const std::optional<Bounds> within = bounds(body.shape);
  if (!within) throw InputError("body", "shape", "half-space", "a bounded shape");
  if (!(within->min.array() <= within->max.array()).all()) return {};  // a solid of no points
  require_extent_within_period(grid, *within);
  switch (body.sampling) {
    case Sampling::lattice: return sample_lattice(grid, body, *within);
    case Sampling::jittered: return sample_jittered(grid, body, *within);
    case Sampling::poisson: return sample_poisson(grid, body, *within);
    case Sampling::from_file: break;
  }
  throw std::logic_error("sample_points: a body from a file has its particles");
}

Particles sample_body(const Scene& scene, const Body& body) {
  const std::vector<Vec3> points = sample_points(scene.grid, body);
  const double h = scene.grid.spacing;
  const double volume = h * h * h / body.particles_per_cell;
  const double mass = scene.materials.at(body.material).density * volume;
  const Vec3 c = center(body.shape);

  Particles particles;
  particles.resize(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    particles.x[p] = points[p];
    particles.v[p] = body.velocity + body.angular_velocity.cross(points[p] - c);
    particles.m[p] = mass;
    if (body.volumes == VolumeSource::exact) particles.V_0[p] = volume;
  }
  return particles;
}

Particles particles_from_file(const Body& body) {
  Particles particles = body.particles;
  for (Vec3& v : particles.v) v += body.velocity;
  return particles;
}

}  // namespace

Particles sample_bodies(const Scene& scene, std::vector<std::size_t>& counts) {
  Particles all;
  counts.clear();
  for (const Body& body : scene.bodies) {
    Particles particles =
        body.sampling == Sampling::from_file ? particles_from_file(body) : sample_body(scene, body);
    for (std::int32_t& material : particles.material) material = body.material;
    counts.push_back(particles.size());
    all.append(particles);
  }
  for (std::size_t p = 0; p < all.size(); ++p) {
    all.x[p] = scene.wrap(all.x[p]);
    all.id[p] = static_cast<std::int64_t>(p);
  }
  return all;
}

Particles sample_bodies(const Scene& scene) {
  std::vector<std::size_t> counts;
  return sample_bodies(scene, counts);
}

}  // namespace firn
