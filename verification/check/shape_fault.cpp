// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <fmt/format.h>
#include <string_view>

#include "verification/check/comparison.hpp"
#include "verification/check/fields.hpp"

namespace firn::check {

namespace {

using Fault = std::optional<std::string>;

Fault particle_fault(const Particles& ours, const Particles& theirs, double mass_tolerance) {
  Fault fault;
  for_each_field(
      [&](const char* name, const auto& array) {
        if (!fault && array.size() != ours.size())
          fault =
              fmt::format("{} holds {} entries for {} particles", name, array.size(), ours.size());
      },
      theirs);
  if (fault) return fault;
  for (std::size_t p = 0; p < ours.size(); ++p) {
    if (theirs.id[p] != ours.id[p])
      return fmt::format("particle {} has id {} instead of {}: order not kept", p, theirs.id[p],
                         ours.id[p]);
    if (theirs.material[p] != ours.material[p])
      return fmt::format("particle {} has material {} instead of {}", p, theirs.material[p],
                         ours.material[p]);
    if (!(std::abs(theirs.m[p] - ours.m[p]) <= mass_tolerance * ours.m[p]))
      return fmt::format("particle {} has mass {:.9g} instead of {:.9g} kg", p, theirs.m[p],
                         ours.m[p]);
  }
  return {};
}

Fault grid_fault(const Grid& ours, const Grid& theirs) {
  for (std::size_t i = 1; i < theirs.size(); ++i)
    if (!(theirs.node[i - 1] < theirs.node[i]))
      return fmt::format("nodes are not sorted by (i,j,k) at place {}", i);
  Fault fault;
  for_each_field(
      [&](const char* name, const auto& array) {
        // Masses and velocities are always there, the others where a stage has written them.
        const std::string_view field = name;
        const bool required = field == "m" || (field == "v" && !ours.v.empty());
        const bool fits = array.size() == theirs.size() || (array.empty() && !required);
        if (!fault && !fits)
          fault =
              fmt::format("{} holds {} entries for {} nodes", name, array.size(), theirs.size());
      },
      theirs);
  return fault;
}

}  // namespace

std::optional<std::string> shape_fault(const State& reference, const State& subject,
                                       double mass_tolerance) {
  if (const Fault fault = particle_fault(reference.particles, subject.particles, mass_tolerance))
    return fault;
  if (subject.next != reference.next)
    return fmt::format("stands before stage {} instead of {}", name(subject.next),
                       name(reference.next));
  if (subject.step != reference.step)
    return fmt::format("counts {} steps instead of {}", subject.step, reference.step);
  if (!(std::abs(subject.time - reference.time) <= mass_tolerance * std::abs(reference.time)))
    return fmt::format("time is {:.17g} instead of {:.17g} s", subject.time, reference.time);
  if (reference.next == Stage::rasterize) return {};  // between steps the grid may be anything
  return grid_fault(reference.grid, subject.grid);
}

}  // namespace firn::check
