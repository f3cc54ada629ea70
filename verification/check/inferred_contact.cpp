// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/inferred_contact.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace firn::check {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Pulls choices that show nowhere towards the reference's: an effect of 1e-3 of a bound.
constexpr double weakest_effect = 1e-6;

/// One unknown for every outcome but the reference's: 1 if the solver chose it, else 0.
struct Unknown {
  std::size_t contact = 0;  ///< place in doubtful()
  int outcome = 0;
  Vec3 d;  ///< what it adds to v_i*
};

class LeastSquares {
 public:
  explicit LeastSquares(std::size_t unknowns)
      : right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns))) {
    for (Eigen::Index u = 0; u < right_.size(); ++u) matrix_.emplace_back(u, u, weakest_effect);
  }

  /// Rows A s = b that concern these unknowns, in units of the bound of each row.
  void add(const std::vector<Eigen::Index>& unknowns, const Eigen::MatrixXd& A,
           const Eigen::VectorXd& b) {
    const Eigen::MatrixXd square = A.transpose() * A;
    const Eigen::VectorXd right = A.transpose() * b;
    rows_.push_back({unknowns, A, b});
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      right_[unknowns[i]] += right[row];
      for (std::size_t j = 0; j < unknowns.size(); ++j)
        matrix_.emplace_back(unknowns[i], unknowns[j], square(row, static_cast<Eigen::Index>(j)));
    }
  }

  bool solve() {
    Sparse matrix(right_.size(), right_.size());
    matrix.setFromTriplets(matrix_.begin(), matrix_.end());
    factors_.compute(matrix);
    if (factors_.info() != Eigen::Success) return false;
    solution_ = factors_.solve(right_);
    return solution_.allFinite();
  }

  double value(Eigen::Index u) const { return solution_[u]; }

  /// How far `u` may be off where every number is off by its bound: (AᵀA)⁻¹, diagonal.
  double deviation(Eigen::Index u) const {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(right_.size(), u);
    return std::sqrt(std::abs(factors_.solve(unit).eval()[u]));
  }

  /// True if the solution leaves next to nothing of the numbers unexplained. One that fits and is
  /// not made of zeros and ones is one of many: there are fewer numbers than choices.
  bool fits() const {
    double unexplained = 0, all = 0;
    for (const Rows& rows : rows_) {
      Eigen::VectorXd own(rows.A.cols());
      for (Eigen::Index i = 0; i < own.size(); ++i)
        own[i] = solution_[rows.unknowns[static_cast<std::size_t>(i)]];
      unexplained = std::max(unexplained, (rows.b - rows.A * own).lpNorm<Eigen::Infinity>());
      all = std::max(all, rows.b.lpNorm<Eigen::Infinity>());
    }
    return unexplained < 1e-6 * all;
  }

  bool whole(Eigen::Index u) const {
    return std::abs(solution_[u] - std::round(solution_[u])) < 1e-3;
  }

 private:
  struct Rows {
    std::vector<Eigen::Index> unknowns;
    Eigen::MatrixXd A;
    Eigen::VectorXd b;
  };

  Triplets matrix_;
  std::vector<Rows> rows_;
  Eigen::VectorXd right_, solution_;
  Eigen::SimplicialLDLT<Sparse> factors_;
};

/// Out of reach of every collider, so that step 9 leaves v_p alone whoever computes it.
bool in_the_air(const Scene& scene, const Vec3& x, double time) {
  return std::all_of(scene.colliders.begin(), scene.colliders.end(),
                     [&](const Collider& c) { return c.phi(x, time) > 1e-3 * scene.grid.spacing; });
}

}  // namespace

Choices inferred_choices(const Scene& scene, const Fork& fork, const Path& own,
                         const Particles& before, const Particles& subject, double dt) {
  const auto& doubtful = fork.model.doubtful();
  std::vector<Unknown> unknowns;
  std::vector<std::vector<Eigen::Index>> of_node(fork.after.grid.size());
  for (std::size_t c = 0; c < doubtful.size(); ++c)
    for (std::size_t k = 1; k < doubtful[c].outcomes.size(); ++k) {
      of_node[doubtful[c].index].push_back(static_cast<Eigen::Index>(unknowns.size()));
      const Vec3 d = doubtful[c].outcomes[k].v - fork.after.grid.v_star[doubtful[c].index];
      unknowns.push_back({c, static_cast<int>(k), d});
    }

  LeastSquares system(unknowns.size());
  const Particles& ours = own.after.particles;
  const ErrorBounds& bounds = own.model.bounds();
  std::vector<StencilNode> around;
  for (std::size_t p = 0; p < before.size(); ++p) {
    fork.model.stencils().around(p, around);
    std::vector<Eigen::Index> seen;
    std::vector<const StencilNode*> through;
    for (const StencilNode& s : around)
      if (s.node >= 0)
        for (const Eigen::Index u : of_node[static_cast<std::size_t>(s.node)]) {
          seen.push_back(u);
          through.push_back(&s);
        }
    if (seen.empty()) continue;
    const Mat3 F = before.F_E[p] * before.F_P[p];
    const double F_bound = bounds.F_E[p] * ours.F_P[p].norm() + ours.F_E[p].norm() * bounds.F_P[p];
    const double v_weight = in_the_air(scene, before.x[p], fork.after.time) ? 1 / bounds.v[p] : 0;
    Eigen::MatrixXd A(12, static_cast<Eigen::Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Vec3& d = unknowns[static_cast<std::size_t>(seen[i])].d;
      const Mat3 F_change = dt / F_bound * d * (F.transpose() * through[i]->grad_w).transpose();
      A.col(column) << v_weight * through[i]->w * d, F_change.reshaped();
    }
    const Mat3 F_error = subject.F_E[p] * subject.F_P[p] - ours.F_E[p] * ours.F_P[p];
    Eigen::VectorXd b(12);
    b << v_weight * (subject.v[p] - ours.v[p]), (F_error / F_bound).reshaped();
    system.add(seen, A, b);
  }

  Choices choices(doubtful.size(), -1);
  if (!system.solve()) return choices;
  std::vector<double> chosen(doubtful.size(), 0.5);  // more than half makes it that outcome
  choices.assign(doubtful.size(), 0);
  const bool fits = system.fits();
  for (std::size_t u = 0; u < unknowns.size(); ++u) {
    const auto index = static_cast<Eigen::Index>(u);
    int& choice = choices[unknowns[u].contact];
    if (choice < 0) continue;
    if (system.deviation(index) > 1 || (fits && !system.whole(index))) {
      choice = -1;
    } else if (system.value(index) > chosen[unknowns[u].contact]) {
      chosen[unknowns[u].contact] = system.value(index);
      choice = unknowns[u].outcome;
    }
  }
  return choices;
}

}  // namespace firn::check
