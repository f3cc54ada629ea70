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

/// A particle quantity as `components` numbers per particle.
struct Quantity {
  const char* name;
  const char* units;
  int components;
  void (*get)(const Particles& p, std::size_t i, double* values);
};

void get_matrix(const Mat3& F, double* values) {
  for (int c = 0; c < 9; ++c) values[c] = F(c / 3, c % 3);  // row-major, as in the file
}

constexpr Quantity all_quantities[] = {
    {"position", "m", 3,
     [](const Particles& p, std::size_t i, double* a) { std::copy_n(p.x[i].data(), 3, a); }},
    {"velocity", "m/s", 3,
     [](const Particles& p, std::size_t i, double* a) { std::copy_n(p.v[i].data(), 3, a); }},
    {"mass", "kg", 1, [](const Particles& p, std::size_t i, double* a) { *a = p.m[i]; }},
    {"volume", "m^3", 1, [](const Particles& p, std::size_t i, double* a) { *a = p.V_0[i]; }},
    {"F_E", "1", 9, [](const Particles& p, std::size_t i, double* a) { get_matrix(p.F_E[i], a); }},
    {"F_P", "1", 9, [](const Particles& p, std::size_t i, double* a) { get_matrix(p.F_P[i], a); }},
    {"material", "1", 1, [](const Particles& p, std::size_t i, double* a) { *a = p.material[i]; }}};

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

/// Adds one frame to one quantity.
void compare_frame(const Quantity& quantity, const State& a, const State& b, FramePair frames,
                   const Pairs& pairs, QuantityComparison& result, Sums& sums) {
  double va[9], vb[9];
  double scale = 0;
  for (const auto& [i, j] : pairs) {
    quantity.get(a.particles, i, va);
    quantity.get(b.particles, j, vb);
    for (const double* v : {va, vb})
      if (const double size = norm(v, nullptr, quantity.components); size > scale) scale = size;
  }
  for (const auto& [i, j] : pairs) {
    quantity.get(a.particles, i, va);
    quantity.get(b.particles, j, vb);
    ++result.compared;
    const std::size_t bytes = sizeof(double) * static_cast<std::size_t>(quantity.components);
    if (std::memcmp(va, vb, bytes) == 0) continue;
    ++result.different;
    result.identical = false;
    if (!result.first_different_time) result.first_different_time = a.time;
    double absolute = norm(va, vb, quantity.components);
    if (std::isnan(absolute)) absolute = std::numeric_limits<double>::infinity();
    const double relative = absolute > 0 ? absolute / scale : 0;
    sums.absolute += absolute * absolute;
    sums.relative += relative * relative;
    result.max_relative = std::max(result.max_relative, relative);
    if (result.worst && absolute <= result.max_absolute) continue;
    result.max_absolute = absolute;
    result.worst = QuantityComparison::Worst{a.time,
                                             frames.a,
                                             frames.b,
                                             a.particles.id[i],
                                             {va, va + quantity.components},
                                             {vb, vb + quantity.components}};
  }
}

/// Frames of equal time, in order; the others are listed as unmatched.
std::vector<FramePair> match_frames(const TrajectoryReader& a, const TrajectoryReader& b,
                                    const CompareOptions& options, TrajectoryComparison& result) {
  std::vector<FramePair> matched;
  std::int64_t i = 0, j = 0;
  while (i < a.frames() && j < b.frames()) {
    const double t_a = a.time(i), t_b = b.time(j);
    const double tolerance =
        options.time_tolerance.value_or(1e-9 * std::max(std::abs(t_a), std::abs(t_b)));
    if (std::abs(t_a - t_b) <= tolerance) {
      result.times_identical = result.times_identical && t_a == t_b;
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
  for (const Quantity& quantity : all_quantities) {
    QuantityComparison& entry = result.quantities.emplace_back();
    entry.name = quantity.name;
    entry.units = quantity.units;
  }
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
    for (std::size_t q = 0; q < sums.size(); ++q)
      compare_frame(all_quantities[q], state_a, state_b, frames, pairs, result.quantities[q],
                    sums[q]);
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
