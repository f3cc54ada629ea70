// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/not_judged.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "verification/check/check.hpp"
#include "verification/check/fields.hpp"

namespace firn {

namespace {

constexpr std::size_t reasons_told = 3;

}  // namespace

std::string not_judged_text(const CheckReport& report) {
  std::string text;
  const std::vector<NotJudged>& all = report.not_judged;
  const std::size_t told = std::min(all.size(), reasons_told);
  for (std::size_t i = 0; i < told; ++i) text += (i == 0 ? "; not judged: " : ", ") + all[i].what;
  if (all.size() > told) text += fmt::format(" and {} more", all.size() - told);
  return text;
}

namespace check {

namespace {

std::string phrase(const Cause& cause, bool nodes, Field field, std::size_t places) {
  const std::string who =
      fmt::format("{} {}{}", places, nodes ? "node" : "particle", places == 1 ? "" : "s");
  const int collider = cause.collider + 1;
  switch (cause.kind) {
    case Cause::Kind::rounding:
      return fmt::format("{} of {} (small beside rounding)", name(field), who);
    case Cause::Kind::solve:
      return fmt::format("{} of {} (small beside the solve's tolerance)", name(field), who);
    case Cause::Kind::chaos:
      return fmt::format("{} of {} (rounding has grown too far)", name(field), who);
    case Cause::Kind::light_node:
      return nodes ? fmt::format("{} lighter than rounding can tell", who)
                   : fmt::format("{} near nodes lighter than rounding can tell", who);
    case Cause::Kind::contact:
      return nodes ? fmt::format("contact at {} on the surface of collider {}", who, collider)
                   : fmt::format("{} in doubtful contact with collider {}", who, collider);
    case Cause::Kind::normal:
      return fmt::format("contact of {} where collider {} has no definite normal", who, collider);
    case Cause::Kind::indefinite: return fmt::format("{} after an indefinite implicit solve", who);
    case Cause::Kind::singular:
      return fmt::format("{} with a nearly singular deformation gradient", who);
  }
  return who;
}

}  // namespace

void NotJudgedCounts::add(Cause cause, Field field, std::int64_t place) {
  const bool by_field = cause.kind == Cause::Kind::rounding || cause.kind == Cause::Kind::solve ||
                        cause.kind == Cause::Kind::chaos;
  Count& count = counts_[{cause, is_node_field(field), by_field ? field : Field::node_mass}];
  ++count.numbers;
  count.places.insert(place);
}

void NotJudgedCounts::add(const NotJudgedCounts& more) {
  for (const auto& [key, count] : more.counts_) {
    Count& sum = counts_[key];
    sum.numbers += count.numbers;
    sum.places.insert(count.places.begin(), count.places.end());
  }
}

std::vector<NotJudged> NotJudgedCounts::summary() const {
  std::vector<NotJudged> all;
  for (const auto& [key, count] : counts_)
    all.push_back({phrase(key.cause, key.nodes, key.field, count.places.size()), count.numbers,
                   static_cast<std::int64_t>(count.places.size())});
  std::stable_sort(all.begin(), all.end(),
                   [](const NotJudged& a, const NotJudged& b) { return a.numbers > b.numbers; });
  return all;
}

}  // namespace check

}  // namespace firn
