#pragma once
/// Stages 5 and 9: contact of nodes and particles with the scene's colliders.

#include <vector>

#include "firn/scene.hpp"

namespace firn::optimized {

enum class ContactMode { none, slides, sticks };

/// v after contact with `collider`, as it stands at the point of `contact`
/// (Stomakhin et al. 2013, section 8).
ContactMode collide(const Collider& collider, const Contact& contact, Vec3& v);

/// The colliders of a scene at one time, and which of them a region can touch.
class Contacts {
 public:
  Contacts() = default;
  Contacts(const Scene& scene, double time) : scene_(&scene), time_(time) {}

  /// Collider numbers that may have φ ≤ 0 somewhere within `radius` of `center`:
  /// φ(x) ≥ φ(center) − L·radius with L the Lipschitz bound of φ.
  void near(const Vec3& center, double radius, std::vector<int>& out) const;

  /// v after all the given colliders, in scene order.
  void collide(const std::vector<int>& colliders, const Vec3& x, Vec3& v) const;

  /// The same; `free` is multiplied by the projector onto the directions that they leave free.
  void collide(const std::vector<int>& colliders, const Vec3& x, Vec3& v, Mat3& free) const;

  /// All of them.
  void all(std::vector<int>& out) const;

 private:
  const Scene* scene_ = nullptr;
  double time_ = 0;
};

}  // namespace firn::optimized
