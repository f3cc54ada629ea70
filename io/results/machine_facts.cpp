// SPDX-License-Identifier: BSD-3-Clause
#include "io/results/machine_facts.hpp"

#include <fstream>
#include <sstream>
#include <sys/utsname.h>
#include <unistd.h>

#include "firn/build_info.hpp"
#include "firn/machine.hpp"

namespace firn::results {

namespace {

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line.empty() ? "unknown" : line;
}

/// "L1 Data 32K, L1 Instruction 32K, L2 Unified 1024K, …" of the first processor.
std::string caches() {
  std::string text;
  for (int index = 0;; ++index) {
    const std::string folder =
        "/sys/devices/system/cpu/cpu0/cache/index" + std::to_string(index) + "/";
    const std::string level = first_line(folder + "level");
    if (level == "unknown") break;
    text += (text.empty() ? "L" : ", L") + level + " " + first_line(folder + "type") + " " +
            first_line(folder + "size");
  }
  return text.empty() ? "unknown" : text;
}

/// The value behind "key" in a file of "key : value" lines.
std::string line_value(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key, 0) != 0) continue;
    const std::size_t start = line.find_first_not_of(" \t", line.find(':') + 1);
    return start == std::string::npos ? "unknown" : line.substr(start);
  }
  return "unknown";
}

/// "FIRN_NO_SKIP=all": what changes the solvers from outside; "none".
std::string environment() {
  std::string text;
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (const std::string variable = *entry;
        variable.rfind("FIRN_", 0) == 0 && variable.rfind("FIRN_PYTHON", 0) != 0)
      text += (text.empty() ? "" : " ") + variable;
  return text.empty() ? "none" : text;
}

std::string load_average() {
  std::istringstream text(first_line("/proc/loadavg"));
  std::string one, five, fifteen;
  text >> one >> five >> fifteen;
  return one + " (1 min), " + five + " (5 min)";
}

}  // namespace

Facts machine_facts(std::uint64_t seed, const std::string& instruction_set) {
  utsname system{};
  uname(&system);
  const BuildInfo& build = build_info();
  return {
      {"processor", processor_name()},
      {"processors", static_cast<double>(available_processors())},
      {"caches", caches()},
      {"memory", line_value("/proc/meminfo", "MemTotal")},
      {"system", std::string(system.sysname) + " " + system.release + " " + system.machine},
      {"frequency_governor", first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")},
      {"frequency_now_MHz", line_value("/proc/cpuinfo", "cpu MHz")},
      {"load_average", load_average()},
      {"instruction_set", instruction_set},
      {"compiler", build.compiler},
      {"flags", build.flags},
      {"build_type", build.build_type},
      {"git_commit", build.git_commit},
      {"firn_version", build.version},
      {"seed", static_cast<double>(seed)},
      {"environment", environment()},
  };
}

const std::vector<std::string>& comparable_facts() {
  static const std::vector<std::string> facts = {"processor",  "compiler",        "flags",
                                                 "git_commit", "instruction_set", "environment"};
  return facts;
}

}  // namespace firn::results
