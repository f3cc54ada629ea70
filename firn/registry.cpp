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

std::unique_ptr<Solver> Registry::create(std::string_view name,
                                         const SolverOptions& options) const {
  const SolverEntry* entry = find(name);
  if (entry == nullptr) {
    std::string known;
    for (const SolverEntry& e : entries_) known += (known.empty() ? "" : ", ") + e.name;
    throw InputError("--solver", "unknown solver", std::string(name), known);
  }
  const auto& supported = entry->precisions;
  if (std::find(supported.begin(), supported.end(), options.precision) == supported.end()) {
    std::string known;
    for (const Precision p : supported)
      known += (known.empty() ? "" : ", ") + std::string(firn::name(p));
    throw InputError("--precision", "not supported by solver " + entry->name,
                     std::string(firn::name(options.precision)), known);
  }
  return entry->create(options);
}

}  // namespace firn
