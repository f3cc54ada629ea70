// SPDX-License-Identifier: BSD-3-Clause
// Bodies filled with particles: counts and order by pencil, the same bits from
// every compiler, masses, volumes, velocities, periodic axes.

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <numbers>

#include "firn/error.hpp"
#include "firn/scene.hpp"

namespace firn {
namespace {

Scene scene_with(const Shape& shape, Sampling sampling, int particles_per_cell, double h = 0.5) {
  Scene scene;
  scene.grid.spacing = h;
  scene.materials.resize(1);
  Body body;
  body.shape = shape;
  body.sampling = sampling;
  body.particles_per_cell = particles_per_cell;
  body.seed = 1;
  scene.bodies = {body};
  return scene;
}

/// A hash of every bit of the positions, in order (FNV-1a).
std::uint64_t hash(const std::vector<Vec3>& x) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const Vec3& position : x)
    for (int axis = 0; axis < 3; ++axis) {
      std::uint64_t bits;
      std::memcpy(&bits, &position[axis], sizeof bits);
      hash = (hash ^ bits) * 0x100000001b3ULL;
    }
  return hash;
}

const Shape unit_box = Box{Vec3::Zero(), Vec3::Ones()};
const Shape ball = Sphere{Vec3(0.1, 0.2, 1), 0.3};

TEST(Lattice, PencilCaseInOrder) {
  const Particles p = sample_bodies(scene_with(unit_box, Sampling::lattice, 1));
  ASSERT_EQ(p.size(), 8u);
  // z fastest, then y, then x; cells of 0.5 have their centres at 0.25 and 0.75.
  for (int q = 0; q < 8; ++q)
    EXPECT_EQ(p.x[q], 0.25 * Vec3::Ones() + 0.5 * Vec3(q >> 2, q >> 1 & 1, q & 1));
}

TEST(Lattice, SubCellsOfAnOffsetGrid) {
  Scene scene = scene_with(Box{Vec3::Constant(10), Vec3::Constant(11)}, Sampling::lattice, 27, 1);
  scene.grid.origin = Vec3::Constant(0.5);
  const Particles p = sample_bodies(scene);
  ASSERT_EQ(p.size(), 27u);
  // Centres at 0.5 + (i + 1/2)/3: of cell 9 (9.5 … 10.5) and 10 (10.5 … 11.5)
  // those in [10, 11) are 10 (on the face at min), 10.33 and 10.67; 11 is at max.
  EXPECT_NEAR(p.x[0][0], 10, 1e-14);
  EXPECT_NEAR(p.x[26][0], 10 + 2.0 / 3, 1e-14);
  EXPECT_NEAR(p.x[1][2], 10 + 1.0 / 3, 1e-14);
}

TEST(Lattice, BoundariesAtMinIncludedAtMaxExcluded) {
  const Shape box = Box{Vec3::Constant(0.25), Vec3::Constant(0.75)};  // faces on the centres
  const Particles p = sample_bodies(scene_with(box, Sampling::lattice, 1));
  ASSERT_EQ(p.size(), 1u);
  EXPECT_EQ(p.x[0], Vec3::Constant(0.25));
}

TEST(Lattice, IsSymmetricForASymmetricBody) {
  // No asymmetry of rounding or membership: what is at x is at −x.
  const Particles p =
      sample_bodies(scene_with(Sphere{Vec3::Zero(), 1}, Sampling::lattice, 8, 0.25));
  ASSERT_GT(p.size(), 1000u);
  for (std::size_t q = 0; q < p.size(); ++q) EXPECT_EQ(p.x[q], -p.x[p.size() - 1 - q]);
}

TEST(Lattice, RefusesCountsThatAreNoCube) {
  for (const int count : {2, 7, 9, 26, 63})
    EXPECT_THROW(sample_bodies(scene_with(unit_box, Sampling::lattice, count)), InputError);
  for (const int count : {1, 8, 27, 64, 125})
    EXPECT_EQ(sample_bodies(scene_with(unit_box, Sampling::lattice, count)).size(), 8u * count);
}

