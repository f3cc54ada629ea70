// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <set>

#include "firn/error.hpp"
#include "reference/grid_nodes.hpp"
#include "reference/kernel.hpp"
#include "reference/stencil.hpp"
#include "verification/tests/reference/scenes.hpp"

namespace firn::reference {
namespace {

struct Built {
  explicit Built(const Scene& scene, const std::vector<Vec3>& x) {
    particles.resize(x.size());
    particles.x = x;
    stencils.build(scene, particles, Stage::rasterize, node);
  }
  /// The nodes around particle p with their weights, in the order of the visits.
  std::vector<std::pair<NodeIndex, double>> around(std::size_t p) const {
    std::vector<std::pair<NodeIndex, double>> result;
    stencils.for_each_node(p,
                           [&](std::size_t i, double w_ip) { result.emplace_back(node[i], w_ip); });
    return result;
  }
  Particles particles;
  Stencils stencils;
  std::vector<NodeIndex> node;
};

TEST(Stencils, SixtyFourNodesAroundAParticle) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 1;
  const Built built(scene, {Vec3(0.5, 0.5, 0.5)});
  ASSERT_EQ(built.node.size(), 64u);
  EXPECT_EQ(built.node.front(), (NodeIndex{-1, -1, -1}));
  EXPECT_EQ(built.node.back(), (NodeIndex{2, 2, 2}));
  for (const auto& [n, w_ip] : built.around(0))
    EXPECT_DOUBLE_EQ(w_ip, N(0.5 - n.i) * N(0.5 - n.j) * N(0.5 - n.k));
}

/// floor, not truncation: −0.5 lies in the cell from −1 to 0.
TEST(Stencils, NegativeCoordinates) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 1;
  const Built built(scene, {Vec3(-0.5, -1, -7.25)});
  EXPECT_EQ(built.node.front(), (NodeIndex{-2, -2, -9}));
  EXPECT_EQ(built.node.back(), (NodeIndex{1, 1, -6}));
}

TEST(Stencils, PositionsAreRelativeToTheOrigin) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 0.5;
  scene.grid.origin = Vec3(10, 20, -30);
  const Built built(scene, {Vec3(10.25, 20.25, -29.75)});
  EXPECT_EQ(built.node.front(), (NodeIndex{-1, -1, -1}));
}

TEST(Stencils, NodesAreSortedAndUnique) {
  Scene scene = test::empty_scene();
  test::Random random(1);
  std::vector<Vec3> x;
  for (int i = 0; i < 300; ++i) x.push_back(random.vec3());
  x.push_back(Vec3(1e5, -1e5, 1e5));  // spread out: memory follows the particles, not the box
  x.push_back(x.front());             // coincident particles
  const Built built(scene, x);
  EXPECT_TRUE(std::is_sorted(built.node.begin(), built.node.end()));
  EXPECT_EQ(std::set<NodeIndex>(built.node.begin(), built.node.end()).size(), built.node.size());
  std::set<NodeIndex> touched;
  for (std::size_t p = 0; p < x.size(); ++p)
    for (const auto& [n, w_ip] : built.around(p)) touched.insert(n);
  EXPECT_EQ(touched.size(), built.node.size());
  EXPECT_EQ(built.around(0), built.around(x.size() - 1));
}

TEST(Stencils, PeriodicAxesWrapIndices) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 1;
  scene.grid.periodic = Vec3(4, 0, 5);
  const Built built(scene, {Vec3(0.5, 0.5, 4.5), Vec3(3.75, 0.5, 0.25)});
  for (std::size_t p = 0; p < 2; ++p) {
    std::set<NodeIndex> distinct;
    double sum = 0;
    for (const auto& [n, w_ip] : built.around(p)) {
      EXPECT_TRUE(n.i >= 0 && n.i < 4);
      EXPECT_TRUE(n.j >= -1 && n.j < 3);
      EXPECT_TRUE(n.k >= 0 && n.k < 5);
      distinct.insert(n);
      sum += w_ip;
    }
    EXPECT_EQ(distinct.size(), 64u);  // also where the period is as long as the stencil
    EXPECT_NEAR(sum, 1, 1e-15);
  }
  // The same particle one period away has the same neighbourhood.
  const Built shifted(scene, {Vec3(0.5 - 4, 0.5, 4.5 + 10)});
  EXPECT_EQ(shifted.around(0), built.around(0));
}

