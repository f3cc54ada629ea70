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
  switch (field) {
    case Field::node_mass:
    case Field::particle_volume: return 1;
    case Field::node_free_directions:
    case Field::particle_F_E:
    case Field::particle_F_P: return 9;
    default: return 3;
  }
}

namespace {

/// Calls f with the array that holds the field.
template <class F>
auto with_array(const State& state, Field field, F&& f) {
  const Particles& p = state.particles;
  const Grid& g = state.grid;
  switch (field) {
    case Field::node_mass: return f(g.m);
    case Field::node_velocity: return f(g.v);
    case Field::node_force: return f(g.f);
    case Field::node_velocity_star: return f(g.v_star);
    case Field::node_free_directions: return f(g.free_directions);
    case Field::node_velocity_new: return f(g.v_new);
    case Field::particle_volume: return f(p.V_0);
    case Field::particle_F_E: return f(p.F_E);
    case Field::particle_F_P: return f(p.F_P);
    case Field::particle_velocity: return f(p.v);
    case Field::particle_position: break;
  }
  return f(p.x);
}

double component_of(double value, int) { return value; }
double component_of(const Vec3& value, int c) { return value[c]; }
double component_of(const Mat3& value, int c) { return value(c / 3, c % 3); }

}  // namespace

std::size_t length(const State& state, Field field) {
  return with_array(state, field, [](const auto& array) { return array.size(); });
}

double value(const State& state, Field field, std::size_t index, int component) {
  return with_array(state, field, [&](const auto& array) -> double {
    return component_of(array[index], component);
  });
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
