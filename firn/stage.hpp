// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The ten stages of one time step (Stomakhin et al. 2013, section 4.1), the
/// backbone of the project: stage = function = test = timer = report row =
/// lesson chapter.

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace firn {

enum class Stage {
  rasterize = 1,        ///< m_i, v_i from the particles
  volumes,              ///< V_p0 where it is not known yet (first step)
  grid_forces,          ///< f_i
  grid_velocities,      ///< v_i* = v_i + Δt (f_i/m_i + g)
  grid_collisions,      ///< v_i* after contact, and which directions stay free
  integration,          ///< v_i^{n+1}: explicit copy or semi-implicit solve
  deformation,          ///< F_E, F_P
  particle_velocities,  ///< v_p: PIC/FLIP blend
  particle_collisions,  ///< v_p after contact
  positions,            ///< x_p
};

inline constexpr int stage_count = 10;
inline constexpr std::array<Stage, stage_count> all_stages = {
    Stage::rasterize,           Stage::volumes,     Stage::grid_forces, Stage::grid_velocities,
    Stage::grid_collisions,     Stage::integration, Stage::deformation, Stage::particle_velocities,
    Stage::particle_collisions, Stage::positions};

/// 1 … 10, the step's number in the paper's list.
constexpr int number(Stage stage) { return static_cast<int>(stage); }

/// The stage that follows; after `positions` the next step's `rasterize`.
constexpr Stage next(Stage stage) {
  return stage == Stage::positions ? Stage::rasterize : static_cast<Stage>(number(stage) + 1);
}

/// snake_case name, as the enumerator is written.
std::string_view name(Stage stage);

/// The stage of that name, or of that number written in decimals.
std::optional<Stage> stage_from_name(std::string_view text);

/// The quantities of State that a stage may write; `check` compares these.
enum class Field {
  node_mass,             ///< Grid::m
  node_velocity,         ///< Grid::v
  node_force,            ///< Grid::f
  node_velocity_star,    ///< Grid::v_star
  node_free_directions,  ///< Grid::free_directions
  node_velocity_new,     ///< Grid::v_new
  particle_volume,       ///< Particles::V_0
  particle_F_E,          ///< Particles::F_E
  particle_F_P,          ///< Particles::F_P
  particle_velocity,     ///< Particles::v
  particle_position,     ///< Particles::x
};

std::string_view name(Field field);

/// Unit of a field: "kg", "m/s", …
std::string_view units(Field field);

/// The fields that `stage` writes, in the order in which they are compared.
std::span<const Field> fields_written(Stage stage);

}  // namespace firn
