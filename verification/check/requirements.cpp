// SPDX-License-Identifier: BSD-3-Clause
/// The names of what a check may have exercised, and what a scene calls for.

#include <algorithm>
#include <cmath>

#include "firn/error.hpp"
#include "verification/check/exercised.hpp"

namespace firn {

const std::array<FeatureName, feature_count>& feature_names() {
  using enum Feature;
  static const std::array<FeatureName, feature_count> names = {{
      {on_node, "on_node", "on a node", "particles", Stage::rasterize},
      {on_face, "on_face", "on a face of a cell", "particles", Stage::rasterize},
      {across_seam, "across_seam", "reach across a periodic seam", "particles", Stage::rasterize},
      {light_node, "light_node", "lighter than 1e-6 m_p", "nodes", Stage::rasterize},
      {several_materials, "several_materials", "reached by several materials", "nodes",
       Stage::rasterize},
      {volume_estimated, "volume_estimated", "volume estimated", "particles", Stage::volumes},
      {compressed, "compressed", "J_P below 1", "particles", Stage::grid_forces},
      {expanded, "expanded", "J_P above 1", "particles", Stage::grid_forces},
      {inverted, "inverted", "F_E inverted", "particles", Stage::grid_forces},
      {degenerate, "degenerate", "F_E degenerate", "particles", Stage::grid_forces},
      {node_separates, "node_separates", "leave a collider", "nodes", Stage::grid_collisions},
      {node_sticks, "node_sticks", "stick to a collider", "nodes", Stage::grid_collisions},
      {node_slides, "node_slides", "slide along a collider", "nodes", Stage::grid_collisions},
      {node_several, "node_several", "inside several colliders", "nodes", Stage::grid_collisions},
      {friction, "friction", "slide with friction", "contacts", Stage::grid_collisions},
      {no_friction, "no_friction", "slide without friction", "contacts", Stage::grid_collisions},
      {sticky, "sticky", "with a sticky collider", "contacts", Stage::grid_collisions},
      {moving, "moving", "with a moving collider", "contacts", Stage::grid_collisions},
      {turning, "turning", "with a turning collider", "contacts", Stage::grid_collisions},
      {solve, "solve", "with iterations", "solves", Stage::integration},
      {indefinite, "indefinite", "with negative curvature", "solves", Stage::integration},
      {yields_in_compression, "yields_in_compression", "yield in compression", "particles",
       Stage::deformation},
      {yields_in_stretch, "yields_in_stretch", "yield in stretch", "particles", Stage::deformation},
      {yields_in_both, "yields_in_both", "yield in both", "particles", Stage::deformation},
      {elastic, "elastic", "do not yield", "particles", Stage::deformation},
      {particle_separates, "particle_separates", "leave a collider", "particles",
       Stage::particle_collisions},
      {particle_sticks, "particle_sticks", "stick to a collider", "particles",
       Stage::particle_collisions},
      {particle_slides, "particle_slides", "slide along a collider", "particles",
       Stage::particle_collisions},
      {crosses_seam, "crosses_seam", "cross a periodic seam", "particles", Stage::positions},
      {fixed_step, "fixed_step", "of fixed length", "steps", Stage::positions},
      {step_by_max, "step_by_max", "limited by max_step", "steps", Stage::positions},
      {step_by_cfl, "step_by_cfl", "limited by cfl", "steps", Stage::positions},
      {step_by_elastic_cfl, "step_by_elastic_cfl", "limited by elastic_cfl", "steps",
       Stage::positions},
  }};
  return names;
}

namespace {

std::vector<Requirement> make_requirements() {
  using enum Feature;
  std::vector<Requirement> list = {
      {"plastic", "plastic flow", {yields_in_compression, yields_in_stretch, yields_in_both}},
      {"compression", "plastic flow in compression", {yields_in_compression, yields_in_both}},
      {"stretch", "plastic flow in stretch", {yields_in_stretch, yields_in_both}},
      {"hardening", "hardening", {compressed, expanded}},
      {"contact", "contact", {node_separates, node_sticks, node_slides}},
      {"particle_contact",
       "contact of particles",
       {particle_separates, particle_sticks, particle_slides}},
      {"periodic", "the periodic seam", {across_seam}},
      {"materials", "several materials at a node", {several_materials}},
      {"volumes", "the estimate of volumes", {volume_estimated}},
  };
  for (const FeatureName& name : feature_names()) {
    if (name.feature == friction)
      list.push_back({"friction", "friction", {friction}});
    else if (name.feature == no_friction)
      list.push_back({"no_friction", "sliding without friction", {no_friction}});
    else if (name.feature == sticky)
      list.push_back({"sticky", "a sticky collider", {sticky}});
    else if (name.feature == moving)
      list.push_back({"moving", "a moving collider", {moving}});
    else if (name.feature == turning)
      list.push_back({"turning", "a turning collider", {turning}});
    else if (name.feature == solve)
      list.push_back({"solve", "the semi-implicit solve", {solve}});
    else
      list.push_back({name.key, name.phrase, {name.feature}});
  }
  return list;
}

/// What a scene can do, whatever its particles come to do.
struct Abilities {
  bool compression = false, stretch = false, hardening = false, several = false, volumes = false;

