// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Planted mistakes, each in one stage, with what the checker has to say about it.

#include <string>
#include <vector>

#include "verification/tests/check/solvers.hpp"

namespace firn::test {

struct PlantedMistake {
  std::string name;
  Stage stage;  ///< where it sits and where it must be found
  Field field;  ///< the first field it spoils
  Mistake apply;
};

const std::vector<PlantedMistake>& planted_mistakes();

}  // namespace firn::test
