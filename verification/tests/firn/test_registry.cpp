// SPDX-License-Identifier: BSD-3-Clause
/// Solvers by name and by family.

#include <gtest/gtest.h>
#include <stdexcept>

#include "firn/error.hpp"
#include "firn/registry.hpp"

namespace firn {
namespace {

/// Does nothing; its name tells who made it.
class Idle final : public Solver {
 public:
  Idle(std::string name, Precision precision) {
    traits_.name = std::move(name);
    traits_.precision = precision;
  }
  const SolverTraits& traits() const override { return traits_; }
  void load(const Scene&, const State&) override {}
  TimeStep choose_time_step() override { return {}; }
  StepReport advance_through(Stage, double) override { return {}; }
  void store(State&) const override {}

 private:
  SolverTraits traits_;
};

Registry idle_registry() {
  Registry registry;
  registry.add({"idle", "", {Precision::float32}, [](const SolverOptions& o) {
                  return std::make_unique<Idle>("idle", o.precision);
                }});
  registry.add_family(
      {"kin:NAME", "", begins_with("kin:"), [](const std::string& name, const SolverOptions& o) {
         return std::make_unique<Idle>("made of " + name, o.precision);
       }});
  registry.add_family({"any", "", [](const std::string& name) { return name.size() > 2; },
                       [](const std::string&, const SolverOptions& o) {
                         return std::make_unique<Idle>("caught all", o.precision);
                       }});
  return registry;
}

TEST(Registry, RegisteredNamesComeBeforeFamilies) {
  EXPECT_EQ(idle_registry().traits("idle").name, "idle");
  EXPECT_EQ(idle_registry().traits("idle").precision, Precision::float32);
}

TEST(Registry, TheFirstFamilyThatHasTheNameMakesTheSolver) {
  EXPECT_EQ(idle_registry().traits("kin:abc").name, "made of kin:abc");
  EXPECT_EQ(idle_registry().traits("other").name, "caught all");
}

TEST(Registry, FamiliesAreNoEntries) {
  EXPECT_EQ(idle_registry().entries().size(), 1u);
  EXPECT_EQ(idle_registry().find("kin:abc"), nullptr);
}

TEST(Registry, AnUnknownNameListsWhatThereIs) {
  try {
    idle_registry().create("x", {});
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--solver: unknown solver: got x, allowed: idle, kin:NAME, any");
  }
}

TEST(Registry, APrecisionThatIsNotSupportedIsRefused) {
  EXPECT_THROW(idle_registry().create("idle", {Precision::float64}), InputError);
}

TEST(Registry, ANameIsTakenOnce) {
  Registry registry = idle_registry();
  EXPECT_THROW(registry.add({"idle", "", {}, {}}), std::logic_error);
}

}  // namespace
}  // namespace firn
