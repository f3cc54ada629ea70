// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The solver under verification, as every suite sees it: through the interface alone.

#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "firn/registry.hpp"
#include "firn/solver.hpp"
#include "verification/studies/subject.hpp"

namespace firn::suite {

struct Subject {
  std::string solver;  ///< as `--solver` takes it
  Precision precision = Precision::float64;
  int threads = 1;
  std::string command;  ///< "firn verify --solver X --precision P"
  /// Every step starts a program: fewer particles, fewer steps, no long runs.
  bool slow = false;
  std::function<std::unique_ptr<Solver>(int threads)> create;
  std::function<std::unique_ptr<Solver>()> create_reference;
};

void set_subject(Subject subject);
const Subject& subject();

/// A fresh one.
std::unique_ptr<Solver> make_subject();
/// The same for a study.
studies::Subject study_subject();

/// Unit roundoff spacing of the subject's numbers, 2^-52 or 2^-23.
inline double eps() {
  return subject().precision == Precision::float32 ? double{std::numeric_limits<float>::epsilon()}
                                                   : std::numeric_limits<double>::epsilon();
}

inline bool in_float() { return subject().precision == Precision::float32; }

bool stops_at(Stage stage);

/// Takes semi-implicit scenes. A command has no traits: it is asked by a step of one particle.
bool solves_implicitly();

/// `many` for a solver in the process, `few` for one whose every step starts a program.
inline int effort(int many, int few) { return subject().slow ? few : many; }

/// The nearest number that the subject can hold.
double rounded(double x);
template <class Matrix>
Matrix rounded(Matrix m) {
  for (Eigen::Index k = 0; k < m.size(); ++k) m.data()[k] = rounded(m.data()[k]);
  return m;
}

/// Loads, runs through `last`, stores. `report` takes what the solver said.
State run_through(const Scene& scene, const State& state, Stage last, double dt,
                  StepReport* report = nullptr);

/// Loads, takes whole steps, stores.
State run_steps(const Scene& scene, const State& state, int steps, double dt);

}  // namespace firn::suite
