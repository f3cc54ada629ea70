// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// A TOML table whose getters check presence, type and range. Every error is one
/// line that names file, line, key, value and what is allowed.

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

#include "firn/error.hpp"
#include "firn/types.hpp"
#include "io/one_line.hpp"

namespace firn {

/// Interval of allowed numbers, printed as mathematicians do: "(0, 1e+09] m".
/// The far ends are finite on purpose: they keep h³, masses and node indices
/// representable, and no physical scene comes near them.
struct Range {
  double low = 0, high = 0;
  bool low_included = true, high_included = true;
  std::string_view unit = {};

  bool holds(double value) const;  ///< false for NaN
  std::string text() const;
};

/// [low, high]
constexpr Range closed(double low, double high, std::string_view unit = {}) {
  return {low, high, true, true, unit};
}
/// (0, high]
constexpr Range positive(double high, std::string_view unit = {}) {
  return {0, high, false, true, unit};
}
/// (low, high)
constexpr Range open(double low, double high, std::string_view unit = {}) {
  return {low, high, false, false, unit};
}
/// [−1e9, 1e9]
constexpr Range any(std::string_view unit = {}) { return closed(-1e9, 1e9, unit); }

/// A value as messages show it: 3, "snow", [0, 0, 1], a table.
std::string show(const toml::node& node);

class TomlTable {
 public:
  /// `path`: the table's own key, "" for the file as a whole.
  TomlTable(const toml::table& table, std::string file, std::string path = {});

  /// Throws InputError for the first key that is not among `keys`.
  void allow_only(std::initializer_list<std::string_view> keys) const;

  bool has(std::string_view key) const { return table_->contains(key); }
  bool is_number(std::string_view key) const;
  bool is_text(std::string_view key, std::string_view value) const;

  // Required values.
  double number(std::string_view key, const Range& range) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high) const;
  bool boolean(std::string_view key) const;
  Vec3 vec3(std::string_view key, const Range& range) const;
  /// Not empty, at most 4096 bytes, no control characters.
  std::string text(std::string_view key) const;
  /// A string that the caller compares with the words in `allowed`.
  std::string word(std::string_view key, const std::string& allowed) const;
  /// Place of the string among `choices`.
  int choice(std::string_view key, std::initializer_list<std::string_view> choices) const;
  TomlTable table(std::string_view key) const;

  /// Tables of an array of tables `[[key]]`; empty if there is none.
  std::vector<TomlTable> tables(std::string_view key) const;

  // Optional values with their neutral default.
  double number_or(std::string_view key, const Range& range, double otherwise) const;
  Vec3 vec3_or(std::string_view key, const Range& range, const Vec3& otherwise) const;
  bool boolean_or(std::string_view key, bool otherwise) const;

  /// The string "inf" or TOML's own inf?
  bool is_infinite(std::string_view key) const;

  /// "FILE:LINE: key `a.b`", at the value of the key or, if missing, at the table.
  std::string where(std::string_view key) const;
  /// "FILE:LINE: key `a`", the table itself.
  std::string where() const;

  /// Throws InputError about the value of `key`.
  [[noreturn]] void refuse(std::string_view key, const std::string& what,
                           const std::string& allowed) const;

 private:
  const toml::node& required(std::string_view key, const std::string& allowed) const;
  std::string path_to(std::string_view key) const;
  double checked(const toml::node& node, std::string_view key, const std::string& what,
                 const Range& range, const std::string& allowed) const;

  const toml::table* table_;
  std::string file_, path_;
};

}  // namespace firn