TEST(Jittered, OnePointInEverySubCell) {
  const Particles p = sample_bodies(scene_with(unit_box, Sampling::jittered, 8));
  ASSERT_EQ(p.size(), 64u);
  for (int q = 0; q < 64; ++q) {
    const Vec3 corner = 0.25 * Vec3(q >> 4, q >> 2 & 3, q & 3);
    EXPECT_TRUE((p.x[q].array() >= corner.array()).all());
    EXPECT_TRUE((p.x[q].array() <= corner.array() + 0.25).all());
  }
}

TEST(Jittered, CountsThatAreNoCubeFillWholeCells) {
  const Particles p = sample_bodies(scene_with(unit_box, Sampling::jittered, 5));
  ASSERT_EQ(p.size(), 40u);
  for (int q = 0; q < 40; ++q) {
    const int cell = q / 5;
    const Vec3 corner = 0.5 * Vec3(cell >> 2, cell >> 1 & 1, cell & 1);
    EXPECT_TRUE((p.x[q].array() >= corner.array()).all());
    EXPECT_TRUE((p.x[q].array() <= corner.array() + 0.5).all());
  }
}

TEST(Jittered, IsUniformWithinTheSubCell) {
  const Particles p =
      sample_bodies(scene_with(Box{Vec3::Constant(-4), Vec3::Constant(4)}, Sampling::jittered, 8));
  ASSERT_EQ(p.size(), 32768u);
  Vec3 mean = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const Vec3& x : p.x) {
    Vec3 u = 4 * x;  // in units of the sub-cell
    u -= u.array().floor().matrix() + Vec3::Constant(0.5);
    mean += u / 32768.0;
    second += u * u.transpose() / 32768.0;
  }
  // Five standard deviations: of a mean √(1/12/N) = 0.0016, of a variance
  // √(1/180/N) = 0.0004, of a covariance 1/12/√N = 0.0005.
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.008);
  EXPECT_LT((second - Mat3::Identity() / 12).cwiseAbs().maxCoeff(), 0.0025);
}

TEST(Jittered, ABodyIsCutOutOfOnePatternOfSpace) {
  // The random numbers belong to the sub-cell: a smaller body's particles are
  // those of the larger one that it contains.
  const Particles large = sample_bodies(scene_with(Sphere{Vec3::Zero(), 1}, Sampling::jittered, 8));
  const Shape part = Box{Vec3(-0.4, -0.3, 0), Vec3(0.2, 0.4, 0.5)};
  const Particles small = sample_bodies(scene_with(part, Sampling::jittered, 8));
  std::vector<Vec3> cut;
  for (const Vec3& x : large.x)
    if (contains(part, x)) cut.push_back(x);
  EXPECT_EQ(cut, small.x);
}

TEST(Jittered, SeedsDiffer) {
  Scene scene = scene_with(unit_box, Sampling::jittered, 8);
  const Particles a = sample_bodies(scene);
  scene.bodies[0].seed = 2;
  const Particles b = sample_bodies(scene);
  for (std::size_t p = 0; p < a.size(); ++p)
    for (int axis = 0; axis < 3; ++axis) EXPECT_NE(a.x[p][axis], b.x[p][axis]);
}

// The pinned hashes: whoever changes them changes every scene of every user.
// Equal under g++ 12 and clang 14 at every optimization level.
TEST(Reproducible, PositionsArePinnedToTheLastBit) {
  EXPECT_EQ(hash(sample_bodies(scene_with(ball, Sampling::lattice, 8, 0.05)).x),
            16773522450479241277ULL);
  EXPECT_EQ(hash(sample_bodies(scene_with(ball, Sampling::jittered, 8, 0.05)).x),
            6453941721382918455ULL);
  EXPECT_EQ(hash(sample_bodies(scene_with(ball, Sampling::jittered, 5, 0.05)).x),
            14276632519440274259ULL);
  EXPECT_EQ(hash(sample_bodies(scene_with(ball, Sampling::poisson, 8, 0.05)).x),
            11144497005215318728ULL);
  const Shape cylinder = Cylinder{Vec3(0.1, 0, 0.3), Vec3(1, 2, 3), 0.2, 0.5};
  EXPECT_EQ(hash(sample_bodies(scene_with(cylinder, Sampling::jittered, 27, 0.05)).x),
            13860072123252379667ULL);
}

