// SPDX-License-Identifier: BSD-3-Clause
#include "firn/stage.hpp"

#include <charconv>

namespace firn {

namespace {

constexpr std::array<std::string_view, stage_count> stage_names = {
    "rasterize",   "volumes",     "grid_forces",         "grid_velocities",     "grid_collisions",
    "integration", "deformation", "particle_velocities", "particle_collisions", "positions"};

struct FieldText {
  std::string_view name, units;
};

constexpr std::array<FieldText, 11> field_texts = {{{"m_i", "kg"},
                                                    {"v_i", "m/s"},
                                                    {"f_i", "N"},
                                                    {"v_i_star", "m/s"},
                                                    {"free_directions", "1"},
                                                    {"v_i_new", "m/s"},
                                                    {"V_p0", "m^3"},
                                                    {"F_E", "1"},
                                                    {"F_P", "1"},
                                                    {"v_p", "m/s"},
                                                    {"x_p", "m"}}};

constexpr Field after_rasterize[] = {Field::node_mass, Field::node_velocity};
constexpr Field after_volumes[] = {Field::particle_volume};
constexpr Field after_forces[] = {Field::node_force};
constexpr Field after_grid_velocities[] = {Field::node_velocity_star};
constexpr Field after_grid_collisions[] = {Field::node_velocity_star, Field::node_free_directions};
constexpr Field after_integration[] = {Field::node_velocity_new};
constexpr Field after_deformation[] = {Field::particle_F_E, Field::particle_F_P};
constexpr Field after_particle_velocities[] = {Field::particle_velocity};
constexpr Field after_positions[] = {Field::particle_position};

}  // namespace

std::string_view name(Stage stage) {
  return stage_names[static_cast<std::size_t>(number(stage) - 1)];
}

std::optional<Stage> stage_from_name(std::string_view text) {
  for (const Stage stage : all_stages)
    if (name(stage) == text) return stage;
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error == std::errc() && end == text.data() + text.size() && n >= 1 && n <= stage_count)
    return static_cast<Stage>(n);
  return std::nullopt;
}

std::string_view name(Field field) { return field_texts[static_cast<std::size_t>(field)].name; }

std::string_view units(Field field) { return field_texts[static_cast<std::size_t>(field)].units; }

std::span<const Field> fields_written(Stage stage) {
  switch (stage) {
    case Stage::rasterize: return after_rasterize;
    case Stage::volumes: return after_volumes;
    case Stage::grid_forces: return after_forces;
    case Stage::grid_velocities: return after_grid_velocities;
    case Stage::grid_collisions: return after_grid_collisions;
    case Stage::integration: return after_integration;
    case Stage::deformation: return after_deformation;
    case Stage::particle_velocities:
    case Stage::particle_collisions: return after_particle_velocities;
    case Stage::positions: return after_positions;
  }
  return {};
}

}  // namespace firn
