// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <exception>
#include <fmt/format.h>

#include "firn/error.hpp"
#include "verification/check/diagnosis.hpp"
#include "verification/check/error_map.hpp"
#include "verification/check/run.hpp"

namespace firn::check {

bool Recorder::guard(Stage from, Stage through, const std::function<void()>& subject_part) {
  try {
    subject_part();
    return true;
  } catch (const Unsupported&) {
    throw;  // a scene that the subject does not take says nothing about the subject
  } catch (const std::exception& error) {
    diverged(from, through, {}, fmt::format("the subject threw: {}", error.what()));
  } catch (...) {
    diverged(from, through, {}, "the subject threw something that is not a std::exception");
  }
  return false;
}

void Recorder::compare(const FieldComparison& comparison, Stage from, Stage through,
                       Stage written_by, Field field, bool kept) {
  auto row = std::find_if(rows_.begin(), rows_.end(),
                          [&](const FieldRow& r) { return r.matches(from, through, field); });
  if (row == rows_.end()) {
    rows_.emplace_back(from, through, written_by, field, kept);
    row = rows_.end() - 1;
  }
  const bool was_valid = row->check().valid;
  comparison.run(*row);
  const bool explain = was_valid && !row->check().valid;
  if (input_ != nullptr && (explain || map_ != nullptr)) look_closer(*row, comparison, explain);
  if (!row->check().valid)
    diverged(
        from, through, field,
        (kept ? "changed by stages that do not write it: " : "") + describe(row->check().worst));
}

void Recorder::look_closer(FieldRow& row, const FieldComparison& comparison, bool explain) {
  const FieldCheck& check = row.check();
  FieldRow again(check.from, check.through, check.written_by, check.field, check.kept);
  std::vector<Place> places;
  again.record_into(&places);
  comparison.run(again);
  if (map_ != nullptr && !check.kept)
    map_->add(comparison.scene, *input_, comparison.reference, check, places);
  if (!explain) return;
  const Evidence evidence{comparison.scene,
                          *input_,
                          comparison.reference,
                          comparison.subject,
                          check.field,
                          dt_,
                          places};
  row.explain(diagnose(evidence), only_light_nodes(evidence));
}

void Recorder::property(const std::string& name, std::int64_t compared, bool valid,
                        const std::string& detail, Stage from, Stage through) {
  auto& all = report_.properties;
  auto row = std::find_if(all.begin(), all.end(),
                          [&](const PropertyCheck& check) { return check.name == name; });
  if (row == all.end()) row = all.insert(all.end(), PropertyCheck{name, 0, true, {}});
  row->compared += compared;
  if (valid) return;
  if (row->valid) row->detail = fmt::format("step {}: {}", step_, detail);
  row->valid = false;
  diverged(from, through, {}, fmt::format("not so: {}: {}", name, detail));
}

void Recorder::diverged(Stage from, Stage through, std::optional<Field> field,
                        const std::string& message) {
  if (report_.first_divergence) return;
  report_.first_divergence = Divergence{step_, from, through, field, message};
}

void Recorder::finish() {
  NotJudgedCounts not_judged;
  for (FieldRow& row : rows_) {
    row.finish();
    not_judged.add(row.not_judged());
    report_.fields.push_back(row.check());
  }
  report_.not_judged = not_judged.summary();
}

}  // namespace firn::check
