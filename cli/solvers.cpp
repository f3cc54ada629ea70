/// firn solvers: what is registered.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/verbs.hpp"

namespace firn::cli {

namespace {

std::vector<std::string_view> precisions(const SolverEntry& entry) {
  std::vector<std::string_view> names;
  for (const Precision p : entry.precisions) names.push_back(name(p));
  return names;
}

void print_solvers(const Registry& registry, bool json) {
  if (json) {
    nlohmann::json list = nlohmann::json::array();
    for (const SolverEntry& entry : registry.entries()) {
      list.push_back({{"name", entry.name},
                      {"precisions", precisions(entry)},
                      {"semi_implicit", entry.semi_implicit},
                      {"description", entry.description}});
    }
    fmt::print("{}\n", list.dump(2));
    return;
  }
  for (const SolverEntry& entry : registry.entries())
    fmt::print("{:<12} {:<13} {:<23} {}\n", entry.name,
               fmt::format("{}", fmt::join(precisions(entry), ",")),
               entry.semi_implicit ? "explicit,semi-implicit" : "explicit", entry.description);
}

}  // namespace

void add_solvers(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("solvers", "registered solvers, one a line, name first");
  auto json = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "machine-readable");
  verb->callback([json, &context] { print_solvers(context.registry, *json); });
}

}  // namespace firn::cli
