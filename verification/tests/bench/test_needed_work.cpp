// SPDX-License-Identifier: BSD-3-Clause
/// The plain count is what a loop written as in a textbook computes, counted while it does.

#include <gtest/gtest.h>

#include "bench/needed_work.hpp"

namespace firn::bench {
namespace {

/// A number that counts the products and sums it takes part in.
struct Counted {
  static inline int flop = 0;
  friend Counted operator*(Counted, Counted) { return ++flop, Counted{}; }
  friend Counted& operator+=(Counted& a, Counted) { return ++flop, a; }
};

struct Node {
  Counted m, p[3], f[3], v[3], v_new[3];
};

TEST(PlainCount, IsWhatATextbookLoopOverTheNodesTakes) {
  const Counted w[3][4], dw[3][4];  // of each axis: done once per particle, not counted
  const Counted m, p[3], tau[3][3];
  Node node[4][4][4];
  Counted v[3], v_new[3], grad_v[3][3];
  Counted::flop = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        Node& n = node[i][j][k];
        const Counted weight = w[0][i] * w[1][j] * w[2][k];
        const Counted grad[3] = {dw[0][i] * w[1][j] * w[2][k], w[0][i] * dw[1][j] * w[2][k],
                                 w[0][i] * w[1][j] * dw[2][k]};
        n.m += weight * m;
        for (int a = 0; a < 3; ++a) n.p[a] += weight * p[a];
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) n.f[a] += tau[a][b] * grad[b];
        for (int a = 0; a < 3; ++a) v[a] += weight * n.v[a];
        for (int a = 0; a < 3; ++a) v_new[a] += weight * n.v_new[a];
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) grad_v[a][b] += n.v_new[a] * grad[b];
      }
  EXPECT_EQ(Counted::flop, plain_flop);
}

/// On a machine of 1 flop/ns, that is half a multiply-add.
TEST(Shares, AreOneWhereTheUnitsDoNothingElse) {
  EXPECT_DOUBLE_EQ(plain_share(4096e-9, 1e9), 1);
  EXPECT_DOUBLE_EQ(factored_share(Deformation::elastic, 2 * 1536e-9, 1e9), 1);
  EXPECT_DOUBLE_EQ(factored_share(Deformation::plastic, 2 * 1826e-9, 1e9), 1);
}

}  // namespace
}  // namespace firn::bench
