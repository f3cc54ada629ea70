// SPDX-License-Identifier: BSD-3-Clause
#include "firn/error.hpp"
#include "io/mesh/mesh_shape.hpp"
#include "io/mesh/volume.hpp"

namespace firn {

bool has_openvdb() { return false; }

namespace {

[[noreturn]] void refuse(const std::string& where) {
  throw InputError(where, "shape from a file", "a build of Firn without OpenVDB",
                   "a build with it (cmake -DFIRN_WITH_OPENVDB=ON)");
}

}  // namespace

void count_inside(const TriangleMesh&, const SampleGrid&, int, std::vector<std::int16_t>&,
                  const std::string& where) {
  refuse(where);
}

LevelSet read_level_set(const std::string& path, const std::string&) { refuse(path); }

}  // namespace firn
