// SPDX-License-Identifier: BSD-3-Clause
#include "firn/registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "firn/error.hpp"

namespace firn {

std::string_view name(Precision precision) {
  return precision == Precision::float64 ? "double" : "float";
}

void Registry::add(SolverEntry entry) {
  if (find(entry.name) != nullptr) throw std::logic_error("solver registered twice: " + entry.name);
  entries_.push_back(std::move(entry));
}

const SolverEntry* Registry::find(std::string_view name) const {
  const auto it = std::find_if(entries_.begin(), entries_.end(),
                               [&](const SolverEntry& entry) { return entry.name == name; });
  return it == entries_.end() ? nullptr : &*it;
}

std::function<bool(const std::string&)> begins_with(std::string prefix) {
  return [prefix = std::move(prefix)](const std::string& name) { return name.starts_with(prefix); };
}

void Registry::add_family(SolverFamily family) { families_.push_back(std::move(family)); }

namespace {

/// "reference, optimized, mutant:NAME": what --solver may be.
std::string known_names(const Registry& registry) {
  std::string known;
  const auto add = [&](const std::string& name) { known += (known.empty() ? "" : ", ") + name; };
  for (const SolverEntry& entry : registry.entries()) add(entry.name);
  for (const SolverFamily& family : registry.families()) add(family.form);
  return known;
}

void require_precision(const SolverEntry& entry, Precision precision) {
  const auto& supported = entry.precisions;
  if (std::find(supported.begin(), supported.end(), precision) != supported.end()) return;
  std::string known;
  for (const Precision p : supported) known += (known.empty() ? "" : ", ") + std::string(name(p));
  throw InputError("--precision", "not supported by solver " + entry.name,
                   std::string(name(precision)), known);
}

}  // namespace

std::unique_ptr<Solver> Registry::create(const std::string& name,
                                         const SolverOptions& options) const {
  if (const SolverEntry* entry = find(name)) {
    require_precision(*entry, options.precision);
    return entry->create(options);
  }
  for (const SolverFamily& family : families_)
    if (family.has(name)) return family.create(name, options);
  throw InputError("--solver", "unknown solver", name, known_names(*this));
}

SolverTraits Registry::traits(const std::string& name) const {
  SolverOptions options;
  const SolverEntry* entry = find(name);
  if (entry != nullptr && !entry->precisions.empty()) options.precision = entry->precisions.front();
  return create(name, options)->traits();
}

}  // namespace firn
