// SPDX-License-Identifier: BSD-3-Clause
#include "firn/state.hpp"

#include <cmath>

namespace firn {

void Particles::resize(std::size_t n) {
  for_each_field([n]<class T>(const char*, std::vector<T>& array) { array.resize(n, blank<T>()); },
                 *this);
}

void Particles::append(const Particles& other) {
  for_each_field([](const char*, auto& to,
                    const auto& from) { to.insert(to.end(), from.begin(), from.end()); },
                 *this, other);
}

const char* not_finite(const Particles& particles, std::size_t p) {
  const char* found = nullptr;
  for_each_field(
      [&]<class T>(const char* name, const std::vector<T>& array) {
        bool finite = true;
        for (int c = 0; c < components_of<T>; ++c)
          finite = finite && std::isfinite(component(array[p], c));
        if (found == nullptr && !finite) found = name;
      },
      particles);
  return found;
}

void Grid::clear() { *this = Grid{}; }

}  // namespace firn
