// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// State seen as fields: numbers by field, index and component.

#include <cstddef>
#include <vector>

#include "firn/stage.hpp"
#include "firn/state.hpp"
#include "verification/check/bounds.hpp"

namespace firn::check {

bool is_node_field(Field field);

/// 1, 3 or 9 numbers per particle or node.
int components(Field field);

/// Length of the field's array: 0 if no stage has written it.
std::size_t length(const State& state, Field field);

/// Matrices row-major.
double value(const State& state, Field field, std::size_t index, int component);

/// The bound that applies to one component.
double bound(const ErrorBounds& bounds, Field field, std::size_t index, int component);

/// Every particle field of State that a solver holds, and the node fields.
inline constexpr Field particle_fields[] = {Field::particle_volume, Field::particle_F_E,
                                            Field::particle_F_P, Field::particle_velocity,
                                            Field::particle_position};

}  // namespace firn::check
