// SPDX-License-Identifier: BSD-3-Clause
#include "io/results/results_file.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string_view>

#include "firn/build_info.hpp"
#include "firn/error.hpp"
#include "io/hdf5/read.hpp"
#include "io/hdf5/write.hpp"
#include "io/output_path.hpp"

namespace firn::results {

namespace fs = std::filesystem;

std::string_view name(Status status) {
  switch (status) {
    case Status::measured: return "measured";
    case Status::noisy: return "noisy";
    case Status::invalid: return "invalid";
    case Status::failed: return "failed";
  }
  return "unknown";
}

namespace {

constexpr int schema_version = 1;

std::string_view name(Quantity::Better better) {
  switch (better) {
    case Quantity::Better::lower: return "lower";
    case Quantity::Better::higher: return "higher";
    case Quantity::Better::neither: break;
  }
  return "neither";
}

/// HDF5 names must not hold a slash.
std::string link_name(std::string text) {
  for (char& c : text)
    if (c == '/') c = ':';
  return text;
}

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// A group that is being filled, and its name for messages.
class Group {
 public:
  Group(hid_t location, const std::string& path)
      : path_(path), id_(hdf5::open_or_create_group(location, path)) {}

  hid_t id() const { return id_.get(); }

  void write(const std::string& key, double value) const {
    hdf5::write_number(id(), path_, key.c_str(), value);
  }
  void write(const std::string& key, const std::string& value) const {
    hdf5::write_text(id(), path_, key.c_str(), value);
  }
  void write(const Facts& facts) const {
    for (const auto& [key, value] : facts)
      std::visit([this, &key = key](const auto& known) { write(key, known); }, value);
  }

 private:
  std::string path_;
  hdf5::Id id_;
};

/// The group at `path` in place of an older one.
Group replace_group(hid_t location, const std::string& path) {
  hdf5::remove(location, path);
  return {location, path};
}

void write_quantity(hid_t group, const Quantity& quantity) {
  const std::string& set = quantity.name;
  const hdf5::Id id = hdf5::write_numbers(group, set, quantity.values, quantity.units.c_str());
  hdf5::write_text(id.get(), set, "meaning", quantity.meaning);
  hdf5::write_text(id.get(), set, "better", std::string(name(quantity.better)));
  hdf5::write_number(id.get(), set, "timed", quantity.timed ? 1 : 0);
}

std::string case_path(const std::string& suite, const std::string& name) {
  return "cases/" + link_name(suite) + "/" + link_name(name);
}

void write_case(hid_t file, const Case& result, int session) {
  const Group group = replace_group(file, case_path(result.suite, result.name));
  group.write("title", result.title);
  group.write("command", result.command);
  group.write("status", std::string(results::name(result.status)));
  group.write("message", result.message);
  group.write("validation", result.validation);
  group.write("session", session);
  group.write("wall_seconds", result.wall_seconds);
  group.write("processor_seconds", result.processor_seconds);
  group.write("finished", now_utc());
  Group(group.id(), "parameters").write(result.parameters);
  const Group quantities(group.id(), "quantities");
  for (const Quantity& quantity : result.quantities) write_quantity(quantities.id(), quantity);
  hdf5::write_numbers(group.id(), "calibration", result.calibration, "s");
}

/// "" where there is no such attribute.
std::string text_in(const hdf5::InputFile& file, const std::string& object,
                    const std::string& key) {
  return file.has_attribute(object, key.c_str()) ? file.text_attribute(object, key.c_str()) : "";
}

/// InputError unless `path` holds results that agree with `machine` in the facts named
/// `comparable`. Returns how many sessions have written to it.
int join(const std::string& path, const Facts& machine,
         const std::vector<std::string>& comparable) {
  const hdf5::InputFile file(path);
  if (const std::string format = text_in(file, "/", "format"); format != "firn-results")
    throw InputError(path, "attribute format of /", format, "firn-results");
  for (const auto& [key, value] : machine) {
    const auto* text = std::get_if<std::string>(&value);
    if (!text || std::find(comparable.begin(), comparable.end(), key) == comparable.end()) continue;
    const std::string before = text_in(file, "sessions/0", key);
    if (before != *text)
      throw InputError(path, key + " of the results already in it", before,
                       *text + " (this build and machine), or another file with -o");
  }
  return static_cast<int>(file.children("sessions").size());
}

}  // namespace

ResultsFile::ResultsFile(std::string path, const Facts& machine,
                         const std::vector<std::string>& comparable, bool force)
    : path_(std::move(path)) {
  const bool exists = fs::exists(path_);
  if (exists) require_replaceable(path_, OutputKind::results, force);
  const bool joins =
      exists && !(force && fs::is_regular_file(path_) && !is_ours(path_, OutputKind::results));
  if (joins)
    session_ = join(path_, machine, comparable);
  else if (!exists && fs::path(path_).has_parent_path())
    fs::create_directories(fs::path(path_).parent_path());
  rewrite(joins, [&](hid_t file) {
    if (!joins) {
      const Group root(file, "/");
      root.write("format", "firn-results");
      root.write("version", schema_version);
      root.write("firn_version", build_info().version);
    }
    const Group session(file, "sessions/" + std::to_string(session_));
    session.write(machine);
    session.write("started", now_utc());
  });
}

template <class Write>
void ResultsFile::rewrite(bool keep, const Write& write) {
  const std::string next = path_ + ".part";
  if (keep && fs::exists(path_))
    fs::copy_file(path_, next, fs::copy_options::overwrite_existing);
  else
    fs::remove(next);
  {
    const hdf5::Id file = hdf5::open_or_create_file(next);
    write(file.get());
    hdf5::written(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), next);
  }
  fs::rename(next, path_);
}

