// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Meshes made for the tests, and files to hold them.

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "firn/error.hpp"
#include "io/mesh/triangle_mesh.hpp"

namespace firn {

/// Icosahedron of 20·4^level triangles with all vertices on the unit sphere.
inline TriangleMesh icosphere(int level) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  for (const Vec3& x : {Vec3(-1, g, 0), Vec3(1, g, 0), Vec3(-1, -g, 0), Vec3(1, -g, 0),
                        Vec3(0, -1, g), Vec3(0, 1, g), Vec3(0, -1, -g), Vec3(0, 1, -g),
                        Vec3(g, 0, -1), Vec3(g, 0, 1), Vec3(-g, 0, -1), Vec3(-g, 0, 1)})
    mesh.vertices.push_back(x.normalized());
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [at, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices.size()));
      if (is_new)
        mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized().eval());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Triangle& t : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
        finer.push_back(t);
    }
    mesh.triangles = finer;
  }
  return mesh;
}

inline std::string obj_text(const TriangleMesh& mesh) {
  std::string text = "# made for a test\n";
  for (const Vec3& x : mesh.vertices)
    text += "v " + to_text(x[0]) + " " + to_text(x[1]) + " " + to_text(x[2]) + "\n";
  for (const Triangle& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
            std::to_string(t[2] + 1) + "\n";
  return text;
}

/// A closed profile of points (radius, z), counterclockwise with z up, turned about the z axis in
/// n steps. Points on the axis become one vertex each by weld().
inline TriangleMesh revolved(const std::vector<std::pair<double, double>>& profile, int n) {
  TriangleMesh mesh;
  const int m = static_cast<int>(profile.size());
  for (int i = 0; i < n; ++i)
    for (const auto& [r, z] : profile) {
      const double angle = 2 * 3.14159265358979323846 * i / n;
      mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const int a = i * m + j, b = i * m + (j + 1) % m;
      const int c = (i + 1) % n * m + j, d = (i + 1) % n * m + (j + 1) % m;
      mesh.triangles.push_back({a, c, d});
      mesh.triangles.push_back({a, d, b});
    }
  weld(mesh);
  return mesh;
}

/// A box of 12 triangles.
inline TriangleMesh box_mesh(const Vec3& min, const Vec3& max) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(corner & 1 ? max[0] : min[0], corner & 2 ? max[1] : min[1],
                               corner & 4 ? max[2] : min[2]);
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

/// All triangles of `other` as further parts of `mesh`.
inline void append_mesh(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles)
    mesh.triangles.push_back({first + a, first + b, first + c});
}

/// A cube [0,1]³ of quadrilaterals.
inline const char* const cube_obj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A file that lives as long as the test.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& bytes)
      : path_(std::filesystem::temp_directory_path() /
              ("firn-" + std::to_string(unique()) + "-" + name)) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  static std::uint64_t unique() {  // of the process and of the file
    static int files = 0;
    return reinterpret_cast<std::uintptr_t>(&files) * 1000 + static_cast<unsigned>(files++);
  }

  std::filesystem::path path_;
};

/// What an InputError says; empty if there was none.
template <class Call>
std::string input_error(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace firn
