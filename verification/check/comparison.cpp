// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "verification/check/fields.hpp"

namespace firn::check {

FieldRow::FieldRow(Stage from, Stage through, Stage written_by, Field field, bool kept) {
  check_.from = from;
  check_.through = through;
  check_.written_by = written_by;
  check_.field = field;
  check_.kept = kept;
}

namespace {

/// The same number for the same node or particle of any step.
std::int64_t key_of(const Place& place) {
  if (!place.is_node) return place.id;
  const auto low_21_bits = [](std::int32_t i) { return static_cast<std::int64_t>(i) & 0x1FFFFF; };
  return (low_21_bits(place.node.i) << 42) | (low_21_bits(place.node.j) << 21) |
         low_21_bits(place.node.k);
}

/// What a bound is measured by: of a projector 1.
double size_of(Field field, double scale) {
  return field == Field::node_free_directions ? 1.0 : scale;
}

/// Why a bound may be wide at this place of the reference.
Cause cause_of(const ErrorBounds& bounds, bool node, std::size_t index) {
  const std::vector<Cause>& causes = node ? bounds.node_cause : bounds.particle_cause;
  return index < causes.size() ? causes[index] : Cause{};
}

}  // namespace

void FieldRow::add(Place place, double scale, Cause cause) {
  if (record_ != nullptr) record_->push_back(place);
  const bool first = check_.compared == 0;
  if (!std::isfinite(place.subject_value)) {
    if (check_.non_finite++ == 0) check_.worst = place;
    ++check_.compared;
    ++check_.wrong;
    check_.largest_absolute = check_.largest_relative = check_.largest_in_bounds =
        std::numeric_limits<double>::infinity();
    check_.valid = false;
    return;
  }
  const double error = std::abs(place.subject_value - place.reference_value);
  if (place.bound > widest_judged * size_of(check_.field, scale) && error <= place.bound) {
    not_judged_.add(cause, check_.field, key_of(place));
    return;
  }
  const double in_bounds = error == 0 ? 0 : error / place.bound;
  ++check_.compared;
  squares_ += error * error;
  value_squares_ += place.reference_value * place.reference_value;
  bound_squares_ += in_bounds * in_bounds;
  check_.largest_absolute = std::max(check_.largest_absolute, error);
  check_.reference_size = std::max(check_.reference_size, std::abs(place.reference_value));
  if (error > 0) check_.largest_relative = std::max(check_.largest_relative, error / scale);
  // The first number stands as `worst` until something is worse.
  if (check_.non_finite == 0 && (first || in_bounds > check_.largest_in_bounds))
    check_.worst = place;
  check_.largest_in_bounds = std::max(check_.largest_in_bounds, in_bounds);
  if (!(in_bounds <= 1)) {
    ++check_.wrong;
    check_.valid = false;
  }
}

void FieldRow::finish() {
  const auto finite = static_cast<double>(check_.compared - check_.non_finite);
  if (finite == 0) return;
  check_.rms_absolute = std::sqrt(squares_ / finite);
  check_.rms_relative = squares_ == 0 ? 0 : std::sqrt(squares_ / value_squares_);
  check_.rms_in_bounds = std::sqrt(bound_squares_ / finite);
}

void FieldComparison::run(FieldRow& row) const {
  const Field field = row.check().field;
  double scale = 0;
  for (std::size_t i = 0; i < length(reference, field); ++i)
    for (int c = 0; c < components(field); ++c)
      scale = std::max(scale, std::abs(value(reference, field, i, c)));
  if (is_node_field(field))
    nodes(row, scale);
  else
    particles(row, scale);
}

void FieldComparison::particles(FieldRow& row, double scale) const {
  const Field field = row.check().field;
  Place place;
  place.step = step;
  for (std::size_t p = 0; p < length(reference, field); ++p) {
    place.index = p;
    place.id = reference.particles.id[p];
    for (int c = 0; c < components(field); ++c) {
      place.component = c;
      place.reference_value = value(reference, field, p, c);
      place.subject_value = value(subject, field, p, c);
      place.bound = bound(bounds, field, p, c);
      const double period = field == Field::particle_position ? scene.grid.periodic[c] : 0;
      // The two sides of the seam are the same place: take the image next to the
      // reference's. Elsewhere positions have to be wrapped.
      const double low = period > 0 ? scene.grid.origin[c] : 0;
      if (period > 0 && place.subject_value >= low - place.bound &&
          place.subject_value <= low + period + place.bound)
        place.subject_value -=
            period * std::round((place.subject_value - place.reference_value) / period);
      row.add(place, scale, cause_of(bounds, false, p));
    }
  }
}

void FieldComparison::nodes(FieldRow& row, double scale) const {
  const Field field = row.check().field;
  const Grid &ours = reference.grid, &theirs = subject.grid;
  Place place;
  place.step = step;
  place.is_node = true;
  const auto add = [&](auto reference_value, auto subject_value, auto bound_of, Cause cause) {
    for (int c = 0; c < components(field); ++c) {
      place.component = c;
      place.reference_value = reference_value(c);
      place.subject_value = subject_value(c);
      place.bound = bound_of(c);
      row.add(place, scale, cause);
    }
  };
  const Cause light{Cause::Kind::light_node};
  const auto zero = [](int) { return 0.0; };
  std::size_t i = 0, j = 0;
  while (i < ours.size() || j < theirs.size()) {
    const bool only_theirs =
        i == ours.size() || (j < theirs.size() && theirs.node[j] < ours.node[i]);
    const bool only_ours = !only_theirs && (j == theirs.size() || ours.node[i] < theirs.node[j]);
    place.node = only_theirs ? theirs.node[j] : ours.node[i];
    place.index = only_theirs ? j : i;
    const auto our_value = [&](int c) { return value(reference, field, i, c); };
    const auto their_value = [&](int c) { return value(subject, field, j, c); };
    const auto our_bound = [&](int c) { return bound(bounds, field, i, c); };
    if (only_theirs) {
      const auto it = stencils.stray_mass().find(place.node);
      const double stray = it == stencils.stray_mass().end() ? 0.0 : it->second;
      // Lighter than rounding can explain: whatever the node carries is harmless.
      const bool harmless = theirs.m[j] <= stray && field != Field::node_mass;
      add(
          zero, their_value, [&](int) { return harmless ? unbounded : stray; }, light);
      ++j;
    } else if (only_ours) {
      const bool harmless = ours.m[i] <= bounds.uncertain_mass[i] && field != Field::node_mass;
      add(
          our_value, zero, [&](int c) { return harmless ? unbounded : our_bound(c); }, light);
      ++i;
    } else {
      add(our_value, their_value, our_bound, cause_of(bounds, true, i));
      ++i, ++j;
    }
  }
}

std::string describe(const Place& place) {
  const std::string what =
      place.is_node ? fmt::format("node ({},{},{})", place.node.i, place.node.j, place.node.k)
                    : fmt::format("particle {} (id {})", place.index, place.id);
  return fmt::format("{}, component {}: {:.9g} against {:.9g}, allowed difference {:.3g}", what,
                     place.component, place.subject_value, place.reference_value, place.bound);
}

}  // namespace firn::check
