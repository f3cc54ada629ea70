#include "io/results/results_file.hpp"

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <hdf5.h>
#include <string_view>

#include "firn/build_info.hpp"
#include "firn/error.hpp"
#include "io/results/hdf5_text.hpp"

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

void write_facts(hid_t group, const Facts& facts) {
  for (const auto& [key, value] : facts) {
    if (const auto* number = std::get_if<double>(&value))
      h5::write_attribute(group, key, *number);
    else
      h5::write_attribute(group, key, std::get<std::string>(value));
  }
}

void write_quantity(hid_t group, const Quantity& quantity) {
  const h5::Id set = h5::write_dataset(group, quantity.name, quantity.values);
  h5::write_attribute(set, "units", quantity.units);
  h5::write_attribute(set, "meaning", quantity.meaning);
  h5::write_attribute(set, "better", std::string(name(quantity.better)));
  h5::write_attribute(set, "timed", quantity.timed ? 1.0 : 0.0);
}

void write_case(hid_t file, const Case& result, int session) {
  const h5::Id suite = h5::open_or_create_group(file, "cases/" + link_name(result.suite));
  const std::string link = link_name(result.name);
  if (H5Lexists(suite, link.c_str(), H5P_DEFAULT) > 0) H5Ldelete(suite, link.c_str(), H5P_DEFAULT);
  const h5::Id group = h5::open_or_create_group(suite, link);
  h5::write_attribute(group, "title", result.title);
  h5::write_attribute(group, "command", result.command);
  h5::write_attribute(group, "status", std::string(results::name(result.status)));
  h5::write_attribute(group, "message", result.message);
  h5::write_attribute(group, "validation", result.validation);
  h5::write_attribute(group, "session", static_cast<double>(session));
  h5::write_attribute(group, "wall_seconds", result.wall_seconds);
  h5::write_attribute(group, "processor_seconds", result.processor_seconds);
  h5::write_attribute(group, "finished", now_utc());
  const h5::Id parameters = h5::open_or_create_group(group, "parameters");
  write_facts(parameters, result.parameters);
  const h5::Id quantities = h5::open_or_create_group(group, "quantities");
  for (const Quantity& quantity : result.quantities) write_quantity(quantities, quantity);
  const h5::Id set = h5::write_dataset(group, "calibration", result.calibration);
  h5::write_attribute(set, "units", "s");
}

}  // namespace

ResultsFile::ResultsFile(std::string path, const Facts& machine,
                         const std::vector<std::string>& comparable)
    : path_(std::move(path)) {
  const bool exists = fs::exists(path_);
  if (exists) {
    const h5::Id file = h5::open_file(path_, /*writable=*/false);
    if (h5::read_attribute(file, "format") != "firn-results")
      throw InputError(path_, "attribute format of /", h5::read_attribute(file, "format"),
                       "firn-results");
    const h5::Id sessions = h5::open_or_create_group(file, "sessions");
    session_ = static_cast<int>(h5::children(sessions).size());
    const h5::Id first = h5::open_or_create_group(sessions, "0");
    for (const auto& [key, value] : machine) {
      const auto* text = std::get_if<std::string>(&value);
      bool compared = false;
      for (const std::string& wanted : comparable) compared = compared || wanted == key;
      if (!compared || !text) continue;
      const std::string before = h5::read_attribute(first, key);
      if (before != *text)
        throw InputError(path_, key + " of the results already in it", before,
                         *text + " (this build and machine), or another file with -o");
    }
  } else if (fs::path(path_).has_parent_path()) {
    fs::create_directories(fs::path(path_).parent_path());
  }
  rewrite([&](hid_t file) {
    if (!exists) {
      h5::write_attribute(file, "format", "firn-results");
      h5::write_attribute(file, "version", static_cast<double>(schema_version));
      h5::write_attribute(file, "firn_version", build_info().version);
    }
    const h5::Id session = h5::open_or_create_group(file, "sessions/" + std::to_string(session_));
    write_facts(session, machine);
    h5::write_attribute(session, "started", now_utc());
  });
}

template <class Write>
void ResultsFile::rewrite(const Write& write) {
  const std::string next = path_ + ".part";
  if (fs::exists(path_))
    fs::copy_file(path_, next, fs::copy_options::overwrite_existing);
  else
    fs::remove(next);
  {
    const h5::Id file = fs::exists(next) ? h5::open_file(next, true) : h5::create_file(next);
    write(file.get());
  }
  fs::rename(next, path_);
}

bool ResultsFile::has(const std::string& suite, const std::string& name) const {
  const h5::Id file = h5::open_file(path_, false);
  const std::string path = "cases/" + link_name(suite) + "/" + link_name(name);
  if (!h5::exists(file, path)) return false;
  const h5::Id group = h5::open_or_create_group(file, path);
  const std::string status = h5::read_attribute(group, "status");
  return status == "measured" || status == "invalid";
}

void ResultsFile::append(const Case& result) {
  rewrite([&](hid_t file) { write_case(file, result, session_); });
}

void ResultsFile::append_verification(const std::string& subject, const std::string& command,
                                      const std::vector<Check>& checks) {
  rewrite([&](hid_t file) {
    const h5::Id verify = h5::open_or_create_group(file, "verify");
    const std::string link = link_name(subject);
    if (H5Lexists(verify, link.c_str(), H5P_DEFAULT) > 0)
      H5Ldelete(verify, link.c_str(), H5P_DEFAULT);
    const h5::Id group = h5::open_or_create_group(verify, link);
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
    h5::write_attribute(group, "verdict", valid ? "VALID" : "INVALID");
    h5::write_attribute(group, "command", command);
    h5::write_attribute(group, "session", static_cast<double>(session_));
    h5::write_texts(group, "topic", topic);
    h5::write_texts(group, "check", check_name);
    h5::write_attribute(h5::write_dataset(group, "error", error), "units", "bound");
    h5::write_texts(group, "verdict", verdict);
    h5::write_texts(group, "command", commands);
  });
}

void ResultsFile::append_mutants(const std::string& command, const std::vector<Mutant>& mutants) {
  rewrite([&](hid_t file) {
    if (H5Lexists(file, "mutants", H5P_DEFAULT) > 0) H5Ldelete(file, "mutants", H5P_DEFAULT);
    const h5::Id group = h5::open_or_create_group(file, "mutants");
    h5::write_attribute(group, "command", command);
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
    h5::write_texts(group, "name", mutant);
    h5::write_texts(group, "patch", patch);
    h5::write_texts(group, "stage", stage);
    h5::write_texts(group, "named_stage", named);
    h5::write_texts(group, "caught_by", by);
    h5::write_dataset(group, "caught", caught);
  });
}

}  // namespace firn::results
