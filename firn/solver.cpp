#include "firn/solver.hpp"

#include <stdexcept>

namespace firn {

std::string_view name(TimeStepBound bound) {
  switch (bound) {
    case TimeStepBound::fixed: return "fixed";
    case TimeStepBound::max_step: return "max_step";
    case TimeStepBound::cfl: return "cfl";
    case TimeStepBound::elastic_cfl: return "elastic_cfl";
  }
  return "unknown";
}

Diagnostics Solver::diagnostics() const {
  if (scene_ == nullptr) throw std::logic_error("Solver::diagnostics() before load()");
  State state;
  store(state);
  return measure(*scene_, state);
}

}  // namespace firn
