// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Small semi-implicit systems, the solvers that are to solve them, and the matrix.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "firn/registry.hpp"
#include "verification/support/scenes.hpp"

namespace firn::test {

struct Subject {
  std::string name;
  Precision precision;

  double eps() const { return precision == Precision::float32 ? 0x1p-23 : 0x1p-52; }
  std::unique_ptr<Solver> create(int threads = 1) const;
};
void PrintTo(const Subject& subject, std::ostream* out);
std::string text(const Subject& subject);

/// Every registered solver with semi-implicit integration, in every precision.
std::vector<Subject> subjects();

using fixtures::implicit_scene;

/// n particles strewn over a cube of `cells` cells around the origin.
State random_snow(const Scene& scene, std::size_t n, double cells, std::uint64_t seed);

/// Stage 6 of one step: the state before it, after it, and what it reported.
struct Solved {
  Solved(const Scene& scene, const State& state, const Subject& subject, double dt);
  Scene scene;
  State before, after;
  StepReport report;
};

/// (a, b) = Σ m_i a_i·b_i and its norm.
double inner(const Grid& grid, const std::vector<Vec3>& a, const std::vector<Vec3>& b);
double norm(const Grid& grid, const std::vector<Vec3>& a);

/// M^½ B M^-½ with B = I + βΔt² M⁻¹H, column by column from the energy's second derivative
/// as verification/check has it: symmetric. Vectors are M^½ v.
Eigen::MatrixXd symmetric_matrix(const Solved& s, double dt);
/// The projector onto the free directions, and M^½ v.
Eigen::MatrixXd projector(const Grid& grid);
Eigen::VectorXd weighted(const Grid& grid, const std::vector<Vec3>& v);

}  // namespace firn::test
