// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A scene as the TOML file defines it, with every value checked.
/// `io/scene/scene_file.hpp` reads one; a program may also fill one itself.

#include <cstdint>
#include <string>
#include <vector>

#include "firn/collider.hpp"
#include "firn/material.hpp"
#include "firn/shape.hpp"
#include "firn/state.hpp"

namespace firn {

struct GridSettings {
  double spacing = 0;            ///< h [m], > 0
  Vec3 origin = Vec3::Zero();    ///< position of node (0,0,0) [m]
  Vec3 periodic = Vec3::Zero();  ///< period along each axis [m], 0 = open

  /// Number of nodes along a periodic axis, 0 along an open one.
  int period_nodes(int axis) const;
};

struct TimeSettings {
  double end = 0;  ///< [s], ≥ 0
  bool adaptive = false;
  double step = 0;               ///< fixed Δt [s]
  double max_step = 0;           ///< adaptive: largest Δt [s]
  double cfl = 0;                ///< adaptive: Δt ≤ cfl·h/max‖v_p‖
  double elastic_cfl = 0;        ///< adaptive, explicit only: Δt ≤ elastic_cfl·h/max c_p
  double frames_per_second = 0;  ///< [1/s], > 0
};

enum class IntegratorType { explicit_euler, semi_implicit };

struct IntegratorSettings {
  IntegratorType type = IntegratorType::explicit_euler;
  double implicitness = 1.0;  ///< β in [0, 1]
  double tolerance = 1e-8;    ///< on the relative residual
  int max_iterations = 500;
};

enum class Sampling { lattice, jittered, poisson, from_file };
enum class VolumeSource { estimated, exact };

struct Body {
  std::int32_t material = 0;  ///< index into Scene::materials
  Shape shape;                ///< not used with Sampling::from_file
  Sampling sampling = Sampling::jittered;
  int particles_per_cell = 8;
  std::uint64_t seed = 0;
  VolumeSource volumes = VolumeSource::estimated;
  Vec3 velocity = Vec3::Zero();          ///< [m/s]; from_file: added
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s], about center(shape)
  Particles particles;                   ///< with Sampling::from_file: the particles read
  std::string file;                      ///< with Sampling::from_file: where they were read
};

struct Scene {
  std::string name;
  Vec3 gravity = Vec3::Zero();  ///< g [m/s²]
  GridSettings grid;
  TimeSettings time;
  IntegratorSettings integrator;
  double flip = 0.95;  ///< α in [0, 1]
  std::vector<Material> materials;
  std::vector<Body> bodies;
  std::vector<Collider> colliders;
  std::string toml;                ///< resolved text, as trajectories store it
  std::vector<std::string> files;  ///< that it was read from: the scene file, meshes, level sets, …

  bool semi_implicit() const { return integrator.type == IntegratorType::semi_implicit; }

  /// Wraps x into [origin, origin + period) along the periodic axes.
  Vec3 wrap(const Vec3& x) const;
};

/// Throws InputError unless all arrays have one length and every material is one of the
/// scene's: a state that was filled by hand or by another program may not be consistent.
void require_consistent(const Scene& scene, const Particles& particles);

/// The particles of every body in scene order at t = 0: positions, velocities
/// including rotation, masses, and V_p0 where `volumes = "exact"` (0 elsewhere,
/// for step 2 to estimate). Same bits on every machine and compiler.
Particles sample_bodies(const Scene& scene);

/// State at t = 0.
State initial_state(const Scene& scene);

}  // namespace firn
