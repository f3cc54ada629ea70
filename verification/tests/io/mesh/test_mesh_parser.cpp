// SPDX-License-Identifier: BSD-3-Clause
// The mesh readers: what they take, and one line for everything that they refuse.

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>

#include "io/mesh/parse_obj.hpp"
#include "io/mesh/parse_stl.hpp"
#include "verification/tests/io/mesh/meshes.hpp"

namespace firn {
namespace {

using testing::HasSubstr;

/// Six times the volume within a closed mesh: a reader that mixes up corners changes it.
double sixfold_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  return sum;
}

void expect_cube(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(sixfold_volume(mesh), 6);
  EXPECT_NO_THROW(require_closed(mesh, "cube"));
}

std::string binary_stl(const TriangleMesh& mesh, const char* header = "solid binary all the same") {
  std::string bytes = header;
  bytes.resize(80);
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    bytes.append(12, '\7');  // a normal that means nothing
    for (const std::int32_t corner : t)
      for (int axis = 0; axis < 3; ++axis) append(static_cast<float>(mesh.vertices[corner][axis]));
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid a cube\n";
  for (const Triangle& t : mesh.triangles) {
    text += "  facet normal 0 0 1\n    outer loop\n";
    for (const std::int32_t corner : t) {
      const Vec3& x = mesh.vertices[corner];
      text += "      vertex " + to_text(x[0]) + " " + to_text(x[1]) + " " + to_text(x[2]) + "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a cube\n";
}

TEST(Obj, ReadsPolygons) { expect_cube(parse_obj(cube_obj)); }

TEST(Obj, ReadsEveryFormOfReference) {
  expect_cube(
      parse_obj("mtllib a.mtl\no cube\nvt 0 0\nvn 0 0 1\ng side\nusemtl snow\ns off\n"
                "v 0 0 0 1.0\nv +1 0 0 # a comment\nv 1 1 0 0.5 0.5 0.5\r\n\tv 0 1e0 0\n"
                "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\n"
                "f 4/1 3/1 2/1 1/1\nf 5//1 6//1 7//1 8//1\nf 1/1/1 2/1/1 6/1/1 5/1/1\n"
                "f -7 -6 -2 -3\nf 3 4 \\\n8 7\nf 4 1 5 8"));
}

TEST(Obj, WeldsRepeatedVerticesAndDropsTheTrianglesThatVanish) {
  const TriangleMesh cube = parse_obj(cube_obj);
  std::ostringstream text;  // every triangle with its own three vertices, and −0 for 0 in some
  for (const Triangle& t : cube.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const double zero = corner == 1 ? -0.0 : 0.0;
      text << "v";
      for (const double x : cube.vertices[t[corner]]) text << " " << (x == 0 ? zero : x);
      text << "\n";
    }
    text << "f -3 -2 -1\nf -1 -1 -2\n";
  }
  expect_cube(parse_obj(text.str()));
}

TEST(Obj, RefusesWithFileAndLine) {
  const auto error = [](const std::string& text) {
    return input_error([&] { parse_obj(text, "snow.obj"); });
  };
  EXPECT_EQ(error("v 0 0 0\nv 1 0\n"),
            "snow.obj:2: coordinate: got none, allowed: three, x, y and z");
  EXPECT_THAT(error("v 0 0 nan\n"), HasSubstr("snow.obj:1: coordinate: got \"nan\""));
  EXPECT_THAT(error("v 0 inf 0\n"), HasSubstr("got \"inf\""));
  EXPECT_THAT(error("v 0 1e10 0\n"), HasSubstr("got \"1e10\""));
  EXPECT_THAT(error("v 0 1e999 0\n"), HasSubstr("got \"1e999\""));
  EXPECT_THAT(error("v 0 0x10 0\n"), HasSubstr("got \"0x10\""));
  EXPECT_THAT(error("v 0 +-1 0\n"), HasSubstr("got \"+-1\""));
  EXPECT_THAT(error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
              HasSubstr("snow.obj:4: vertex of a face: got \"4\", allowed: 1 to 3"));
  EXPECT_THAT(error("v 0 0 0\nf 1 1 0\n"), HasSubstr("got \"0\""));
  EXPECT_THAT(error("v 0 0 0\nf 1 1 -2\n"), HasSubstr("got \"-2\""));
  EXPECT_THAT(error("v 0 0 0\nf 1 1\n"),
              HasSubstr("snow.obj:2: corners of a face: got 2, allowed: at least 3"));
  EXPECT_THAT(error("f 1 2 3\n"), HasSubstr("got \"1\", allowed: none, as no vertex"));
  EXPECT_THAT(error("v 0 0 0\nf 1 1 1.5\n"), HasSubstr("got \"1.5\""));
  EXPECT_THAT(error("v 0 0 0\nf 1 1 99999999999999999999\n"), HasSubstr("vertex of a face"));
  EXPECT_THAT(error("# fine\n\nsurf 0 1\n"), HasSubstr("snow.obj:3: statement: got \"surf\""));
  EXPECT_THAT(error(std::string("\x1b[2J\0garbage", 12)), HasSubstr("got \"?[2J?garbage\""));
  EXPECT_THAT(error(std::string(100, 'x')), HasSubstr(std::string(32, 'x') + "…"));
}

TEST(Obj, CommentsEndWithTheirLine) {
  expect_cube(parse_obj("# exported to D:\\models\\\n" + std::string(cube_obj)));
  expect_cube(parse_obj("v 0 0 0 # D:\\\n" + std::string(cube_obj).substr(8)));
  std::string text = cube_obj;  // a line joined to one with a comment ends there
  text.replace(text.find("f 4 3 2 1\n"), 10, "f 4 3 \\\n2 1 # \\\n");
  expect_cube(parse_obj(text));
}

TEST(Obj, PassesOverAByteOrderMark) {
  expect_cube(parse_obj("\xef\xbb\xbf" + std::string(cube_obj)));
  for (const char* mark : {"\xff\xfe", "\xfe\xff"})
    EXPECT_EQ(input_error([&] { parse_obj(mark + std::string(cube_obj), "snow.obj"); }),
              "snow.obj: encoding: got UTF-16, allowed: ASCII or UTF-8");
}

TEST(Stl, PassesOverAByteOrderMark) {
  const std::string text = ascii_stl(parse_obj(cube_obj));
  expect_cube(parse_stl("\xef\xbb\xbf" + text));
  EXPECT_EQ(input_error([&] { parse_stl(std::string("\xff\xfes\0o\0", 6) + text, "snow.stl"); }),
            "snow.stl: encoding: got UTF-16, allowed: ASCII or UTF-8");
}

TEST(Stl, BinaryOfAnotherSizeThanItsCountAsksFor) {
  const auto error = [](const std::string& bytes) {
    return input_error([&] { parse_stl(bytes, "snow.stl"); });
  };
  for (const char* header : {"", "solid in name only", "exported by a program"}) {
    const std::string bytes = binary_stl(parse_obj(cube_obj), header);
    EXPECT_EQ(
        error(bytes + "123456"),
        "snow.stl: bytes of a binary STL: got 690, allowed: 684, for the 12 triangles that it "
        "counts");
    EXPECT_THAT(error(bytes.substr(0, 683)), HasSubstr("got 683, allowed: 684"));
    EXPECT_THAT(error(bytes.substr(0, 84)), HasSubstr("got 84, allowed: 684"));
  }
  EXPECT_THAT(error(std::string(40, '\0')), HasSubstr("got 40, allowed: at least 84"));
  // Text that no binary file begins with is told what is wrong with the text.
  EXPECT_THAT(error(ascii_stl(parse_obj(cube_obj)) + std::string(3, '\0')),
              HasSubstr("allowed: \"solid\""));
}

TEST(Stl, ReadsText) { expect_cube(parse_stl(ascii_stl(parse_obj(cube_obj)))); }

TEST(Stl, ReadsTextInUpperCaseAndSeveralSolids) {
  std::string text = ascii_stl(parse_obj(cube_obj));
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  expect_cube(parse_stl(text + "\r\n\r\nsolid\nendsolid\n\n"));
}

TEST(Stl, ReadsBinary) {
  const TriangleMesh cube = parse_obj(cube_obj);
  expect_cube(parse_stl(binary_stl(cube)));
  expect_cube(parse_stl(binary_stl(cube, "something else")));
}

TEST(Stl, RefusesWithTheReason) {
  const auto error = [](const std::string& text) {
    return input_error([&] { parse_stl(text, "snow.stl"); });
  };
  EXPECT_THAT(error("solid\nfacet\nouter loop\nvertex 0 0 x\n"),
              HasSubstr("snow.stl:4: coordinate: got \"x\""));
  EXPECT_THAT(error("solid\nfacet\nouter loop\nvertex 0 0\n"), HasSubstr("snow.stl:4: coordinate"));
  EXPECT_THAT(error("solid\nfacet\nvertex 0 0 0\n"),
              HasSubstr("snow.stl:3: line: got \"vertex 0 0 0\", allowed: \"outer loop\""));
  EXPECT_THAT(error("solid\nfacets\n"), HasSubstr("allowed: \"facet\""));
  EXPECT_THAT(error("solid\n"), HasSubstr("got the end of the file, allowed: \"facet\""));
  EXPECT_THAT(error("hello\n"), HasSubstr("snow.stl:1: line: got \"hello\", allowed: \"solid\""));
  std::string bytes = binary_stl(parse_obj(cube_obj));
  EXPECT_THAT(error(bytes.substr(0, bytes.size() - 1)), HasSubstr("snow.stl"));  // cut short
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&bytes[84 + 50 * 3 + 12 + 4], &nan, 4);
  EXPECT_THAT(error(bytes), HasSubstr("snow.stl: coordinate in triangle 3: got nan"));
}

TEST(Stl, EmptyFilesAreMeshesWithoutTriangles) {
  EXPECT_TRUE(parse_stl("").triangles.empty());
  EXPECT_TRUE(parse_obj("").triangles.empty());
  EXPECT_THAT(input_error([] { require_closed(parse_stl(""), "empty.stl"); }),
              HasSubstr("empty.stl: triangles: got 0"));
}

TEST(Closed, NamesAnEdgeThatIsOpen) {
  TriangleMesh cube = parse_obj(cube_obj);
  cube.triangles.erase(cube.triangles.begin());
  EXPECT_EQ(input_error([&] { require_closed(cube, "open.obj"); }),
            "open.obj: triangles at the edge from (0, 1, 0) to (1, 0, 0): got 1, allowed: 2, as on "
            "every edge of a closed surface");
}

TEST(Closed, NamesAnEdgeOfThreeTriangles) {
  TriangleMesh cube = parse_obj(cube_obj);
  cube.triangles.push_back(cube.triangles.front());
  EXPECT_THAT(input_error([&] { require_closed(cube, "fin.obj"); }),
              HasSubstr("got 3, allowed: 2"));
}

TEST(Closed, IcospheresAre) {
  for (int level = 0; level < 4; ++level) {
    TriangleMesh mesh = icosphere(level);
    weld(mesh);
    EXPECT_EQ(mesh.triangles.size(), 20u << 2 * level);
    EXPECT_NO_THROW(require_closed(mesh, "icosphere"));
  }
}

// Every prefix of a valid file and every single changed byte: an answer or an
// InputError, never a crash (the sanitizer build runs this, too).
TEST(Robustness, CutAndDamagedFilesAreReadOrRefused) {
  const TriangleMesh cube = parse_obj(cube_obj);
  const std::string files[] = {cube_obj, ascii_stl(cube), binary_stl(cube)};
  int refused = 0, taken = 0;
  for (int file = 0; file < 3; ++file) {
    const auto parse = [&](const std::string& bytes) {
      const std::string error = input_error([&] {
        TriangleMesh mesh = file == 0 ? parse_obj(bytes) : parse_stl(bytes);
        require_closed(mesh, "mesh");
      });
      ++(error.empty() ? taken : refused);
      EXPECT_EQ(error.find('\n'), std::string::npos);
    };
    for (std::size_t length = 0; length < files[file].size(); length += file == 0 ? 1 : 7)
      parse(files[file].substr(0, length));
    for (std::size_t at = 0; at < files[file].size(); at += file == 0 ? 1 : 7)
      for (const char byte : {'\0', '\xff', '9', '-', ' ', '\n'}) {
        std::string damaged = files[file];
        damaged[at] = byte;
        parse(damaged);
      }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(taken, 100);
}

}  // namespace
}  // namespace firn
