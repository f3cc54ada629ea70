// SPDX-License-Identifier: BSD-3-Clause
/// random_scenes: draws scenes, compares a solver with the reference on each, shrinks
/// those that fail to small scene files. Same seeds, same scenes, on every machine.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

#include "firn/error.hpp"
#include "firn/registry.hpp"
#include "io/scene/scene_file.hpp"
#include "solvers/solvers.hpp"
#include "verification/fuzz/random/compare.hpp"

namespace {

using namespace firn;

struct Arguments {
  std::uint64_t seed = 1;
  std::int64_t count = 100;
  std::string solver = "optimized", out = ".";
  std::vector<std::string> precisions = {"double", "float"};
  int threads = 1;
  RandomOptions random;
};

struct Tally {
  std::int64_t comparisons = 0, invalid = 0, stopped = 0, numbers = 0;
  double largest_in_bounds = 0;
};

Precision precision_from(const std::string& text) {
  if (text == "double") return Precision::float64;
  if (text == "float") return Precision::float32;
  throw InputError("--precision", "unknown precision", text, "double or float");
}

class Comparisons {
 public:
  explicit Comparisons(const Arguments& arguments) : arguments_(arguments) {
    register_solvers(registry_);
  }

  int run() {
    for (std::int64_t i = 0; i < arguments_.count; ++i) {
      const std::uint64_t seed = arguments_.seed + static_cast<std::uint64_t>(i);
      const RandomCase c = random_case(seed, arguments_.random);
      for (const std::string& precision : arguments_.precisions) one(c, seed, precision);
    }
    fmt::print(
        "{}: {} scenes from seed {}, {} comparisons of {} numbers, largest error {:.3g} of its "
        "bound; {} invalid, {} where a number is out of range and the solver stops\n",
        tally_.invalid == 0 ? "VALID" : "INVALID", arguments_.count, arguments_.seed,
        tally_.comparisons, tally_.numbers, tally_.largest_in_bounds, tally_.invalid,
        tally_.stopped);
    return tally_.invalid == 0 ? 0 : 1;
  }

 private:
  std::unique_ptr<Solver> make(const std::string& precision) const {
    SolverOptions options;
    options.precision = precision_from(precision);
    options.threads = arguments_.threads;
    return registry_.create(arguments_.solver, options);
  }

  Comparison compared(const RandomCase& c, const std::string& precision) const {
    return compare(
        c, [&] { return registry_.create(reference_name, {}); }, [&] { return make(precision); });
  }

  void one(const RandomCase& c, std::uint64_t seed, const std::string& precision) {
    const Comparison result = compared(c, precision);
    ++tally_.comparisons;
    tally_.numbers += result.compared;
    tally_.largest_in_bounds = std::max(tally_.largest_in_bounds, result.largest_in_bounds);
    if (result.agreement == Agreement::reference_failed) ++tally_.stopped;
    if (result.agreement == Agreement::out_of_range) ++tally_.stopped;
    if (result.agreement != Agreement::invalid) return;
    ++tally_.invalid;
    fmt::print(stderr, "seed {}, {}: {}\n", seed, precision, result.message);
    const RandomCase small = shrink(
        c,
        [&](const RandomCase& smaller) {
          return compared(smaller, precision).agreement == Agreement::invalid;
        },
        arguments_.random.max_particles);
    save(small, seed, precision);
  }

  /// The small scene as a file, with the command that shows the failure.
  void save(const RandomCase& small, std::uint64_t seed, const std::string& precision) const {
    const std::filesystem::path path =
        std::filesystem::path(arguments_.out) / fmt::format("random_{}_{}.toml", seed, precision);
    const std::string command = fmt::format(
        "firn check {} --solver {} --precision {} --start-step {} --steps {}",
        path.filename().string(), arguments_.solver, precision, small.start_step, small.steps);
    std::ofstream file(path);
    file << "# " << compared(small, precision).message << "\n# " << command << '\n'
         << resolved_toml(small.scene);
    if (!file.flush()) throw InputError(path.string() + ": cannot be written");
    fmt::print(stderr, "  shrunk to {} particles and {} colliders: {}\n  {}\n",
               sample_bodies(small.scene).size(), small.scene.colliders.size(), path.string(),
               command);
  }

  const Arguments& arguments_;
  Registry registry_;
  Tally tally_;
};

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  arguments.random.mesh_file = FIRN_MESH_FILE;
  CLI::App app{"Compares a solver with the reference on random scenes; failing ones are shrunk."};
  app.add_option("--seed", arguments.seed, "of the first scene; each further one takes the next")
      ->capture_default_str();
  app.add_option("--count", arguments.count, "scenes")->capture_default_str();
  app.add_option("--solver", arguments.solver, "a registered solver, or mutant:NAME")
      ->capture_default_str();
  app.add_option("--precision", arguments.precisions, "double, float, or both")
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "threads of both solvers")->capture_default_str();
  app.add_option("--max-particles", arguments.random.max_particles, "of a scene")
      ->capture_default_str();
  app.add_flag("!--explicit-only", arguments.random.semi_implicit, "no semi-implicit scenes");
  app.add_flag_callback(
      "--no-meshes", [&] { arguments.random.mesh_file.clear(); }, "no shapes from mesh files");
  app.add_option("-o,--out", arguments.out, "folder for failing scenes")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return Comparisons(arguments).run();
  } catch (const InputError& error) {
    std::fprintf(stderr, "random_scenes: %s\n", error.what());
    return 2;
  }
}
