// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Stages 5 and 9: contact of nodes and particles with the scene's colliders.

#include <vector>

#include "firn/scene.hpp"

namespace firn::optimized {

enum class ContactMode { none, slides, sticks };

/// v after contact with `collider`, as it stands at the point of `contact`
/// (Stomakhin et al. 2013, section 8). `skip_friction`: a collider without friction takes
/// neither the length of v_t nor the comparison with it; 1 + 0·v_n/slip = 1 exactly.
ContactMode collide(const Collider& collider, const Contact& contact, bool skip_friction, Vec3& v);

/// The colliders of a scene at one time, and which of them a region can touch.
class Contacts {
 public:
  Contacts() = default;
  Contacts(const Scene& scene, double time, bool skip_friction)
      : scene_(&scene), time_(time), skip_friction_(skip_friction) {}

  /// Collider numbers that may have φ ≤ 0 somewhere within `radius` of `center`:
  /// φ(x) ≥ φ(center) − L·radius with L the Lipschitz bound of φ.
  void near(const Vec3& center, double radius, std::vector<std::size_t>& out) const;

  /// v after all the given colliders, in scene order.
  void collide(const std::vector<std::size_t>& colliders, const Vec3& x, Vec3& v) const;

  /// The same; `free` is multiplied by the projector onto the directions that they leave free.
  void collide(const std::vector<std::size_t>& colliders, const Vec3& x, Vec3& v, Mat3& free) const;

  /// All of them.
  void all(std::vector<std::size_t>& out) const;

 private:
  const Scene* scene_ = nullptr;
  double time_ = 0;
  bool skip_friction_ = true;
};

}  // namespace firn::optimized