TEST(Poisson, HoldsTheMeanDensityInABody) {
  // A ball of 8·4π/3·6³ = 7238 expected particles; its count scatters by some
  // 0.5 % (surface cells), the mean of ten by 0.16 %: three of these.
  double count = 0;
  for (int seed = 0; seed < 10; ++seed) {
    Scene scene = scene_with(ball, Sampling::poisson, 8, 0.05);
    scene.bodies[0].seed = 50 + seed;
    count += static_cast<double>(sample_bodies(scene).size());
  }
  EXPECT_NEAR(count / 10 / (8 * 4 * std::numbers::pi / 3 * 216), 1, 0.005);
}

TEST(Poisson, NoLayerFormsAtTheSurface) {
  // Density in the outermost shell of a third of the volume against the whole.
  double shell = 0, all = 0;
  for (int seed = 0; seed < 10; ++seed) {
    Scene scene = scene_with(ball, Sampling::poisson, 8, 0.05);
    scene.bodies[0].seed = 70 + seed;
    for (const Vec3& x : sample_bodies(scene).x) {
      ++all;
      const double r = (x - center(ball)).norm() / 0.3;
      shell += r * r * r > 2.0 / 3;
    }
  }
  EXPECT_NEAR(shell / all * 3, 1, 0.02);  // 24000 points, correlated: σ below 0.6 %
}

TEST(Poisson, KeepsItsDistanceAcrossAPeriodicSeam) {
  Scene scene = scene_with(Box{Vec3::Zero(), Vec3(2, 3, 2)}, Sampling::poisson, 4);
  scene.grid.periodic = Vec3(2, 0, 2);
  const Particles p = sample_bodies(scene);
  EXPECT_NEAR(static_cast<double>(p.size()), 4 * 12 / 0.125, 20);
  const double radius = 0.5 * std::cbrt(0.5727 / 4);
  for (std::size_t a = 0; a < p.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      Vec3 d = p.x[a] - p.x[b];
      for (const int axis : {0, 2}) d[axis] -= 2 * std::round(d[axis] / 2);
      ASSERT_GE(d.norm(), radius * (1 - 1e-12));
    }
}

TEST(Mass, IsDensityTimesVolumePerParticle) {
  for (const Sampling sampling : {Sampling::lattice, Sampling::jittered, Sampling::poisson}) {
    Scene scene = scene_with(unit_box, sampling, 8);
    scene.materials[0].density = 250;
    const Particles p = sample_bodies(scene);
    for (std::size_t q = 0; q < p.size(); ++q) {
      EXPECT_EQ(p.m[q], 250 * 0.125 / 8);
      EXPECT_EQ(p.V_0[q], 0);
      EXPECT_EQ(p.F_E[q], Mat3::Identity());
      EXPECT_EQ(p.F_P[q], Mat3::Identity());
    }
  }
}

TEST(Mass, ExactVolumesSumToThatOfTheBox) {
  for (const Sampling sampling : {Sampling::lattice, Sampling::jittered}) {
    Scene scene = scene_with(unit_box, sampling, 8);
    scene.bodies[0].volumes = VolumeSource::exact;
    double volume = 0;
    for (const double V : sample_bodies(scene).V_0) volume += V;
    EXPECT_EQ(volume, 1);  // powers of two: no rounding
  }
}

TEST(Velocity, IsThatOfARigidBody) {
  Scene scene = scene_with(ball, Sampling::jittered, 8, 0.05);
  const Vec3 v(1, 2, 3), omega(-4, 0.5, 2);
  scene.bodies[0].velocity = v;
  scene.bodies[0].angular_velocity = omega;
  const Particles p = sample_bodies(scene);
  for (std::size_t q = 0; q < p.size(); ++q) {
    const Vec3 r = p.x[q] - Vec3(0.1, 0.2, 1);
    EXPECT_LT((p.v[q] - v - omega.cross(r)).norm(), 1e-14);
    EXPECT_NEAR((p.v[q] - v).dot(r), 0, 1e-14);
  }
}

