/// firn solvers: what is registered.

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "cli/verbs.hpp"

namespace firn::cli {

namespace {

std::string precisions(const SolverEntry& entry) {
  std::string text;
  for (const Precision p : entry.precisions)
    text += (text.empty() ? "" : ",") + std::string(name(p));
  return text;
}

void print_solvers(const Registry& registry, bool json) {
  if (json) {
    nlohmann::json list = nlohmann::json::array();
    for (const SolverEntry& entry : registry.entries()) {
      nlohmann::json names = nlohmann::json::array();
      for (const Precision p : entry.precisions) names.push_back(name(p));
      list.push_back({{"name", entry.name},
                      {"precisions", names},
                      {"semi_implicit", entry.semi_implicit},
                      {"description", entry.description}});
    }
    fmt::print("{}\n", list.dump(2));
    return;
  }
  for (const SolverEntry& entry : registry.entries())
    fmt::print("{:<12} {:<13} {:<23} {}\n", entry.name, precisions(entry),
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
