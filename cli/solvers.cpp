// SPDX-License-Identifier: BSD-3-Clause
/// firn solvers: what is registered.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/verbs.hpp"
#include "verification/mutants/mutants.hpp"

namespace firn::cli {

namespace {

std::string integrators(const SolverTraits& traits) {
  if (!traits.semi_implicit) return "explicit";
  return traits.explicit_euler ? "explicit,semi-implicit" : "semi-implicit";
}

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
                      {"semi_implicit", registry.traits(entry.name).semi_implicit},
                      {"description", entry.description}});
    }
    fmt::print("{}\n", list.dump(2));
    return;
  }
  for (const SolverEntry& entry : registry.entries())
    fmt::print("{:<12} {:<13} {:<23} {}\n", entry.name,
               fmt::format("{}", fmt::join(precisions(entry), ",")),
               integrators(registry.traits(entry.name)), entry.description);
}

/// "stage 3" or, for a mistake of several stages, "stage 3 …".
std::string place(const Mutant& mutant) {
  return fmt::format("{} {}{}", number(mutant.stage), name(mutant.stage),
                     mutant.several ? " ..." : "");
}

void print_mutants(bool json) {
  if (json) {
    nlohmann::json list = nlohmann::json::array();
    for (const Mutant& mutant : all_mutants())
      list.push_back({{"name", "mutant:" + mutant.name},
                      {"stage", name(mutant.stage)},
                      {"several_stages", mutant.several},
                      {"mistake", mutant.mistake},
                      {"origin", mutant.origin},
                      {"needs", mutant.needs},
                      {"check_sees_it", mutant.check_sees_it}});
    fmt::print("{}\n", list.dump(2));
    return;
  }
  for (const Mutant& mutant : all_mutants())
    fmt::print("mutant:{:<32} {:<24} {}\n", mutant.name, place(mutant), mutant.mistake);
}

}  // namespace

void add_solvers(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("solvers", "lists the registered solvers, one per line, name first");
  auto json = std::make_shared<bool>(false);
  auto mutants = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "print JSON");
  verb->add_flag("--mutants", *mutants, "list the deliberately wrong solvers instead");
  verb->callback([json, mutants, &context] {
    if (*mutants)
      print_mutants(*json);
    else
      print_solvers(context.registry, *json);
  });
}

}  // namespace firn::cli
