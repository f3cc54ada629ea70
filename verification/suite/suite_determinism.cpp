// SPDX-License-Identifier: BSD-3-Clause
/// A solver is a function: the same input gives the same bits.

#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "verification/suite/probes.hpp"
#include "verification/support/snow_cases.hpp"

namespace firn::suite {
namespace {

int steps() { return effort(12, 2); }

State run_case(const fixtures::Case& c, Solver& solver, int count) {
  solver.load(c.scene, c.state);
  for (int n = 0; n < count; ++n) solver.step(solver.choose_time_step().dt);
  State state;
  solver.store(state);
  return state;
}

template <class T>
std::int64_t different(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return static_cast<std::int64_t>(a.size() + b.size());
  std::int64_t count = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    count += std::memcmp(&a[k], &b[k], sizeof(T)) == 0 ? 0 : 1;
  return count;
}

void same_bits(const std::string& what, const State& a, const State& b) {
  std::int64_t count = 0, compared = 0;
  for_each_field(
      [&](const char*, const auto& p, const auto& q) {
        count += different(p, q);
        compared += static_cast<std::int64_t>(p.size());
      },
      a.particles, b.particles);
  expect(what, count == 0, fmt::format("{} of {} particle quantities differ", count, compared));
}

std::vector<fixtures::Case> some_cases() {
  std::vector<fixtures::Case> list = {fixtures::lump_on_slope(), fixtures::periodic_lump()};
  if (solves_implicitly()) list.push_back(fixtures::implicit_lump());
  return list;
}

FIRN_TEST(Determinism, number_of_threads) {
  for (const fixtures::Case& c : some_cases()) {
    const State one = run_case(c, *subject().create(1), steps());
    for (const int threads : {2, 3, 5})
      same_bits(fmt::format("{}: {} threads", c.name, threads), one,
                run_case(c, *subject().create(threads), steps()));
  }
}

FIRN_TEST(Determinism, the_same_run_twice) {
  for (const fixtures::Case& c : some_cases())
    same_bits(c.name, run_case(c, *make_subject(), steps()), run_case(c, *make_subject(), steps()));
}

/// What a solver did before must not matter: its memory, its order of particles.
FIRN_TEST(Determinism, what_was_before) {
  for (const fixtures::Case& c : some_cases()) {
    const State fresh = run_case(c, *make_subject(), 2);
    const auto used = make_subject();
    run_case(fixtures::lump_on_slope(), *used, 3);
    same_bits(c.name, fresh, run_case(c, *used, 2));
  }
}

/// Loaded again after every step with what it stored (and its own restart data), it goes on as if
/// nothing had happened.
FIRN_TEST(Determinism, stored_and_loaded) {
  for (const fixtures::Case& c : some_cases()) {
    const State whole = run_case(c, *make_subject(), steps());
    State state = c.state;
    std::vector<std::byte> rest;
    for (int n = 0; n < steps(); ++n) {
      const auto solver = make_subject();
      solver->load(c.scene, state);
      if (!rest.empty()) solver->load_restart(rest);
      solver->step(solver->choose_time_step().dt);
      solver->store(state);
      rest.resize(solver->restart_size());
      solver->store_restart(rest);
    }
    same_bits(c.name, whole, state);
  }
}

/// A pause to look at the state changes nothing.
FIRN_TEST(Determinism, looking_does_not_disturb) {
  for (const fixtures::Case& c : some_cases()) {
    const State unseen = run_case(c, *make_subject(), steps());
    const auto solver = make_subject();
    solver->load(c.scene, c.state);
    State state;
    for (int n = 0; n < steps(); ++n) {
      solver->step(solver->choose_time_step().dt);
      solver->store(state);
      solver->diagnostics(c.scene);
    }
    same_bits(c.name, unseen, state);
  }
}

FIRN_TEST(Determinism, step_equals_its_stages) {
  for (const fixtures::Case& c : some_cases()) {
    const State whole = run_case(c, *make_subject(), steps());
    const auto solver = make_subject();
    solver->load(c.scene, c.state);
    for (int n = 0; n < steps(); ++n) {
      const double dt = solver->choose_time_step().dt;
      for (const Stage stop : solver->traits().stops) solver->advance_through(stop, dt);
    }
    State staged;
    solver->store(staged);
    same_bits(c.name, whole, staged);
  }
}

}  // namespace
}  // namespace firn::suite
