// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/error_map.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "verification/check/fields.hpp"

namespace firn {

namespace {

std::string column_name(const FieldCheck& row) {
  if (row.from == row.through)
    return fmt::format("{}_{} {}", number(row.through), name(row.through), name(row.field));
  return fmt::format("{}-{} {}", number(row.from), number(row.through), name(row.field));
}

ErrorColumn& column_of(ErrorFrame& frame, const FieldCheck& row) {
  const std::string name = column_name(row);
  for (ErrorColumn& column : frame.columns)
    if (column.name == name) return column;
  frame.columns.push_back({name, std::vector<float>(frame.point.size())});
  return frame.columns.back();
}

float in_bounds(const Place& place) {
  if (!std::isfinite(place.subject_value)) return std::numeric_limits<float>::infinity();
  const double error = std::abs(place.subject_value - place.reference_value);
  return error == 0 ? 0 : static_cast<float>(error / place.bound);
}

/// The nodes of the first stretch that has some; every later one of the step has the same.
void add_nodes(const Scene& scene, const Grid& grid, std::size_t particles, ErrorFrame& frame) {
  if (frame.point.size() > particles) return;
  for (const NodeIndex& n : grid.node) {
    frame.point.push_back(scene.grid.origin + scene.grid.spacing * Vec3(n.i, n.j, n.k));
    frame.id.push_back(-1);
    frame.node.push_back(n);
  }
  for (ErrorColumn& column : frame.columns) column.in_bounds.resize(frame.point.size());
}

}  // namespace

ErrorFrame& ErrorMap::frame_of(const State& input) {
  if (!frames_.empty() && frames_.back().step == input.step) return frames_.back();
  ErrorFrame frame;
  frame.step = input.step;
  frame.time = input.time;
  frame.point = input.particles.x;
  frame.id = input.particles.id;
  frame.node.resize(frame.point.size());
  frames_.push_back(std::move(frame));
  return frames_.back();
}

void ErrorMap::add(const Scene& scene, const State& input, const State& reference,
                   const FieldCheck& row, const std::vector<Place>& places) {
  ErrorFrame& frame = frame_of(input);
  const std::size_t particles = input.particles.size();
  add_nodes(scene, reference.grid, particles, frame);
  std::vector<float>& column = column_of(frame, row).in_bounds;
  const auto first = frame.node.begin() + static_cast<std::ptrdiff_t>(particles);
  for (const Place& place : places) {
    std::size_t at = place.index;
    if (place.is_node) {
      // A node that only the subject has is not on the map.
      const auto node = std::lower_bound(first, frame.node.end(), place.node);
      if (node == frame.node.end() || !(*node == place.node)) continue;
      at = static_cast<std::size_t>(node - frame.node.begin());
    }
    column[at] = std::max(column[at], in_bounds(place));
  }
}

}  // namespace firn