bool ResultsFile::has(const std::string& suite, const std::string& name) const {
  const std::string status = text_in(hdf5::InputFile(path_), case_path(suite, name), "status");
  return status == "measured" || status == "invalid";
}

void ResultsFile::append(const Case& result) {
  rewrite(true, [&](hid_t file) { write_case(file, result, session_); });
}

void ResultsFile::append_verification(const std::string& subject, const std::string& command,
                                      const std::vector<Check>& checks) {
  rewrite(true, [&](hid_t file) {
    const Group group = replace_group(file, "verify/" + link_name(subject));
    bool valid = !checks.empty();
    std::vector<std::string> topic, check_name, verdict, commands;
    std::vector<double> error;
    for (const Check& check : checks) {
      valid = valid && check.verdict == "VALID";
      topic.push_back(check.topic);
      check_name.push_back(check.name);
      error.push_back(check.error);
      verdict.push_back(check.verdict);
      commands.push_back(check.command);
    }
    group.write("verdict", valid ? "VALID" : "INVALID");
    group.write("command", command);
    group.write("session", session_);
    hdf5::write_texts(group.id(), "topic", topic);
    hdf5::write_texts(group.id(), "check", check_name);
    hdf5::write_numbers(group.id(), "error", error, "bound");
    hdf5::write_texts(group.id(), "verdict", verdict);
    hdf5::write_texts(group.id(), "command", commands);
  });
}

void ResultsFile::append_mutants(const std::string& command, const std::vector<Mutant>& mutants) {
  rewrite(true, [&](hid_t file) {
    const Group group = replace_group(file, "mutants");
    group.write("command", command);
    std::vector<std::string> mutant, patch, stage, named, by;
    std::vector<double> caught;
    for (const Mutant& m : mutants) {
      mutant.push_back(m.name);
      patch.push_back(m.patch);
      stage.push_back(m.stage);
      named.push_back(m.named_stage);
      by.push_back(m.caught_by);
      caught.push_back(m.caught ? 1 : 0);
    }
    hdf5::write_texts(group.id(), "name", mutant);
    hdf5::write_texts(group.id(), "patch", patch);
    hdf5::write_texts(group.id(), "stage", stage);
    hdf5::write_texts(group.id(), "named_stage", named);
    hdf5::write_texts(group.id(), "caught_by", by);
    hdf5::write_numbers(group.id(), "caught", caught, nullptr);
  });
}

}  // namespace firn::results
