// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Numbers of which a check cannot say that they are right: their bounds are wider than
/// 1e-3 of the field's size in that step, or there is none.

#include <cstdint>
#include <map>
#include <string>
#include <unordered_set>
#include <vector>

#include "firn/stage.hpp"
#include "verification/check/cause.hpp"

namespace firn {

struct CheckReport;

/// One reason, over all steps.
struct NotJudged {
  std::string what;          ///< a phrase: "contact at 12 nodes on the surface of collider 1"
  std::int64_t numbers = 0;  ///< components, counted in every comparison
  std::int64_t places = 0;   ///< different nodes or particles
};

/// "; not judged: contact at 12 nodes on the surface of collider 1, …": the reasons with the most
/// numbers; empty if everything was judged.
std::string not_judged_text(const CheckReport& report);

namespace check {

/// Collects them while a check runs.
class NotJudgedCounts {
 public:
  /// A node (its grid index as a key) or a particle (its id), once for each number.
  void add(Cause cause, Field field, std::int64_t place);
  void add(const NotJudgedCounts& more);
  /// Most numbers first.
  std::vector<NotJudged> summary() const;

 private:
  struct Key {
    Cause cause;
    bool nodes = false;
    Field field = Field::node_mass;  ///< told for rounding, solve and chaos alone
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  struct Count {
    std::int64_t numbers = 0;
    std::unordered_set<std::int64_t> places;
  };
  std::map<Key, Count> counts_;
};

}  // namespace check

}  // namespace firn
