#include "io/trajectory/check_particles.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "firn/error.hpp"

namespace firn {

namespace {

void require_finite(const double* values, int count, const char* name, const std::string& where) {
  for (int c = 0; c < count; ++c)
    if (!std::isfinite(values[c])) throw InputError(where, name, to_text(values[c]), "finite");
}

}  // namespace

void check_particles(const Particles& p, const std::string& where) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto particle = [&] { return where + ", particle " + std::to_string(i); };
    const bool finite = p.x[i].allFinite() && p.v[i].allFinite() && p.F_E[i].allFinite() &&
                        p.F_P[i].allFinite() && std::isfinite(p.m[i]) && std::isfinite(p.V_0[i]);
    if (!finite) {
      require_finite(p.x[i].data(), 3, "/VTKHDF/Points", particle());
      require_finite(p.v[i].data(), 3, "/VTKHDF/PointData/velocity", particle());
      require_finite(&p.m[i], 1, "/VTKHDF/PointData/mass", particle());
      require_finite(&p.V_0[i], 1, "/VTKHDF/PointData/volume", particle());
      require_finite(p.F_E[i].data(), 9, "/VTKHDF/PointData/F_E", particle());
      require_finite(p.F_P[i].data(), 9, "/VTKHDF/PointData/F_P", particle());
    }
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
