// SPDX-License-Identifier: BSD-3-Clause
#include "io/scene/toml_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace firn {

namespace {

constexpr std::size_t longest_value = 60;  // of a shown value, in bytes

std::string joined(std::initializer_list<std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

/// (Spelled with append: g++ 12 warns wrongly about `"x" + string`, PR105651.)
std::string in_quotes(std::string_view text) {
  return std::string(1, '"').append(text).append(1, '"');
}

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table: return "a table";
    case toml::node_type::array: return "an array";
    case toml::node_type::string: return "a string";
    case toml::node_type::integer: return "an integer";
    case toml::node_type::floating_point: return "a number";
    case toml::node_type::boolean: return "a boolean";
    case toml::node_type::date:
    case toml::node_type::time:
    case toml::node_type::date_time: return "a date or time";
    default: return "nothing";
  }
}

std::string at_line(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(std::max<unsigned>(1, source.begin.line));
}

}  // namespace

bool Range::holds(double value) const {
  return (low_included ? value >= low : value > low) &&
         (high_included ? value <= high : value < high);
}

std::string Range::text() const {
  std::string text = low_included ? "[" : "(";
  text += to_text(low) + ", " + to_text(high) + (high_included ? "]" : ")");
  if (!unit.empty()) text.append(" ").append(unit);
  return text;
}

std::string show(const toml::node& node) {
  if (const auto* string = node.as_string())
    return in_quotes(one_line(string->get(), longest_value));
  if (const auto* integer = node.as_integer()) return std::to_string(integer->get());
  if (const auto* number = node.as_floating_point()) return to_text(number->get());
  if (const auto* boolean = node.as_boolean()) return boolean->get() ? "true" : "false";
  if (const auto* array = node.as_array()) {
    if (array->size() > 4) return "an array of " + std::to_string(array->size());
    std::string text;
    for (const toml::node& element : *array)
      text += (text.empty() ? "" : ", ") +
              (element.is_array() ? std::string(type_name(element)) : show(element));
    return std::string(1, '[').append(text).append(1, ']');
  }
  return std::string(type_name(node));
}

TomlTable::TomlTable(const toml::table& table, std::string file, std::string path)
    : table_(&table), file_(std::move(file)), path_(std::move(path)) {}

std::string TomlTable::path_to(std::string_view key) const {
  const std::string last = one_line(key, longest_value);
  return path_.empty() ? last : path_ + "." + last;
}

std::string TomlTable::where() const {
  const std::string line = at_line(file_, table_->source());
  return path_.empty() ? line : line + ": key `" + path_ + "`";
}

std::string TomlTable::where(std::string_view key) const {
  const toml::node* node = table_->get(key);
  const toml::source_region& source = node != nullptr ? node->source() : table_->source();
  return at_line(file_, source) + ": key `" + path_to(key) + "`";
}

void TomlTable::refuse(std::string_view key, const std::string& what,
                       const std::string& allowed) const {
  const toml::node* node = table_->get(key);
  throw InputError(where(key), what, node != nullptr ? show(*node) : "nothing", allowed);
}

void TomlTable::allow_only(std::initializer_list<std::string_view> keys) const {
  const toml::key* unknown = nullptr;  // the first one in the file
  for (const auto& [key, value] : *table_) {
    if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
    if (unknown == nullptr || key.source().begin < unknown->source().begin) unknown = &key;
  }
  if (unknown == nullptr) return;
  throw InputError(at_line(file_, unknown->source()) + ": key `" + path_to(unknown->str()) + "`",
                   "unknown key", show(*table_->get(unknown->str())), joined(keys));
}

const toml::node& TomlTable::required(std::string_view key, const std::string& allowed) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) refuse(key, "missing", allowed);
  return *node;
}

double TomlTable::checked(const toml::node& node, std::string_view key, const std::string& what,
                          const Range& range, const std::string& allowed) const {
  if (!node.is_number()) refuse(key, "wrong type" + what, allowed);
  const auto* whole = node.as_integer();
  const double value =
      whole != nullptr ? static_cast<double>(whole->get()) : node.as_floating_point()->get();
  if (!std::isfinite(value)) refuse(key, "not finite" + what, allowed);
  if (!range.holds(value)) refuse(key, "out of range" + what, allowed);
  return value;
}

