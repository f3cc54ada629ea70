// SPDX-License-Identifier: BSD-3-Clause
/// firn info: build, processor, instruction set, versions.

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <H5public.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "cli/verbs.hpp"
#include "firn/build_info.hpp"
#include "firn/machine.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "solvers/solvers.hpp"

namespace firn::cli {

namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

Rows info_rows() {
  const BuildInfo& build = build_info();
  return {{"version", build.version},
          {"git_commit", build.git_commit},
          {"compiler", build.compiler},
          {"build_type", build.build_type},
          {"flags", build.flags},
          {"processor", processor_name()},
          {"processors", std::to_string(available_processors())},
          {"instruction_set", instruction_set()},
          {"eigen",
           fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"hdf5", hdf5_version()},
          {"openvdb", has_openvdb() ? "yes" : "no: no mesh or level-set shapes"}};
}

void print_info(bool json) {
  const Rows rows = info_rows();
  if (json) {
    nlohmann::ordered_json object;
    for (const auto& [key, value] : rows) object[key] = value;
    fmt::print("{}\n", object.dump(2));
    return;
  }
  for (const auto& [key, value] : rows) fmt::print("{:<16} {}\n", key, value);
}

}  // namespace

void add_info(CLI::App& app, Context&) {
  CLI::App* verb =
      app.add_subcommand("info", "prints build, processor, instruction set and versions");
  auto json = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "print JSON");
  verb->callback([json] { print_info(*json); });
}

}  // namespace firn::cli
