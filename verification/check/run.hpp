// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The parts of run_check(): the recorder of rows and divergences, and the two modes.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "verification/check/check.hpp"
#include "verification/check/comparison.hpp"

namespace firn::check {

/// Collects what the modes find. Rows appear in the order in which they first occur;
/// the first divergence is the first one recorded.
class Recorder {
 public:
  Recorder(CheckReport& report, ErrorMap* map) : report_(report), map_(map) {}

  void set_step(std::int64_t step) { step_ = step; }
  /// What the subject is given next, and Δt; both outlive the comparisons.
  void set_input(const State& input, double dt) {
    input_ = &input;
    dt_ = dt;
  }
  void step_done() { ++report_.steps; }
  Exercised& exercised() { return report_.exercised; }
  bool failed() const { return report_.first_divergence.has_value(); }

  /// Runs the subject's part. An exception becomes a divergence, and false.
  bool guard(Stage from, Stage through, const std::function<void()>& subject_part);

  void compare(const FieldComparison& comparison, Stage from, Stage through, Stage written_by,
               Field field, bool kept);

  void property(const std::string& name, std::int64_t compared, bool valid,
                const std::string& detail, Stage from = Stage::rasterize,
                Stage through = Stage::positions);

  /// Something other than a number out of bounds: wrong shape, exception.
  void diverged(Stage from, Stage through, std::optional<Field> field, const std::string& message);

  /// Hands the rows to the report.
  void finish();

 private:
  /// The numbers of one step in one row, once more one by one.
  void look_closer(FieldRow& row, const FieldComparison& comparison, bool explain);

  CheckReport& report_;
  ErrorMap* map_;
  std::int64_t step_ = 0;
  const State* input_ = nullptr;
  double dt_ = 0;
  std::vector<FieldRow> rows_;
};

void run_lockstep(const Scene& scene, State state, Solver& reference, Solver& subject,
                  const CheckOptions& options, Recorder& recorder);

void run_free(const Scene& scene, State state, Solver& reference, Solver& subject,
              const CheckOptions& options, Recorder& recorder);

}  // namespace firn::check
