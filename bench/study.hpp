// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A subject of the benchmark as the studies (verification/studies) take it.

#include "bench/timing.hpp"
#include "verification/studies/subject.hpp"

namespace firn::bench {

/// Throws Interrupted between steps once the run is interrupted. `registry` must outlive it.
inline studies::Subject study_subject(const Registry& registry, const Subject& subject) {
  return {[&registry, subject] { return subject.create(registry); }, subject.precision,
          [] {
            if (interrupted()) throw Interrupted{};
          }};
}

}  // namespace firn::bench
