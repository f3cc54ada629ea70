// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What wrong numbers have in common, and the simple rule that makes them of the right ones:
/// the pattern names the mistake.

#include <string>
#include <vector>

#include "verification/check/check.hpp"

namespace firn::check {

/// One field after one stretch of stages.
struct Evidence {
  const Scene& scene;
  const State& before;  ///< what the stretch was given
  const State& reference;
  const State& subject;
  Field field;
  double dt;
  const std::vector<Place>& places;  ///< every number that was compared, wrong or not
};

/// Sentences without a full stop, the most telling first; none if nothing explains the error:
/// "subject = 0.1 × reference, and h = 0.1", "all wrong numbers belong to nodes in contact
/// (84 of 84 such numbers are wrong)".
std::vector<std::string> diagnose(const Evidence& evidence);

/// If every wrong number belongs to a node below a twentieth of the heaviest particle's mass, the
/// largest such mass in units of the particle's: the mark of a kernel in expanded form, whose
/// weights lose their digits at the rim of the support. Else 0.
double only_light_nodes(const Evidence& evidence);

}  // namespace firn::check
