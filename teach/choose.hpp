// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Which particle and which node are worth following through a step.

#include <cstddef>
#include <string>
#include <vector>

#include "teach/lesson.hpp"

namespace firn::teach {

struct Choice {
  std::size_t index = 0;
  std::string why;  ///< one sentence for the learner
};

StepEvents events_of(const StepRecord& record);

/// The one to which most happens: yields, is stopped by a collider, has a node in
/// contact near it; among equals the one whose F_P (else v_p) changes most.
Choice choose_particle(const Scene& scene, const StepRecord& record);

/// Among the particle's nodes one in contact if there is one, then the largest weight.
Choice choose_node(const StepRecord& record, const std::vector<StencilNode>& stencil);

/// By id, or (i,j,k). Throw InputError.
Choice given_particle(const StepRecord& record, std::int64_t id);
Choice given_node(const StepRecord& record, const NodeIndex& node);

}  // namespace firn::teach
