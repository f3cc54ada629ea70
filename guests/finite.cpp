#include "guests/finite.hpp"

#include <cmath>

namespace firn::guest {

std::optional<std::string> not_finite(const Particles& particles) {
  const auto finite = [](double value) { return std::isfinite(value); };
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const char* what = nullptr;
    if (!particles.F_P[p].allFinite()) what = "an F_P";
    if (!particles.F_E[p].allFinite()) what = "an F_E";
    if (!finite(particles.V_0[p])) what = "a volume";
    if (!finite(particles.m[p])) what = "a mass";
    if (!particles.v[p].allFinite()) what = "a velocity";
    if (!particles.x[p].allFinite()) what = "a position";
    if (what == nullptr) continue;
    std::string text = "gave ";
    text += what;
    return text + " of particle " + std::to_string(p) + " that is not finite";
  }
  return {};
}

}  // namespace firn::guest
