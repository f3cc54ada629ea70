// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Level-set files for the tests, written by OpenVDB itself.

#include <string>

#include "firn/types.hpp"

namespace firn {

/// A narrow-band sphere of voxels of edge s and a band of three voxels.
void write_vdb_sphere(const std::string& path, const Vec3& center, double radius, double s);

/// As above, with a fog volume before the level set, to be passed over.
void write_vdb_fog_and_sphere(const std::string& path, double radius, double s);

/// Spheres called "ball" and "pearl" of half the radius, and a fog called "mist".
void write_vdb_named(const std::string& path, double radius, double s);

/// A sphere with one value at (i,0,0) replaced.
void write_vdb_with_value(const std::string& path, double radius, double s, int i, float value);

/// A sphere whose inside beyond the band is positive, as in a file that was never flooded.
void write_vdb_unflooded(const std::string& path, double radius, double s);

/// No level set at all.
void write_vdb_fog(const std::string& path);

/// A sphere whose voxels are stretched along z, or turned about z.
void write_vdb_stretched(const std::string& path);
void write_vdb_turned(const std::string& path);

/// A level set without a single active voxel.
void write_vdb_empty(const std::string& path);

}  // namespace firn
