// SPDX-License-Identifier: BSD-3-Clause
#include "optimized/skips.hpp"

#include <cstdlib>

#include "firn/error.hpp"

namespace firn::optimized {

SkipSet SkipSet::from_text(std::string_view names) {
  SkipSet s;
  while (!names.empty()) {
    const std::size_t comma = names.find(',');
    const std::string_view name = names.substr(0, comma);
    names = comma == std::string_view::npos ? std::string_view() : names.substr(comma + 1);
    const bool all = name == "all";
    bool known = all;
    const auto turn_off = [&](std::string_view skip, bool& value) {
      if (!all && name != skip) return;
      value = false;
      known = true;
    };
    turn_off("box", s.kernels.box);
    turn_off("contact", s.contact);
    turn_off("empty", s.empty);
    turn_off("fields", s.fields);
    turn_off("friction", s.friction);
    turn_off("hardening", s.kernels.hardening);
    turn_off("material", s.material);
    turn_off("plastic", s.kernels.plastic);
    turn_off("rest", s.kernels.rest);
    turn_off("volumes", s.volumes);
    if (!known)
      throw InputError("FIRN_NO_SKIP", "name of a skip", std::string(name),
                       "all, box, contact, empty, fields, friction, hardening, "
                       "material, plastic, rest, volumes");
  }
  return s;
}

SkipSet SkipSet::from_environment() {
  const char* names = std::getenv("FIRN_NO_SKIP");
  return from_text(names == nullptr ? "" : names);
}

}  // namespace firn::optimized