double TomlTable::number(std::string_view key, const Range& range) const {
  const std::string allowed = "a number in " + range.text();
  return checked(required(key, allowed), key, "", range, allowed);
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t low, std::int64_t high) const {
  const std::string allowed =
      "an integer in [" + std::to_string(low) + ", " + std::to_string(high) + "]";
  const auto* integer = required(key, allowed).as_integer();
  if (integer == nullptr) refuse(key, "wrong type", allowed);
  if (integer->get() < low || integer->get() > high) refuse(key, "out of range", allowed);
  return integer->get();
}

bool TomlTable::boolean(std::string_view key) const {
  const auto* boolean = required(key, "true or false").as_boolean();
  if (boolean == nullptr) refuse(key, "wrong type", "true or false");
  return boolean->get();
}

Vec3 TomlTable::vec3(std::string_view key, const Range& range) const {
  const std::string allowed = "an array of 3 numbers in " + range.text();
  const toml::array* array = required(key, allowed).as_array();
  if (array == nullptr) refuse(key, "wrong type", allowed);
  if (array->size() != 3) refuse(key, "wrong length", allowed);
  Vec3 value;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::array<const char*, 3> in_axis = {" in x", " in y", " in z"};
    value[axis] = checked(*array->get(static_cast<std::size_t>(axis)), key,
                          in_axis[static_cast<std::size_t>(axis)], range, allowed);
  }
  return value;
}

std::string TomlTable::text(std::string_view key) const {
  const std::string allowed = "a string of 1 to 4096 bytes on one line";
  const auto* string = required(key, allowed).as_string();
  if (string == nullptr) refuse(key, "wrong type", allowed);
  const std::string& value = string->get();
  if (value.empty()) refuse(key, "empty", allowed);
  if (value.size() > 4096) refuse(key, "too long", allowed);
  if (one_line(value) != value) refuse(key, "control character", allowed);
  return value;
}

std::string TomlTable::word(std::string_view key, const std::string& allowed) const {
  const auto* string = required(key, allowed).as_string();
  if (string == nullptr) refuse(key, "wrong type", allowed);
  return string->get();
}

int TomlTable::choice(std::string_view key, std::initializer_list<std::string_view> choices) const {
  std::string allowed;
  for (const std::string_view choice : choices)
    allowed.append(allowed.empty() ? "\"" : ", \"").append(choice).append("\"");
  const std::string text = word(key, allowed);
  const auto found = std::find(choices.begin(), choices.end(), std::string_view(text));
  if (found == choices.end()) refuse(key, "unknown value", allowed);
  return static_cast<int>(found - choices.begin());
}

TomlTable TomlTable::table(std::string_view key) const {
  const toml::table* table = required(key, "a table").as_table();
  if (table == nullptr) refuse(key, "wrong type", "a table");
  return {*table, file_, path_to(key)};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  std::vector<TomlTable> tables;
  const toml::node* node = table_->get(key);
  if (node == nullptr) return tables;
  const std::string allowed = "tables, each under its own [[" + std::string(key) + "]]";
  const toml::array* array = node->as_array();
  if (array == nullptr) refuse(key, "wrong type", allowed);
  for (const toml::node& element : *array) {
    if (!element.is_table()) refuse(key, "wrong type", allowed);
    std::string path = path_to(key);
    path.append(1, '[').append(std::to_string(tables.size())).append(1, ']');
    tables.emplace_back(*element.as_table(), file_, path);
  }
  return tables;
}

double TomlTable::number_or(std::string_view key, const Range& range, double otherwise) const {
  return has(key) ? number(key, range) : otherwise;
}

Vec3 TomlTable::vec3_or(std::string_view key, const Range& range, const Vec3& otherwise) const {
  return has(key) ? vec3(key, range) : otherwise;
}

bool TomlTable::boolean_or(std::string_view key, bool otherwise) const {
  return has(key) ? boolean(key) : otherwise;
}

bool TomlTable::is_number(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_number();
}

bool TomlTable::is_text(std::string_view key, std::string_view value) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_string() && node->as_string()->get() == value;
}

bool TomlTable::is_infinite(std::string_view key) const {
  if (is_text(key, "inf")) return true;
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_floating_point() &&
         node->as_floating_point()->get() == HUGE_VAL;
}

}  // namespace firn
