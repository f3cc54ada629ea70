// SPDX-License-Identifier: BSD-3-Clause
/// A subject that is right must pass: the reference itself, in ten stops and in one,
/// and the reference with every number rounded to float where it claims float.

#include <gtest/gtest.h>
#include <limits>

#include "firn/error.hpp"
#include "verification/check/check.hpp"
#include "verification/support/snow_cases.hpp"
#include "verification/tests/check/solvers.hpp"

namespace firn::test {
namespace {

TEST(Lockstep, TheReferenceAgreesWithItselfToTheLastBit) {
  for (const fixtures::Case& c :
       {fixtures::lump_on_slope(), fixtures::implicit_lump(), fixtures::periodic_lump()}) {
    const auto reference = make_reference(), subject = make_reference();
    const CheckReport report = run_check(c.scene, c.state, *reference, *subject, {.steps = 3});
    EXPECT_TRUE(report.valid()) << to_table(report);
    EXPECT_EQ(report.steps, 3);
    EXPECT_GT(report.compared(), 0);
    for (const FieldCheck& row : report.fields) {
      EXPECT_EQ(row.largest_absolute, 0) << name(row.field);
      EXPECT_GT(row.compared, 0) << name(row.field);
    }
  }
}

TEST(Lockstep, FloatRoundingIsValidInFloatAndInvalidInDouble) {
  for (const fixtures::Case& c :
       {fixtures::lump_on_slope(), fixtures::implicit_lump(), fixtures::periodic_lump()}) {
    const auto reference = make_reference();
    Rounding honest(Precision::float32), boastful(Precision::float64);
    const CheckReport as_float = run_check(c.scene, c.state, *reference, honest, {.steps = 5});
    EXPECT_TRUE(as_float.valid()) << to_table(as_float);
    EXPECT_GT(as_float.largest_in_bounds(), 0.01);
    const CheckReport as_double = run_check(c.scene, c.state, *reference, boastful, {.steps = 5});
    EXPECT_FALSE(as_double.valid());
    EXPECT_EQ(as_double.first_divergence->step, 0);
    EXPECT_EQ(as_double.first_divergence->from, Stage::rasterize);
  }
}

/// Every registered solver, from random states, at the start and after some steps.
TEST(Lockstep, RegisteredSolversAgreeOnTheLumps) {
  int runs = 0;
  const auto expect_valid = [&](const fixtures::Case& c, const CheckOptions& check_options) {
    for (const SolverEntry& entry : builtin_registry().entries())
      for (const Precision precision : entry.precisions) {
        SCOPED_TRACE(entry.name + " " + std::string(name(precision)));
        SolverOptions options;
        options.precision = precision;
        const auto reference = make_reference();
        const auto subject = builtin_registry().create(entry.name, options);
        const CheckReport report = run_check(c.scene, c.state, *reference, *subject, check_options);
        EXPECT_TRUE(report.valid()) << to_table(report);
        ++runs;
      }
  };
  for (const fixtures::Case& c :
       {fixtures::lump_on_slope(), fixtures::far_lump(), fixtures::periodic_lump()})
    for (const std::int64_t start_step : {0, 40})
      expect_valid(c, {.steps = 2, .start_step = start_step});
  // An inverted F_E turns F_P over in the first step, which hardens by e^20: the method
  // itself goes no further.
  expect_valid(fixtures::awkward_lump(), {.steps = 1});
  EXPECT_GE(runs, 7);
}

/// A solver may keep F − I: what it rounds is then not less than 1, however small F.
fixtures::Case crushed_lump() {
  fixtures::Case c = fixtures::lump_on_slope();
  // Elastic, or F_E would not stay small; soft, or F_P = 0.03 I would harden by e^10.
  c.scene.materials[0].critical_compression = c.scene.materials[0].critical_stretch =
      std::numeric_limits<double>::infinity();
  c.scene.materials[1].hardening = 0.5;
  c.scene.time.step = 1e-6;
  Particles& p = c.state.particles;
  const double factors[] = {1, 0.3, 0.03, 1e-3, 1e-6};
  for (std::size_t q = 0; q < p.size(); ++q) {
    (p.material[q] == 0 ? p.F_E : p.F_P)[q] *= factors[q % 5];
    p.V_0[q] = p.m[q] / 390;
  }
  return c;
}

TEST(Lockstep, DeformationsFarBelowOneAreValid) {
  const fixtures::Case c = crushed_lump();
  for (const SolverEntry& entry : builtin_registry().entries())
    for (const Precision precision : entry.precisions)
      for (const CheckMode mode : {CheckMode::lockstep, CheckMode::free_running}) {
        SCOPED_TRACE(entry.name + " " + std::string(name(precision)));
        SolverOptions options;
        options.precision = precision;
        const auto reference = make_reference();
        const auto subject = builtin_registry().create(entry.name, options);
        const CheckReport report =
            run_check(c.scene, c.state, *reference, *subject, {.mode = mode, .steps = 2});
        EXPECT_TRUE(report.valid()) << to_table(report);
      }
}

TEST(FreeRunning, RegisteredSolversStayTogether) {
  for (const SolverEntry& entry : builtin_registry().entries())
    for (const Precision precision : entry.precisions)
      for (const fixtures::Case& c : {fixtures::lump_on_slope(), fixtures::periodic_lump()}) {
        SolverOptions options;
        options.precision = precision;
        const auto reference = make_reference();
        const auto subject = builtin_registry().create(entry.name, options);
        const CheckReport report = run_check(c.scene, c.state, *reference, *subject,
                                             {.mode = CheckMode::free_running, .steps = 200});
        EXPECT_TRUE(report.valid()) << to_table(report);
        EXPECT_EQ(report.steps, 200);
      }
}

}  // namespace
}  // namespace firn::test
