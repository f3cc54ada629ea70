// SPDX-License-Identifier: BSD-3-Clause
// Any bytes are either a triangle mesh or an InputError of one line.

#include <cstddef>
#include <cstdint>

#include "io/mesh/parse_stl.hpp"
#include "verification/fuzz/fuzz_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  firn::fuzz::judge_mesh_parser(firn::parse_stl, {reinterpret_cast<const char*>(data), size});
  return 0;
}