TEST(Bodies, AreNumberedInOrderWithTheirMaterials) {
  Scene scene = scene_with(unit_box, Sampling::lattice, 1);
  scene.materials.resize(2);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].material = 1;
  scene.bodies[1].shape = Box{Vec3(5, 5, 5), Vec3(5.1, 5.1, 5.1)};  // holds no centre: no particle
  scene.bodies.push_back(scene.bodies[1]);
  scene.bodies[2].shape = Box{Vec3(5, 5, 5), Vec3(6, 6, 6)};
  const Particles p = sample_bodies(scene);
  ASSERT_EQ(p.size(), 16u);
  for (int q = 0; q < 16; ++q) {
    EXPECT_EQ(p.id[q], q);
    EXPECT_EQ(p.material[q], q < 8 ? 0 : 1);
  }
}

TEST(Bodies, FromAFileKeepTheirStateAndAddTheVelocity) {
  Scene scene = scene_with(unit_box, Sampling::lattice, 1);
  scene.grid.periodic = Vec3(2, 0, 0);
  Body body;
  body.sampling = Sampling::from_file;
  body.velocity = Vec3(1, 0, 0);
  body.particles.resize(2);
  body.particles.x = {Vec3(2.5, 9, 9), Vec3(0.5, 8, 8)};
  body.particles.v = {Vec3(0, 1, 0), Vec3(0, 0, 1)};
  body.particles.m = {3, 4};
  body.particles.V_0 = {5, 6};
  body.particles.F_P[1] = 2 * Mat3::Identity();
  body.particles.id = {77, 5};
  scene.bodies.push_back(body);
  const Particles p = sample_bodies(scene);
  ASSERT_EQ(p.size(), 10u);
  EXPECT_EQ(p.x[8], Vec3(0.5, 9, 9));  // wrapped
  EXPECT_EQ(p.v[8], Vec3(1, 1, 0));
  EXPECT_EQ(p.m[9], 4);
  EXPECT_EQ(p.V_0[9], 6);
  EXPECT_EQ(p.F_P[9], 2 * Mat3::Identity());
  EXPECT_EQ(p.id[8], 8);
  EXPECT_EQ(p.id[9], 9);
}

TEST(Periodic, PositionsAreWrappedAndVelocitiesAreNot) {
  // A ball over the seam: sampled and set spinning as one body, then wrapped.
  Scene scene = scene_with(Sphere{Vec3(0, 1, 1), 0.5}, Sampling::lattice, 8, 0.25);
  scene.bodies[0].angular_velocity = Vec3(0, 0, 1);
  const Particles open = sample_bodies(scene);
  scene.grid.periodic = Vec3(2, 0, 0);
  const Particles wrapped = sample_bodies(scene);
  ASSERT_EQ(open.size(), wrapped.size());
  int moved = 0;
  for (std::size_t p = 0; p < open.size(); ++p) {
    EXPECT_GE(wrapped.x[p][0], 0);
    EXPECT_LT(wrapped.x[p][0], 2);
    EXPECT_EQ(wrapped.x[p][0], open.x[p][0] + (open.x[p][0] < 0 ? 2 : 0));
    EXPECT_EQ(wrapped.v[p], open.v[p]);
    moved += open.x[p][0] < 0;
  }
  EXPECT_EQ(moved, static_cast<int>(open.size()) / 2);
}

TEST(Periodic, ABodyOverTheWholePeriodFillsIt) {
  Scene scene = scene_with(Box{Vec3(0.1, 0, 0), Vec3(2.1, 1, 1)}, Sampling::lattice, 8);
  scene.grid.periodic = Vec3(2, 0, 0);
  EXPECT_EQ(sample_bodies(scene).size(), 128u);
  scene.bodies[0].shape = Box{Vec3(0, 0, 0), Vec3(2.5, 1, 1)};  // it would overlap itself
  EXPECT_THROW(sample_bodies(scene), InputError);
}

TEST(Limits, UnboundedOrAbsurdBodiesAreRefused) {
  EXPECT_THROW(sample_bodies(scene_with(HalfSpace{}, Sampling::lattice, 8)), InputError);
  for (const Sampling sampling : {Sampling::lattice, Sampling::jittered, Sampling::poisson}) {
    EXPECT_THROW(sample_bodies(scene_with(ball, sampling, 8, 1e-6)), InputError);
    EXPECT_THROW(sample_bodies(scene_with(Sphere{Vec3(1e12, 0, 0), 1}, sampling, 8)), InputError);
  }
}

}  // namespace
}  // namespace firn
