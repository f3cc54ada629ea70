// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Steps 5 and 9 for one node or particle: every result that a correct solver may reach.
///
/// Contact jumps where φ = 0, and where faces meet. Within rounding of a surface both "touches"
/// and "free" are right, within rounding of an edge the normal of either face, and nothing
/// between them. So the results are listed, each with a bound that
/// covers rounding alone, and a solver is compared with the one that it chose.

#include <cstddef>
#include <vector>

#include "firn/scene.hpp"

namespace firn::check {

struct ContactOutcome {
  Vec3 v;                        ///< after contact [m/s]
  double v_error = 0;            ///< of ‖δv‖ [m/s]; `unbounded` where nothing can be said
  Mat3 free = Mat3::Identity();  ///< projector onto the directions left free
  double free_error = 0;         ///< of ‖δ(projector)‖
};

struct ContactOutcomes {
  std::vector<ContactOutcome> outcomes;  ///< not empty; the first is the reference's own
  int doubtful = -1;  ///< first collider of which rounding decides what it does; −1: none
  int normal = -1;    ///< first collider whose normal may be anything within rounding
};

/// A point and its velocity before contact, each with the error that it may have.
struct ContactPoint {
  Vec3 x;
  Vec3 x_error;  ///< per axis [m]
  Vec3 v;
  double v_error = 0;  ///< of ‖δv‖
};

/// The results of all colliders one after the other. With `projectors`, results of equal
/// velocity count as different where the semi-implicit solve would hold other directions:
/// at v_n = 0 and at the friction cone. `eps` is that of the subject.
ContactOutcomes contact_outcomes(const Scene& scene, const ContactPoint& point, double time,
                                 double eps, bool projectors);

/// A node or particle with more than one outcome.
struct DoubtfulContact {
  std::size_t index = 0;  ///< in the reference's grid or particle order
  int collider = 0;       ///< place in Scene::colliders
  std::vector<ContactOutcome> outcomes;
};

}  // namespace firn::check
