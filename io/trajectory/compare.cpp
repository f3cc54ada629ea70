// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <utility>

#include "io/trajectory/check_particles.hpp"
#include "io/trajectory/reader.hpp"

namespace firn {

namespace {

/// Everything but the id, by which particles are matched.
bool is_compared(const ParticleArray& array) { return std::string_view(array.name) != "id"; }

/// ‖a‖, or ‖a − b‖. NaN where a number is not finite.
double norm(const double* a, const double* b, int components) {
  double sum = 0;
  for (int c = 0; c < components; ++c) {
    const double d = b != nullptr ? a[c] - b[c] : a[c];
    sum += d * d;
  }
  return std::isfinite(sum) ? std::sqrt(sum) : std::numeric_limits<double>::quiet_NaN();
}

/// Places in a and b of the particles that both frames hold.
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

Pairs match_particles(const Particles& a, const Particles& b) {
  std::unordered_map<std::int64_t, std::size_t> place;
  for (std::size_t j = 0; j < b.size(); ++j) place.emplace(b.id[j], j);
  Pairs pairs;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (const auto found = place.find(a.id[i]); found != place.end())
      pairs.emplace_back(i, found->second);
  return pairs;
}

struct FramePair {
  std::int64_t a, b;
};

/// Sums of squares, from which the RMS values come at the end.
struct Sums {
  double absolute = 0, relative = 0;
};

/// Adds one frame to one quantity: `a` and `b` are its arrays.
template <class T>
void compare_frame(const std::vector<T>& a, const std::vector<T>& b, const State& state_a,
                   FramePair frames, const Pairs& pairs, QuantityComparison& result, Sums& sums) {
  constexpr int components = components_of<T>;
  double va[9], vb[9];
  const auto get = [](const T& entry, double* values) {
    for (int c = 0; c < components; ++c) values[c] = component(entry, c);
  };
  double scale = 0;
  for (const auto& [i, j] : pairs) {
    get(a[i], va);
    get(b[j], vb);
    for (const double* v : {va, vb})
      if (const double size = norm(v, nullptr, components); size > scale) scale = size;
  }
  for (const auto& [i, j] : pairs) {
    get(a[i], va);
    get(b[j], vb);
    ++result.compared;
    if (std::memcmp(va, vb, sizeof(double) * components) == 0) continue;
    ++result.different;
    result.identical = false;
    if (!result.first_different_time) result.first_different_time = state_a.time;
    double absolute = norm(va, vb, components);
    if (std::isnan(absolute)) absolute = std::numeric_limits<double>::infinity();
    const double relative = absolute > 0 ? absolute / scale : 0;
    sums.absolute += absolute * absolute;
    sums.relative += relative * relative;
    result.max_relative = std::max(result.max_relative, relative);
    if (result.worst && absolute <= result.max_absolute) continue;
    result.max_absolute = absolute;
    result.worst = QuantityComparison::Worst{
        state_a.time,         frames.a, frames.b, state_a.particles.id[i], {va, va + components},
        {vb, vb + components}};
  }
}

bool has_32_bit_times(const TrajectoryReader& file) {
  for (std::int64_t k = 0; k < file.frames(); ++k)
    if (static_cast<double>(static_cast<float>(file.time(k))) != file.time(k)) return false;
  return true;
}

/// Frames of equal time, in order; the others are listed as unmatched.
std::vector<FramePair> match_frames(const TrajectoryReader& a, const TrajectoryReader& b,
                                    const CompareOptions& options, TrajectoryComparison& result) {
  std::vector<FramePair> matched;
  std::int64_t i = 0, j = 0;
  const double rounding = has_32_bit_times(a) || has_32_bit_times(b) ? 0x1p-23 : 1e-9;
  while (i < a.frames() && j < b.frames()) {
    const double t_a = a.time(i), t_b = b.time(j);
    const double tolerance =
        options.time_tolerance.value_or(rounding * std::max(std::abs(t_a), std::abs(t_b)));
    if (std::abs(t_a - t_b) <= tolerance) {
      result.times_identical = result.times_identical && t_a == t_b;
      result.max_time_difference = std::max(result.max_time_difference, std::abs(t_a - t_b));
      matched.push_back({i++, j++});
    } else if (t_a < t_b) {
      result.only_in_a.push_back(a.time(i++));
    } else {
      result.only_in_b.push_back(b.time(j++));
    }
  }
  while (i < a.frames()) result.only_in_a.push_back(a.time(i++));
  while (j < b.frames()) result.only_in_b.push_back(b.time(j++));
  return matched;
}

State read(const TrajectoryReader& file, std::int64_t frame) {
  State state = file.read_frame_unchecked(frame);
  check_ids(state.particles, file.path().string() + ": frame " + std::to_string(frame));
  return state;
}

}  // namespace

bool TrajectoryComparison::identical() const {
  return only_in_a.empty() && only_in_b.empty() && times_identical && particle_mismatches.empty() &&
         std::all_of(quantities.begin(), quantities.end(),
                     [](const QuantityComparison& q) { return q.identical; });
}

TrajectoryComparison compare_trajectories(const std::filesystem::path& path_a,
                                          const std::filesystem::path& path_b,
                                          const CompareOptions& options) {
  const TrajectoryReader a(path_a), b(path_b);
  TrajectoryComparison result;
  result.frames_a = a.frames();
  result.frames_b = b.frames();
  for_each_array([&](const ParticleArray& array) {
    if (!is_compared(array)) return;
    QuantityComparison& entry = result.quantities.emplace_back();
    entry.name = array.name;
    entry.units = array.units;
  });
  std::vector<Sums> sums(result.quantities.size());
  for (const FramePair& frames : match_frames(a, b, options, result)) {
    ++result.frames_matched;
    const State state_a = read(a, frames.a), state_b = read(b, frames.b);
    const Pairs pairs = match_particles(state_a.particles, state_b.particles);
    const auto only = [&](const State& state) {
      return static_cast<std::int64_t>(state.particles.size() - pairs.size());
    };
    if (only(state_a) + only(state_b) > 0)
      result.particle_mismatches.push_back({state_a.time, only(state_a), only(state_b)});
    std::size_t q = 0;
    for_each_array(
        [&](const ParticleArray& array, const auto& of_a, const auto& of_b) {
          if (!is_compared(array)) return;
          compare_frame(of_a, of_b, state_a, frames, pairs, result.quantities[q], sums[q]);
          ++q;
        },
        state_a.particles, state_b.particles);
  }
  for (std::size_t q = 0; q < sums.size(); ++q) {
    QuantityComparison& entry = result.quantities[q];
    if (entry.compared == 0) continue;
    entry.rms_absolute = std::sqrt(sums[q].absolute / static_cast<double>(entry.compared));
    entry.rms_relative = std::sqrt(sums[q].relative / static_cast<double>(entry.compared));
  }
  return result;
}

}  // namespace firn
