// SPDX-License-Identifier: BSD-3-Clause
#include "io/output_path.hpp"

#include <fstream>
#include <system_error>

#include "firn/error.hpp"
#include "io/hdf5/read.hpp"
#include "io/one_line.hpp"

namespace firn {

namespace {

namespace fs = std::filesystem;

bool has_format(const fs::path& path, const char* object, const std::string& format) {
  try {
    return hdf5::InputFile(path).text_attribute(object, "format") == format;
  } catch (const InputError&) {
    return false;
  }
}

bool begins_with_all(const fs::path& path, std::initializer_list<std::string_view> words) {
  std::string text(512, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  for (const std::string_view word : words)
    if (text.find(word) == std::string::npos) return false;
  return true;
}

const char* name(OutputKind kind) {
  switch (kind) {
    case OutputKind::trajectory: return "trajectory of Firn";
    case OutputKind::results: return "results file of Firn";
    case OutputKind::junit: return "report of firn verify";
    case OutputKind::lesson: return "lesson of Firn";
    case OutputKind::error_map: return "map of errors of Firn";
  }
  return "";
}

}  // namespace

void require_no_input(const fs::path& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs)
    for (const char* suffix : {"", ".partial", ".partial2", ".part"}) {
      fs::path written = output;
      written += suffix;
      std::error_code error;
      if (!fs::equivalent(written, input, error) || error) continue;
      throw InputError(one_line(written.string()), "output", "an input, " + one_line(input),
                       "a file that is not read");
    }
}

bool is_ours(const fs::path& path, OutputKind kind) {
  switch (kind) {
    case OutputKind::trajectory: return has_format(path, "/firn", "firn-trajectory");
    case OutputKind::results: return has_format(path, "/", "firn-results");
    // GoogleTest writes the file; this is what it calls a whole program's tests.
    case OutputKind::junit: return begins_with_all(path, {"<?xml", "<testsuites", "\"AllTests\""});
    case OutputKind::error_map: return has_format(path, "/firn", "firn-errors");
    case OutputKind::lesson: return begins_with_all(path, {"\"format\":\"firn-lesson\""});
  }
  return false;
}

void require_replaceable(const fs::path& output, OutputKind kind, bool force) {
  std::error_code error;
  if (force || !fs::is_regular_file(output, error) || is_ours(output, kind)) return;
  throw InputError(one_line(output.string()), "output",
                   "an existing file that is no " + std::string(name(kind)),
                   "a new file, or --force to replace it");
}

}  // namespace firn
