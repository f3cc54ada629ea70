// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Numbers of the subject against numbers of the reference: one FieldCheck row,
/// filled over many steps.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firn/scene.hpp"
#include "verification/check/bounds.hpp"
#include "verification/check/check.hpp"
#include "verification/check/not_judged.hpp"

namespace firn::check {

/// One row of the report with the sums behind its RMS figures.
class FieldRow {
 public:
  FieldRow(Stage from, Stage through, Stage written_by, Field field, bool kept);

  const FieldCheck& check() const { return check_; }
  bool matches(Stage from, Stage through, Field field) const {
    return check_.from == from && check_.through == through && check_.field == field;
  }

  /// Numbers of one step. `place` brings step, index, id or node, component and
  /// both values; `scale` is the step's largest |value| of the field, for the
  /// relative error. Where the bound is wider than `widest_judged` of that size the
  /// number counts as compared only if it is wrong all the same; else as not judged,
  /// for this cause.
  void add(Place place, double scale, Cause cause);

  const NotJudgedCounts& not_judged() const { return not_judged_; }

  /// RMS figures from the sums.
  void finish();

  /// Keeps every number that is added, for a closer look.
  void record_into(std::vector<Place>* places) { record_ = places; }

  void explain(std::vector<std::string> diagnosis, double only_light_nodes) {
    check_.diagnosis = std::move(diagnosis);
    check_.only_light_nodes = only_light_nodes;
  }

 private:
  FieldCheck check_;
  std::vector<Place>* record_ = nullptr;
  NotJudgedCounts not_judged_;
  double squares_ = 0, value_squares_ = 0, bound_squares_ = 0;
};

/// Compares one field of two states at the same stage boundary. Positions along
/// periodic axes are compared modulo the period. Nodes are matched by (i,j,k); a
/// node that only one side has counts as zero on the other, unless it is lighter
/// than what rounded positions can move (ErrorBounds::uncertain_mass,
/// Stencils::stray_mass).
struct FieldComparison {
  const Scene& scene;
  const State& reference;
  const State& subject;
  const ErrorBounds& bounds;
  const Stencils& stencils;
  std::int64_t step = 0;

  void run(FieldRow& row) const;

 private:
  void particles(FieldRow& row, double scale) const;
  void nodes(FieldRow& row, double scale) const;
};

/// What is wrong with the shape of a stored state: array lengths, ids, order of
/// nodes, masses, stage, step count; nothing if it is sound. `reference` is the
/// reference's state at the same boundary.
std::optional<std::string> shape_fault(const State& reference, const State& subject,
                                       double mass_tolerance);

/// "particle 17 (id 4), component y: 1.5 against 1.25, bound 1e-15"
std::string describe(const Place& place);

}  // namespace firn::check
