// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Numbers as a solver in float holds them.

#include "firn/state.hpp"

namespace firn::fixtures {

/// x rounded to float. Through memory: g++ 12.2 from -O2 on drops the two
/// conversions when it packs neighbouring ones together (SLP).
inline double through_float(double x) {
  const volatile float rounded = static_cast<float>(x);
  return static_cast<double>(rounded);
}

inline Particles through_float(Particles p) {
  const auto round = [](auto& array) {
    for (auto& value : array)
      for (double* x = value.data(); x != value.data() + value.size(); ++x) *x = through_float(*x);
  };
  round(p.x);
  round(p.v);
  round(p.F_E);
  round(p.F_P);
  for (double& m : p.m) m = through_float(m);
  for (double& V : p.V_0) V = through_float(V);
  return p;
}

}  // namespace firn::fixtures
