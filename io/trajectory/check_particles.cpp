// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/check_particles.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "firn/error.hpp"
#include "io/trajectory/format.hpp"

namespace firn {

namespace {

/// Throws, naming dataset and value, for particle i, which has a number that is not finite.
void refuse(const Particles& p, std::size_t i, const std::string& particle) {
  for_each_array(
      [&]<class T>(const ParticleArray& array, const std::vector<T>& values) {
        for (int c = 0; c < components_of<T>; ++c)
          if (const double value = component(values[i], c); !std::isfinite(value))
            throw InputError(particle, array.path, to_text(value), "finite");
      },
      p);
}

}  // namespace

void check_particles(const Particles& p, const std::string& where) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto particle = [&] { return where + ", particle " + std::to_string(i); };
    if (not_finite(p, i) != nullptr) refuse(p, i, particle());
    if (!(p.m[i] > 0))
      throw InputError(particle(), "/VTKHDF/PointData/mass", to_text(p.m[i]), "> 0");
    if (!(p.V_0[i] >= 0))
      throw InputError(particle(), "/VTKHDF/PointData/volume", to_text(p.V_0[i]),
                       "≥ 0 (0: not known yet)");
  }
  check_ids(p, where);
}

void check_ids(const Particles& p, const std::string& where) {
  std::vector<std::int64_t> ids = p.id;
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice != ids.end())
    throw InputError(where, "/VTKHDF/PointData/id", std::to_string(*twice) + " twice",
                     "each id once");
}

}  // namespace firn