  explicit Abilities(const Scene& scene) {
    std::vector<std::int32_t> used;
    for (const Body& body : scene.bodies) {
      if (body.sampling == Sampling::from_file)
        used.insert(used.end(), body.particles.material.begin(), body.particles.material.end());
      else
        used.push_back(body.material);
      volumes = volumes ||
                (body.sampling == Sampling::from_file
                     ? std::count(body.particles.V_0.begin(), body.particles.V_0.end(), 0.0) > 0
                     : body.volumes == VolumeSource::estimated);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    several = used.size() > 1;
    for (const std::int32_t index : used) {
      const Material& material = scene.materials[static_cast<std::size_t>(index)];
      compression = compression || material.smallest_elastic_stretch() > 0;
      stretch = stretch || std::isfinite(material.largest_elastic_stretch());
      hardening = hardening || material.hardening > 0;
    }
  }
};

}  // namespace

const std::vector<Requirement>& requirements() {
  static const std::vector<Requirement> list = make_requirements();
  return list;
}

const Requirement& requirement_of(const std::string& key) {
  std::string keys;
  for (const Requirement& requirement : requirements()) {
    if (requirement.key == key) return requirement;
    keys.append(keys.empty() ? "" : ", ").append(requirement.key);
  }
  throw InputError("--require", "nothing that a check can exercise", key, keys);
}

bool met(const Requirement& requirement, const Exercised& exercised) {
  return std::any_of(requirement.any_of.begin(), requirement.any_of.end(),
                     [&](Feature feature) { return exercised[feature] > 0; });
}

std::vector<std::string> not_exercised(const Scene& scene, const Exercised& exercised) {
  const Abilities can(scene);
  std::vector<std::string> missing;
  const auto lacks = [&](const char* key) { return !met(requirement_of(key), exercised); };
  const auto want = [&](bool able, const char* key) {
    if (able && lacks(key)) missing.emplace_back(key);
    return able && lacks(key);
  };
  const bool plastic = can.compression || can.stretch;
  if (!want(plastic, "plastic")) {
    want(can.compression, "compression");
    want(can.stretch, "stretch");
    want(plastic && can.hardening, "hardening");
  }
  const auto any = [&](auto&& holds) {
    return std::any_of(scene.colliders.begin(), scene.colliders.end(), holds);
  };
  if (!want(!scene.colliders.empty(), "contact")) {
    want(any([](const Collider& c) { return !c.sticky && c.friction > 0; }), "friction");
    want(any([](const Collider& c) { return !c.sticky && c.friction == 0; }), "no_friction");
    want(any([](const Collider& c) { return c.sticky; }), "sticky");
    want(any([](const Collider& c) { return !c.velocity.isZero(0); }), "moving");
    want(any([](const Collider& c) { return !c.angular_velocity.isZero(0); }), "turning");
    want(!scene.colliders.empty(), "particle_contact");
  }
  want(!scene.grid.periodic.isZero(0), "periodic");
  want(can.several, "materials");
  want(can.volumes, "volumes");
  want(scene.semi_implicit() && scene.integrator.implicitness > 0, "solve");
  return missing;
}

}  // namespace firn
