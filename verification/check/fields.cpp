// SPDX-License-Identifier: BSD-3-Clause
#include "verification/check/fields.hpp"

#include <limits>

namespace firn::check {

bool is_node_field(Field field) {
  switch (field) {
    case Field::node_mass:
    case Field::node_velocity:
    case Field::node_force:
    case Field::node_velocity_star:
    case Field::node_free_directions:
    case Field::node_velocity_new: return true;
    default: return false;
  }
}

int components(Field field) {
  const State none;
  return visit_field(none, field, []<class T>(const std::vector<T>&) { return components_of<T>; });
}

std::size_t length(const State& state, Field field) {
  return visit_field(state, field, [](const auto& array) { return array.size(); });
}

double value(const State& state, Field field, std::size_t index, int c) {
  return visit_field(state, field, [&](const auto& array) { return component(array[index], c); });
}

double bound(const ErrorBounds& bounds, Field field, std::size_t index, int component) {
  switch (field) {
    case Field::node_mass: return bounds.m_i[index];
    case Field::node_velocity: return bounds.v_i[index];
    case Field::node_force: return bounds.f[index];
    case Field::node_velocity_star: return bounds.v_star[index];
    case Field::node_free_directions: return bounds.free_directions[index];
    case Field::node_velocity_new: return bounds.v_new[index];
    case Field::particle_volume: return bounds.V_0[index];
    case Field::particle_F_E: return bounds.F_E[index];
    case Field::particle_F_P: return bounds.F_P[index];
    case Field::particle_velocity: return bounds.v[index];
    case Field::particle_position: return bounds.x[index][component];
  }
  return unbounded;
}

}  // namespace firn::check
