// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Everything that a time step reads and writes, always in double: a solver
/// that computes in float converts at load() and store(), both exactly where
/// its numbers are floats.

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "firn/stage.hpp"
#include "firn/types.hpp"

namespace firn {

/// Particle quantities, structure of arrays, all of length size(). The index p
/// is the particle's place in the caller's order; solvers that sort give the
/// particles back in this order.
struct Particles {
  std::vector<Vec3> x;      ///< x_p, position [m]
  std::vector<Vec3> v;      ///< v_p, velocity [m/s]
  std::vector<double> m;    ///< m_p, mass [kg], > 0
  std::vector<double> V_0;  ///< V_p0, initial volume [m³]; 0 = not known yet, step 2 estimates it
  std::vector<Mat3> F_E;    ///< elastic deformation gradient [1]
  std::vector<Mat3> F_P;    ///< plastic deformation gradient [1]
  std::vector<std::int64_t> id;        ///< 0 … N−1 in body order
  std::vector<std::int32_t> material;  ///< index into Scene::materials

  std::size_t size() const { return x.size(); }

  /// Resizes every array; new particles are at rest, undeformed, of volume 0.
  void resize(std::size_t n);

  /// Appends all particles of `other`, ids included as they are.
  void append(const Particles& other);
};

/// Calls visit(name, array…) for every array of Particles, with that array of each of
/// `particles`: the one list of them. A new array is added here, and whoever copies,
/// compares or checks particles has it.
template <class Visit, class... P>
requires(std::same_as<std::remove_const_t<P>, Particles>&&...) void for_each_field(
    Visit&& visit, P&... particles) {
  visit("x", particles.x...);
  visit("v", particles.v...);
  visit("m", particles.m...);
  visit("V_0", particles.V_0...);
  visit("F_E", particles.F_E...);
  visit("F_P", particles.F_P...);
  visit("id", particles.id...);
  visit("material", particles.material...);
}

/// The array in which particle p has a NaN or an infinity, the first one; null if there is none.
const char* not_finite(const Particles& particles, std::size_t p);

/// Grid quantities at the nodes of positive mass, sorted by (i,j,k). Along a
/// periodic axis indices lie in [0, period/h). Arrays that the stages run so
/// far have not written are empty.
struct Grid {
  std::vector<NodeIndex> node;  ///< i = (i,j,k)
  std::vector<double> m;        ///< m_i [kg], after stage 1
  std::vector<Vec3> v;          ///< v_iⁿ [m/s], after stage 1; step 8 needs it
  std::vector<Vec3> f;          ///< f_i, elastic force [N], after stage 3
  std::vector<Vec3> v_star;     ///< v_i* [m/s], after stages 4 and 5
  /// Projector onto the directions that contact leaves free, after stage 5:
  /// identity = free, I − n nᵀ = slides, 0 = sticks. Only for semi-implicit scenes.
  std::vector<Mat3> free_directions;
  std::vector<Vec3> v_new;  ///< v_i^{n+1} [m/s], after stage 6

  std::size_t size() const { return node.size(); }
  void clear();
};

/// The same for the values at nodes; `node` itself is not among them.
template <class Visit, class... G>
requires(std::same_as<std::remove_const_t<G>, Grid>&&...) void for_each_field(Visit&& visit,
                                                                              G&... grids) {
  visit("m", grids.m...);
  visit("v", grids.v...);
  visit("f", grids.f...);
  visit("v_star", grids.v_star...);
  visit("free_directions", grids.free_directions...);
  visit("v_new", grids.v_new...);
}

/// Numbers in one entry of an array: 1, 3, or 9 row by row.
template <class T>
inline constexpr int components_of = std::same_as<T, Mat3>   ? 9
                                     : std::same_as<T, Vec3> ? 3
                                                             : 1;
template <class T>
double component(const T& entry, int c) {
  if constexpr (std::same_as<T, Mat3>)
    return entry(c / 3, c % 3);
  else if constexpr (std::same_as<T, Vec3>)
    return entry[c];
  else
    return static_cast<double>(entry);
}

/// What an entry of an array is where nothing is known yet: 0, at rest, undeformed, free.
template <class T>
T blank() {
  if constexpr (std::same_as<T, Mat3>)
    return Mat3::Identity();
  else if constexpr (std::same_as<T, Vec3>)
    return Vec3::Zero();
  else
    return T{};
}

/// A simulation at a boundary between two stages.
struct State {
  double time = 0;                ///< tⁿ, start of the step [s]; advances with stage 10
  double dt = 0;                  ///< Δt of the step under way [s]; 0 between steps
  std::int64_t step = 0;          ///< n, steps completed
  Stage next = Stage::rasterize;  ///< the stage that comes next; `rasterize` = between steps
  Particles particles;
  Grid grid;  ///< meaningful inside a step; the last step's fields, or empty, between steps
};

/// visit(array) with the array that a field names.
template <class S, class Visit>
requires std::same_as<std::remove_const_t<S>, State>
decltype(auto) visit_field(S& state, Field field, Visit&& visit) {
  switch (field) {
    case Field::node_mass: return visit(state.grid.m);
    case Field::node_velocity: return visit(state.grid.v);
    case Field::node_force: return visit(state.grid.f);
    case Field::node_velocity_star: return visit(state.grid.v_star);
    case Field::node_free_directions: return visit(state.grid.free_directions);
    case Field::node_velocity_new: return visit(state.grid.v_new);
    case Field::particle_volume: return visit(state.particles.V_0);
    case Field::particle_F_E: return visit(state.particles.F_E);
    case Field::particle_F_P: return visit(state.particles.F_P);
    case Field::particle_velocity: return visit(state.particles.v);
    case Field::particle_position: break;
  }
  return visit(state.particles.x);
}

}  // namespace firn
