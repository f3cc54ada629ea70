// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Bitwise equality of states, for EXPECT_TRUE: the message names the array that differs.

#include <cstring>
#include <gtest/gtest.h>

#include "firn/state.hpp"

namespace firn::fixtures {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  // memcmp does not allow the null pointer of an empty vector, even for no bytes.
  return a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline ::testing::AssertionResult same_particles(const Particles& a, const Particles& b) {
  const char* different = nullptr;
  for_each_field(
      [&](const char* name, const auto& of_a, const auto& of_b) {
        if (different == nullptr && !same_bits(of_a, of_b)) different = name;
      },
      a, b);
  if (different != nullptr) return ::testing::AssertionFailure() << different << " differ";
  return ::testing::AssertionSuccess();
}

}  // namespace firn::fixtures
