// SPDX-License-Identifier: BSD-3-Clause
#include "firn/memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <sys/resource.h>

#include "firn/error.hpp"

namespace firn {

namespace {

namespace fs = std::filesystem;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The number in a file that holds one; none for "max" or where there is no file.
std::optional<double> number_in(const fs::path& path) {
  std::ifstream file(path);
  double value = 0;
  if (file >> value) return value;
  return std::nullopt;
}

/// The number behind a key in a file of "key value" lines.
std::optional<double> number_in(const fs::path& path, const std::string& key) {
  std::ifstream file(path);
  std::string name;
  double value = 0;
  for (std::string line; std::getline(file, line);)
    if (std::istringstream words(line); words >> name >> value && name == key) return value;
  return std::nullopt;
}

/// Of the group and every group above it, the least that is left. Cached files count as free.
double left_in_groups(const fs::path& mount, const std::string& group, const char* limit,
                      const char* usage, const char* cached) {
  double least = infinite;
  for (fs::path path = fs::path(group).relative_path();; path = path.parent_path()) {
    const fs::path folder = mount / path;
    if (const auto most = number_in(folder / limit)) {
      const double used = number_in(folder / usage).value_or(0);
      const double freed = number_in(folder / "memory.stat", cached).value_or(0);
      least = std::min(least, std::max(0.0, *most - std::max(0.0, used - freed)));
    }
    if (path.empty()) return least;
  }
}

double left_in_control_groups(const fs::path& root) {
  double least = infinite;
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty())
      least = std::min(least, left_in_groups(root / "sys/fs/cgroup", group, "memory.max",
                                             "memory.current", "inactive_file"));
    else if (("," + controllers + ",").find(",memory,") != std::string::npos)
      least = std::min(least,
                       left_in_groups(root / "sys/fs/cgroup/memory", group, "memory.limit_in_bytes",
                                      "memory.usage_in_bytes", "total_inactive_file"));
  }
  return least;
}

double left_in_address_space(const fs::path& root) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return infinite;
  const double used = 1024 * number_in(root / "proc/self/status", "VmSize:").value_or(0);
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - used);
}

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

/// Share of a coarse lattice in the box that lies in the shape.
double filled_share(const Shape& shape, const Bounds& box) {
  constexpr int n = 24;
  int inside = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 u = (Vec3(i, j, k).array() + 0.5) / n;
        inside += contains(shape, box.min + u.cwiseProduct(box.max - box.min)) ? 1 : 0;
      }
  return static_cast<double>(inside) / (n * n * n);
}

}  // namespace

double available_memory(const fs::path& root) {
  const auto kilobytes = number_in(root / "proc/meminfo", "MemAvailable:");
  return std::min({kilobytes ? 1024 * *kilobytes : infinite, left_in_control_groups(root),
                   left_in_address_space(root)});
}

double expected_particles(const GridSettings& grid, const Body& body) {
  if (body.sampling == Sampling::from_file) return static_cast<double>(body.particles.size());
  const std::optional<Bounds> box = bounds(body.shape);
  if (!box || !(box->min.array() < box->max.array()).all()) return 0;
  const double cells = ((box->max - box->min) / grid.spacing).prod();
  return cells * body.particles_per_cell * filled_share(body.shape, *box);
}

double run_bytes_per_particle(Pace pace, Precision precision) {
  if (pace != Pace::fast) return 1250;
  return precision == Precision::float32 ? 1100 : 1400;
}

double check_bytes_per_particle() { return 4500; }

void require_memory(const std::string& where, double particles, double bytes_per_particle,
                    double available) {
  const double bytes = particles * bytes_per_particle;
  if (bytes <= available) return;
  char count[32];
  std::snprintf(count, sizeof count, "%.3g", particles);
  throw InputError(where, "memory for about " + std::string(count) + " particles", gigabytes(bytes),
                   "the " + gigabytes(available) + " available");
}

}  // namespace firn
