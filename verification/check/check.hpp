// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// `firn check`: a solver judged against the reference, stage by stage.
///
/// Lockstep: the subject starts every stage from the reference's own state, so
/// errors do not compound, and each field that the stage writes is compared
/// with a bound derived from the roundoff of that stage's own arithmetic
/// (bounds.hpp). Free running: both start from the same state and run on their
/// own; how much they may differ follows from how fast a perturbed twin of the
/// reference departs (free_running.cpp).

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firn/scene.hpp"
#include "firn/solver.hpp"
#include "firn/stage.hpp"
#include "firn/state.hpp"
#include "verification/check/exercised.hpp"
#include "verification/check/not_judged.hpp"

namespace firn {

class ErrorMap;

enum class CheckMode { lockstep, free_running };

struct CheckOptions {
  CheckMode mode = CheckMode::lockstep;
  std::int64_t steps = 10;      ///< ≥ 1, steps compared
  std::int64_t start_step = 0;  ///< ≥ 0, steps of the reference before the comparison
  /// Called after each step with the number done; false ends the check there
  /// (interrupted: the report covers the steps done).
  std::function<bool(std::int64_t done)> progress{};
  ErrorMap* error_map = nullptr;  ///< filled, in lockstep (error_map.hpp)
};

/// The particle or node, and which of its numbers, with both values.
struct Place {
  std::int64_t step = 0;       ///< step under way, counted from 0
  bool is_node = false;        ///< node or particle
  std::size_t index = 0;       ///< place in the particle order, or in the sorted node list
  std::int64_t id = 0;         ///< particle id
  NodeIndex node;              ///< (i,j,k)
  int component = 0;           ///< 0 for a scalar, 0…2 of a vector, 0…8 row-major of a matrix
  double reference_value = 0;  ///< in the field's unit
  double subject_value = 0;
  double bound = 0;  ///< allowed |subject − reference|, same unit
};

/// One field after one stop of the subject, over all steps.
struct FieldCheck {
  Stage from = Stage::rasterize;        ///< first stage since the subject was loaded
  Stage through = Stage::positions;     ///< the stop after which the field is compared
  Stage written_by = Stage::positions;  ///< the last stage in between that writes it
  Field field = Field::particle_position;
  bool kept = false;  ///< no stage in between writes the field: it must be what was loaded

  std::int64_t compared = 0;  ///< numbers compared
  std::int64_t wrong = 0;     ///< of these, beyond their bounds
  std::int64_t non_finite = 0;
  double reference_size = 0;    ///< largest |value| of the reference, over all steps [field's unit]
  double largest_absolute = 0;  ///< [field's unit]
  double rms_absolute = 0;
  double largest_relative = 0;   ///< in units of the step's largest |value| of that field
  double rms_relative = 0;       ///< rms error over rms value, over all steps
  double largest_in_bounds = 0;  ///< error over its own bound; > 1 is INVALID
  double rms_in_bounds = 0;
  Place worst;  ///< where error over bound is largest
  /// What explains the wrong numbers of the first step that has any (diagnosis.hpp).
  std::vector<std::string> diagnosis;
  /// If all of these belong to light nodes: the heaviest of them, in masses of the heaviest
  /// particle [1]; else 0.
  double only_light_nodes = 0;
  bool valid = true;
};

/// Anything that is not a field's error: a property of the whole step, such as
/// "step() equals its stages bit for bit".
struct PropertyCheck {
  std::string name;
  std::int64_t compared = 0;
  bool valid = true;
  std::string detail;  ///< what went wrong, one line; empty when valid
};

/// The earliest thing that went wrong, by step, then stage, then field.
struct Divergence {
  std::int64_t step = 0;
  Stage from = Stage::rasterize;     ///< stages that ran since the subject was loaded …
  Stage through = Stage::positions;  ///< … equal to `from` when the stage is pinned down
  std::optional<Field> field;        ///< none: an exception, a wrong size, a broken property
  std::string message;               ///< one line with place, values and bound
};

/// Steps that were compared one after the other.
struct CheckedWindow {
  std::int64_t start_step = 0;  ///< the scene's step with which it begins
  std::int64_t steps = 0;       ///< compared, all in all
};

struct CheckReport {
  std::string scene, reference, subject;
  std::string scene_hash;  ///< firn/scene_hash.hpp
  std::string command;     ///< that repeats the check; empty: the caller did not say
  Precision precision = Precision::float64;  ///< the subject's
  CheckMode mode = CheckMode::lockstep;
  std::int64_t steps = 0;  ///< compared in all windows
  std::vector<CheckedWindow> windows;
  std::size_t particles = 0;
  std::vector<FieldCheck> fields;  ///< in stage order
  std::vector<PropertyCheck> properties;
  std::optional<Divergence> first_divergence;
  Exercised exercised;                     ///< what the compared states contained
  std::vector<std::string> not_exercised;  ///< keys of requirements() that the scene calls for
  bool interrupted = false;                ///< ended before all steps were compared
  std::vector<NotJudged> not_judged;       ///< not among compared(); most numbers first

  bool valid() const { return !first_divergence.has_value(); }
  std::int64_t compared() const;  ///< numbers compared, all in all
  /// Largest error in units of its bound, over all fields.
  double largest_in_bounds() const;
};

/// Runs the check. Whatever the subject does wrong (an exception, arrays of
/// wrong size, a non-finite number) ends in an INVALID report. Throws InputError
/// if options or scene ask for what a solver does not support, and lets the
/// reference's own SimulationError pass: then nothing is known about the subject.
CheckReport run_check(const Scene& scene, Solver& reference, Solver& subject,
                      const CheckOptions& options = {});

/// The same from a state between two steps (a frame of a trajectory).
CheckReport run_check(const Scene& scene, const State& initial, Solver& reference, Solver& subject,
                      const CheckOptions& options = {});

/// The same from several states, each for its own number of steps (those of `options` are not
/// used).
struct CheckWindow {
  State start;  ///< between two steps
  std::int64_t steps = 1;
};
CheckReport run_check(const Scene& scene, const std::vector<CheckWindow>& windows,
                      Solver& reference, Solver& subject, const CheckOptions& options = {});

/// "VALID", "INVALID" or, where it was interrupted before anything differed, "INCOMPLETE".
std::string_view verdict_word(const CheckReport& report);

/// "VALID: 3990280 numbers compared, largest error 0.51 of its bound; not exercised: contact".
std::string verdict_line(const CheckReport& report);

struct TableStyle {
  bool all_rows = false;  ///< else what failed and the rows with the largest errors
  bool colour = false;    ///< escape sequences of a terminal
};

/// The report as a table of at most 100 columns: what failed first, the verdict last.
std::string to_table(const CheckReport& report, const TableStyle& style = {});

/// The same as JSON text. Non-finite numbers become strings ("nan", "inf").
std::string to_json(const CheckReport& report);

/// "3 grid_forces" or "3-6 grid_forces..integration": stages that ran between load and stop.
std::string stage_range(Stage from, Stage through);

}  // namespace firn
