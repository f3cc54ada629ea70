// SPDX-License-Identifier: BSD-3-Clause
#include "io/scene/toml_text.hpp"

#include <cmath>
#include <sstream>

#include "firn/error.hpp"

namespace firn {

std::string toml_string(const std::string& text) {
  std::string quoted(1, '"');
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

std::string toml_number(double value) {
  if (std::isinf(value)) return "\"inf\"";
  const std::string text = to_text(value);
  // to_text(-0.0) is "-0", which TOML would read as the integer 0.
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string toml_vector(const Vec3& v) {
  std::ostringstream out;
  out << '[' << toml_number(v.x()) << ", " << toml_number(v.y()) << ", " << toml_number(v.z())
      << ']';
  return out.str();
}

}  // namespace firn
