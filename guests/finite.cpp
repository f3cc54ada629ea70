// SPDX-License-Identifier: BSD-3-Clause
#include "guests/finite.hpp"

namespace firn::guest {

std::optional<std::string> not_finite(const Particles& particles) {
  for (std::size_t p = 0; p < particles.size(); ++p)
    if (const char* array = firn::not_finite(particles, p))
      return std::string("returned ") + array + " of particle " + std::to_string(p) +
             " that is not finite";
  return {};
}

}  // namespace firn::guest