/// Crowds whose stencils overlap, also across the ends of a period: each of the 64 visits goes to
/// the node that it should, z fastest.
TEST(Stencils, VisitsGoToTheRightNodes) {
  for (const Vec3& period : {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 0, 5), Vec3(4, 6, 5)}) {
    Scene scene = test::empty_scene();
    scene.grid.spacing = 1;
    scene.grid.periodic = period;
    test::Random random(2);
    std::vector<Vec3> x;
    for (int i = 0; i < 200; ++i) x.push_back(3 * random.vec3());
    const Built built(scene, x);
    const auto wrapped = [&](double i, int axis) {
      const int n = scene.grid.period_nodes(axis), whole = static_cast<int>(i);
      return n == 0 ? whole : (whole % n + n) % n;
    };
    for (std::size_t p = 0; p < x.size(); ++p) {
      const Vec3 first = x[p].array().floor() - 1;
      std::size_t visit = 0;
      for (const auto& [n, w_ip] : built.around(p)) {
        const Vec3 i = first + Vec3(visit / 16, visit / 4 % 4, visit % 4);
        EXPECT_EQ(n, (NodeIndex{wrapped(i[0], 0), wrapped(i[1], 1), wrapped(i[2], 2)}));
        EXPECT_NEAR(w_ip, N(x[p][0] - i[0]) * N(x[p][1] - i[1]) * N(x[p][2] - i[2]), 1e-15);
        ++visit;
      }
    }
  }
}

TEST(Stencils, DomainEndsWhereIndicesDo) {
  Scene scene = test::empty_scene();
  scene.grid.spacing = 1;
  const double edge = 1 << 30;
  EXPECT_NO_THROW(Built(scene, {Vec3(edge, -edge, 0)}));
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double x : {edge + 1, -edge - 1, 1e300, -1e300, infinity, std::nan("")}) {
    try {
      Built(scene, {Vec3::Zero(), Vec3(0, x, 0)});
      FAIL() << x;
    } catch (const SimulationError& error) {
      EXPECT_EQ(error.stage(), Stage::rasterize);
      EXPECT_EQ(error.subject(), SimulationError::Subject::particle);
      EXPECT_EQ(error.index(), 1);
    }
  }
}

TEST(GridNodes, MasslessNodesComeAndGo) {
  Grid grid;
  grid.node = {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  grid.m = {0, 2, 0, 3};
  grid.v = {Vec3(9, 9, 9), Vec3(1, 0, 0), Vec3(9, 9, 9), Vec3(0, 1, 0)};
  EXPECT_EQ(nodes_of_positive_mass(grid), 2);
  Grid kept = grid;
  drop_massless_nodes(kept);
  EXPECT_EQ(kept.node, (std::vector<NodeIndex>{{0, 0, 1}, {1, 0, 0}}));
  EXPECT_EQ(kept.m, (std::vector<double>{2, 3}));
  EXPECT_EQ(kept.v, (std::vector<Vec3>{Vec3(1, 0, 0), Vec3(0, 1, 0)}));
  EXPECT_TRUE(kept.f.empty());

  const Grid spread = spread_over(grid.node, kept);
  EXPECT_EQ(spread.node, grid.node);
  EXPECT_EQ(spread.m, grid.m);
  EXPECT_EQ(spread.v[1], Vec3(1, 0, 0));
  EXPECT_EQ(spread.v[0], Vec3(0, 0, 0));
  EXPECT_TRUE(spread.f.empty());

  std::swap(kept.node[0], kept.node[1]);  // not sorted
  EXPECT_THROW(spread_over(grid.node, kept), InputError);
  kept.node = {{0, 0, 1}, {5, 5, 5}};  // a node that no particle reaches
  EXPECT_THROW(spread_over(grid.node, kept), InputError);
  kept.node = {{0, 0, 1}};  // values for more nodes than there are
  EXPECT_THROW(spread_over(grid.node, kept), InputError);
}

}  // namespace
}  // namespace firn::reference
