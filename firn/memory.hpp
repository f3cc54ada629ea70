// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// How much memory a scene will take, and how much there is.

#include <cstddef>
#include <filesystem>
#include <string>

#include "firn/scene.hpp"
#include "firn/solver.hpp"

namespace firn {

/// Bytes that this process may still take without anything being swapped out or killed: the
/// least of MemAvailable, the limits of its control groups (version 1 and 2, with those above
/// them) and the limit of its address space. Infinite where the system tells nothing.
/// `root`: where /proc and /sys are; another place for tests.
double available_memory(const std::filesystem::path& root = "/");

/// Number of particles that sample_bodies() will place for this body, to some per cent: its
/// bounding box times the share of 24³ points in it that lie in the shape. Costs milliseconds.
double expected_particles(const GridSettings& grid, const Body& body);

/// Bytes per particle of a State.
inline constexpr double state_bytes_per_particle = 220;

/// Bytes that a solver needs for each particle of a run: its own arrays, its grid (at 8 particles
/// per cell), and the states that the driver keeps and writes. Measured as the growth of the
/// largest resident set of `firn run snowball_drop` from --scale 2 to 4, and a quarter added.
/// Guests count as the reference. A semi-implicit run takes up to a third more; scenes ask for
/// half.
double run_bytes_per_particle(Pace pace, Precision precision);

/// The same for a check: two solvers and the states between their stages.
double check_bytes_per_particle();

/// Throws InputError, with both numbers, if so many bytes are not available.
void require_memory(const std::string& where, double particles, double bytes_per_particle,
                    double available = available_memory());

}  // namespace firn
