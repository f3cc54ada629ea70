#pragma once
/// Bitwise equality of states, as a test's message tells it.

#include <cstring>
#include <gtest/gtest.h>

#include "firn/state.hpp"

namespace firn::testing {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  // memcmp does not allow the null pointer of an empty vector, even for no bytes.
  return a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline ::testing::AssertionResult same_particles(const Particles& a, const Particles& b) {
  auto differ = [](const char* name) { return ::testing::AssertionFailure() << name << " differ"; };
  if (!same_bits(a.x, b.x)) return differ("positions");
  if (!same_bits(a.v, b.v)) return differ("velocities");
  if (!same_bits(a.m, b.m)) return differ("masses");
  if (!same_bits(a.V_0, b.V_0)) return differ("volumes");
  if (!same_bits(a.F_E, b.F_E)) return differ("F_E");
  if (!same_bits(a.F_P, b.F_P)) return differ("F_P");
  if (!same_bits(a.id, b.id)) return differ("ids");
  if (!same_bits(a.material, b.material)) return differ("materials");
  return ::testing::AssertionSuccess();
}

}  // namespace firn::testing
