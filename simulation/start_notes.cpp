// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/start_notes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "firn/error.hpp"

namespace firn {

namespace {

/// Three digits: enough for a note.
std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string place(const char* section, std::size_t index) {
  return std::string(section) + "[" + std::to_string(index) + "]";
}

std::optional<std::string> volume_note(const Scene& scene, const Body& body, std::size_t count) {
  const auto* shape = std::get_if<SolidShape>(&body.shape);
  const std::optional<double> enclosed = shape ? shape->solid->volume() : std::nullopt;
  if (!enclosed || !(*enclosed > 0)) return std::nullopt;
  const double h = scene.grid.spacing;
  const double filled = static_cast<double>(count) * h * h * h / body.particles_per_cell;
  const double excess = filled / *enclosed - 1;
  if (!(std::abs(excess) > 0.05)) return std::nullopt;
  return std::to_string(count) + " particles fill " + rounded(filled) + " m³, the mesh encloses " +
         rounded(*enclosed) + " m³ (" + (excess > 0 ? "+" : "") + rounded(100 * excess) +
         " %): more particles per cell" +
         (body.sampling == Sampling::lattice ? " or sampling = \"jittered\" come" : " come") +
         " nearer";
}

}  // namespace

std::vector<std::string> start_notes(const Scene& scene, const Particles& particles,
                                     const std::vector<std::size_t>& counts) {
  std::vector<std::string> notes;
  // Particles that rest on a wall are not inside; samples of a mesh are floats.
  const double touching = 1e-5 * scene.grid.spacing;
  std::size_t first = 0;
  for (std::size_t b = 0; b < counts.size(); first += counts[b++]) {
    const std::string body = place("body", b) + ": ";
    if (const auto note = volume_note(scene, scene.bodies[b], counts[b]))
      notes.push_back(body + *note);
    for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
      std::size_t inside = 0;
      double depth = 0;
      for (std::size_t p = first; p < first + counts[b]; ++p) {
        const double phi = scene.colliders[c].phi(particles.x[p], 0);
        if (!(phi < -touching)) continue;
        ++inside;
        depth = std::max(depth, -phi);
      }
      if (inside > 0)
        notes.push_back(body + std::to_string(inside) + " of " + std::to_string(counts[b]) +
                        " particles begin inside " + place("collider", c) + ", up to " +
                        rounded(depth) + " m deep");
    }
  }
  return notes;
}

}  // namespace firn
