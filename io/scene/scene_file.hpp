// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Scenes from TOML. Every key is documented in docs/scene_format.md. An unknown key, a
/// value out of range or a file that cannot be read is an InputError.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "firn/scene.hpp"

namespace firn {

struct SceneOptions {
  /// Refinement s in [0.01, 100]: spacing becomes h/s, `step` and `max_step`
  /// become Δt/s, so that the number of particles grows as s³, the number of
  /// steps as s, and both Courant numbers stay. Lengths of the scene stay; a
  /// period must still be a whole multiple of h. Bodies read from particle files
  /// cannot be refined.
  double scale = 1;

  /// Scenes whose bodies might hold more particles than this are refused
  /// (counted from the bodies' bounding boxes).
  std::int64_t max_particles = 2147483647;

  /// What the caller will need for each particle [bytes]: scenes that would take more memory than
  /// there is are refused before a particle is placed (firn/memory.hpp). 0: not looked at.
  double bytes_per_particle = 0;

  /// A scene without bodies is refused; false where a state is given beside it.
  bool needs_bodies = true;
};

/// The scene in `text`. `file_name` is what messages call it, `base_dir` is
/// where relative paths start.
Scene parse_scene(std::string_view text, const std::string& file_name,
                  const std::filesystem::path& base_dir, const SceneOptions& options = {});

/// The scene in a file of at most 16 MiB.
Scene read_scene_file(const std::filesystem::path& path, const SceneOptions& options = {});

/// The scene that a command line names. With a path separator or the ending
/// `.toml` it is a file, otherwise a built-in scene, and if there is no such
/// scene a file again. The error for an unknown name lists similar names.
Scene find_scene(const std::string& name_or_path, const SceneOptions& options = {});

/// The scene with every default written out, as trajectories store it
/// (Scene::toml). Parsing it gives the same scene, bit for bit; files are named
/// by absolute paths.
std::string resolved_toml(const Scene& scene);

}  // namespace firn
