// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "firn/build_info.hpp"
#include "firn/machine.hpp"
#include "firn/registry.hpp"
#include "verification/check/check.hpp"
#include "verification/check/report_text.hpp"

namespace firn {

namespace {

using nlohmann::ordered_json;

/// JSON has no NaN and no infinity; as text they at least stay visible.
ordered_json finite_or_text(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0 ? "inf" : "-inf";
}

std::string verdict(bool valid) { return valid ? "VALID" : "INVALID"; }

ordered_json exercised_json(const Exercised& exercised) {
  ordered_json json = ordered_json::array();
  for (const FeatureName& feature : feature_names())
    json.push_back({{"key", feature.key},
                    {"stage", std::string(name(feature.stage))},
                    {"of", feature.of},
                    {"what", feature.phrase},
                    {"count", exercised[feature.feature]}});
  return json;
}

ordered_json place_json(const Place& place) {
  ordered_json json;
  json["step"] = place.step;
  if (place.is_node)
    json["node"] = {place.node.i, place.node.j, place.node.k};
  else
    json["particle"] = place.id;
  json["index"] = place.index;
  json["component"] = place.component;
  json["reference"] = finite_or_text(place.reference_value);
  json["subject"] = finite_or_text(place.subject_value);
  json["bound"] = finite_or_text(place.bound);
  return json;
}

ordered_json field_json(const FieldCheck& row) {
  ordered_json json;
  json["from"] = std::string(name(row.from));
  json["through"] = std::string(name(row.through));
  json["written_by"] = row.kept ? ordered_json() : ordered_json(std::string(name(row.written_by)));
  json["field"] = std::string(name(row.field));
  json["units"] = std::string(units(row.field));
  json["compared"] = row.compared;
  json["wrong"] = row.wrong;
  json["non_finite"] = row.non_finite;
  json["largest_absolute"] = finite_or_text(row.largest_absolute);
  json["rms_absolute"] = finite_or_text(row.rms_absolute);
  json["largest_relative"] = finite_or_text(row.largest_relative);
  json["rms_relative"] = finite_or_text(row.rms_relative);
  json["largest_in_bounds"] = finite_or_text(row.largest_in_bounds);
  json["rms_in_bounds"] = finite_or_text(row.rms_in_bounds);
  json["diagnosis"] = row.diagnosis;
  json["only_light_nodes"] = row.only_light_nodes;
  if (row.compared > 0) json["worst"] = place_json(row.worst);
  json["verdict"] = verdict(row.valid);
  return json;
}

ordered_json property_json(const PropertyCheck& row) {
  return {{"name", row.name},
          {"compared", row.compared},
          {"verdict", verdict(row.valid)},
          {"detail", row.detail}};
}

ordered_json divergence_json(const Divergence& divergence) {
  ordered_json json;
  json["step"] = divergence.step;
  json["from"] = std::string(name(divergence.from));
  json["through"] = std::string(name(divergence.through));
  json["field"] =
      divergence.field ? ordered_json(std::string(name(*divergence.field))) : ordered_json();
  json["message"] = divergence.message;
  return json;
}

}  // namespace

ordered_json check::not_exercised_json(const std::vector<std::string>& keys) {
  ordered_json json = ordered_json::array();
  for (const std::string& key : keys) {
    const Requirement& requirement = requirement_of(key);
    ordered_json shown_by = ordered_json::array();
    for (const FeatureName& feature : feature_names())
      if (std::count(requirement.any_of.begin(), requirement.any_of.end(), feature.feature) > 0)
        shown_by.push_back(feature.key);
    json.push_back({{"key", key}, {"what", requirement.phrase}, {"shown_by", shown_by}});
  }
  return json;
}

std::string to_json(const CheckReport& report) {
  ordered_json json;
  json["schema"] = "firn-check";
  json["version"] = 2;
  json["command"] = report.command;
  json["firn_version"] = build_info().version;
  json["git_commit"] = build_info().git_commit;
  json["compiler"] = build_info().compiler;
  json["processor"] = processor_name();
  json["scene"] = report.scene;
  json["scene_hash"] = report.scene_hash;
  json["reference"] = report.reference;
  json["subject"] = report.subject;
  json["precision"] = std::string(name(report.precision));
  json["mode"] = report.mode == CheckMode::lockstep ? "lockstep" : "free";
  json["steps"] = report.steps;
  json["windows"] = ordered_json::array();
  for (const CheckedWindow& window : report.windows)
    json["windows"].push_back({{"start_step", window.start_step}, {"steps", window.steps}});
  json["particles"] = report.particles;
  json["compared"] = report.compared();
  json["largest_in_bounds"] = finite_or_text(report.largest_in_bounds());
  json["verdict"] = std::string(verdict_word(report));
  json["line"] = verdict_line(report);
  json["not_exercised"] = check::not_exercised_json(report.not_exercised);
  json["not_judged"] = ordered_json::array();
  for (const NotJudged& each : report.not_judged)
    json["not_judged"].push_back(
        {{"what", each.what}, {"numbers", each.numbers}, {"places", each.places}});
  json["exercised"] = exercised_json(report.exercised);
  json["solver_iterations"] = report.exercised.iterations();
  json["first_divergence"] =
      report.first_divergence ? divergence_json(*report.first_divergence) : ordered_json();
  json["fields"] = ordered_json::array();
  for (const FieldCheck& row : report.fields) json["fields"].push_back(field_json(row));
  json["properties"] = ordered_json::array();
  for (const PropertyCheck& row : report.properties)
    json["properties"].push_back(property_json(row));
  // Names and messages of guests may hold any bytes; invalid UTF-8 is replaced, never thrown at.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace firn
