// SPDX-License-Identifier: BSD-3-Clause
/// Files that are no trajectories, or bad ones: each gets the message that
/// docs/files.md lists. FIRN_UPDATE_DOCS=1 writes the list anew.

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <string>
#include <vector>

#include "firn/error.hpp"
#include "io/hdf5/id.hpp"
#include "io/trajectory/reader.hpp"
#include "io/trajectory/writer.hpp"
#include "verification/support/scenes.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::odd_particles;
using fixtures::TemporaryFolder;
using Path = std::filesystem::path;

/// Two frames of five particles, two rows.
void write_good(const Path& path) {
  TrajectoryWriter writer(path, {}, 5, 3, 2, 2);
  State state;
  state.particles = odd_particles(5);
  const std::vector<std::byte> restart(3);
  writer.write_frame(state, restart);
  writer.add_row({});
  writer.add_row({});
  state.time = 0.1;
  state.step = 2;
  writer.write_frame(state, restart);
  writer.finish();
}

/// Changes to a good file.
class Edit {
 public:
  explicit Edit(const Path& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDWR, hdf5::file_access().get()), H5Fclose) {}

  void remove(const char* name) { H5Ldelete(file_.get(), name, H5P_DEFAULT); }

  void replace(const char* name, hid_t type, std::vector<hsize_t> shape, hid_t properties = 0) {
    remove(name);
    hdf5::Id early(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_alloc_time(early.get(), H5D_ALLOC_TIME_EARLY);
    if (properties == 0) properties = early.get();
    hdf5::Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                   H5Sclose);
    hdf5::Id(H5Dcreate2(file_.get(), name, type, space.get(), H5P_DEFAULT, properties, H5P_DEFAULT),
             H5Dclose);
  }

  /// One number of a dataset.
  void set(const char* name, hsize_t index, double value) {
    hdf5::Id dataset(H5Dopen2(file_.get(), name, H5P_DEFAULT), H5Dclose);
    hdf5::Id space(H5Dget_space(dataset.get()), H5Sclose);
    hsize_t shape[2] = {1, 1};
    const int rank = H5Sget_simple_extent_dims(space.get(), shape, nullptr);
    const hsize_t place[2] = {rank == 2 ? index / shape[1] : index, index % shape[1]};
    H5Sselect_elements(space.get(), H5S_SELECT_SET, 1, place);
    hdf5::Id memory(H5Screate(H5S_SCALAR), H5Sclose);
    H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, &value);
  }

  void attribute(const char* object, const char* name, std::int64_t value) {
    fresh_attribute(object, name, H5T_STD_I64LE, &value, H5T_NATIVE_INT64);
  }

  void attribute(const char* object, const char* name, const char* text) {
    hdf5::Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), std::string(text).size());
    fresh_attribute(object, name, type.get(), text, type.get());
  }

  void link_to_other_file(const char* name) {
    remove(name);
    H5Lcreate_external("/etc/other.h5", "/Points", file_.get(), name, H5P_DEFAULT, H5P_DEFAULT);
  }

 private:
  void fresh_attribute(const char* object, const char* name, hid_t type, const void* value,
                       hid_t memory_type) {
    hdf5::Id at(H5Oopen(file_.get(), object, H5P_DEFAULT), H5Oclose);
    H5Adelete(at.get(), name);
    hdf5::Id space(H5Screate(H5S_SCALAR), H5Sclose);
    hdf5::Id attribute(H5Acreate2(at.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
    H5Awrite(attribute.get(), memory_type, value);
  }

  hdf5::Id file_;
};

struct BadFile {
  const char* description;
  std::function<void(const Path&)> spoil;  ///< a good file
};

BadFile edited(const char* description, std::function<void(Edit&)> edit) {
  return {description, [edit](const Path& path) {
            Edit open(path);
            edit(open);
          }};
}

hdf5::Id never_written() { return hdf5::Id(H5Pcreate(H5P_DATASET_CREATE), H5Pclose); }

hdf5::Id stored_elsewhere() {
  hdf5::Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_external(properties.get(), "/etc/passwd", 0, 5 * 2 * 8);
  return properties;
}

const std::vector<BadFile> bad_files = {
    {"is missing", [](const Path& path) { std::filesystem::remove(path); }},
    {"is a folder",
     [](const Path& path) {
       std::filesystem::remove(path);
       std::filesystem::create_directory(path);
     }},
    {"is empty", [](const Path& path) { std::ofstream(path, std::ios::trunc); }},
    {"is text", [](const Path& path) { std::ofstream(path, std::ios::trunc) << "v 0 0 0\n"; }},
    {"is cut off in the middle",
     [](const Path& path) {
       std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
     }},
    edited("has no /VTKHDF", [](Edit& e) { e.remove("/VTKHDF"); }),
    edited("is of another kind",
           [](Edit& e) { e.attribute("/VTKHDF", "Type", "UnstructuredGrid"); }),
    edited("has a type that is a number", [](Edit& e) { e.attribute("/VTKHDF", "Type", 7); }),
    edited("is of an older version", [](Edit& e) { e.attribute("/VTKHDF", "Version", 1); }),
    edited("has no Steps", [](Edit& e) { e.remove("/VTKHDF/Steps"); }),
    edited("has no frames", [](Edit& e) { e.attribute("/VTKHDF/Steps", "NSteps", 0L); }),
    edited("has a negative number of frames",
           [](Edit& e) { e.attribute("/VTKHDF/Steps", "NSteps", -2); }),
    edited("has a time that is NaN",
           [](Edit& e) { e.set("/VTKHDF/Steps/Values", 1, std::nan("")); }),
    edited("has fewer offsets than frames",
           [](Edit& e) { e.replace("/VTKHDF/Steps/PointOffsets", H5T_STD_I64LE, {1}); }),
    edited("has a frame before the first row",
           [](Edit& e) { e.set("/VTKHDF/Steps/PointOffsets", 1, -5); }),
    edited("has a frame after the last row",
           [](Edit& e) { e.set("/VTKHDF/Steps/PointOffsets", 1, 6); }),
    edited("has a frame with parts that do not exist",
           [](Edit& e) { e.set("/VTKHDF/Steps/NumberOfParts", 0, 2); }),
    edited("has more points than rows", [](Edit& e) { e.set("/VTKHDF/NumberOfPoints", 0, 11); }),
    edited("has a negative number of points",
           [](Edit& e) { e.set("/VTKHDF/NumberOfPoints", 0, -1); }),
    edited("has no volumes", [](Edit& e) { e.remove("/VTKHDF/PointData/volume"); }),
    edited("has two-dimensional velocities",
           [](Edit& e) {
             e.replace("/VTKHDF/PointData/velocity", H5T_IEEE_F64LE, {10, 2});
           }),
    edited("has F_E of shape (N,3,3)",
           [](Edit& e) {
             e.replace("/VTKHDF/PointData/F_E", H5T_IEEE_F64LE, {10, 3, 3});
           }),
    edited("has masses that are integers",
           [](Edit& e) { e.replace("/VTKHDF/PointData/mass", H5T_STD_I64LE, {10}); }),
    edited("has ids that are not integers",
           [](Edit& e) { e.replace("/VTKHDF/PointData/id", H5T_IEEE_F64LE, {10}); }),
    edited("has too few masses",
           [](Edit& e) { e.replace("/VTKHDF/PointData/mass", H5T_IEEE_F64LE, {9}); }),
    edited("claims 3·10¹² points",
           [](Edit& e) {
             e.replace("/VTKHDF/Points", H5T_IEEE_F64LE, {1'000'000'000'000, 3},
                       never_written().get());
           }),
    edited("claims 10¹² F_E for 10 points",
           [](Edit& e) {
             e.replace("/VTKHDF/PointData/F_E", H5T_IEEE_F64LE, {1'000'000'000'000, 9},
                       never_written().get());
           }),
    edited("has its points in another file",
           [](Edit& e) { e.link_to_other_file("/VTKHDF/Points"); }),
    edited("has its masses in /etc/passwd",
           [](Edit& e) {
             e.replace("/VTKHDF/PointData/mass", H5T_IEEE_F64LE, {10}, stored_elsewhere().get());
           }),
    edited("has a position that is NaN",
           [](Edit& e) { e.set("/VTKHDF/Points", 3 * 7 + 1, std::nan("")); }),
    edited("has an infinite F_P", [](Edit& e) { e.set("/VTKHDF/PointData/F_P", 9 * 6, INFINITY); }),
    edited("has a particle without mass", [](Edit& e) { e.set("/VTKHDF/PointData/mass", 9, 0); }),
    edited("has a negative volume", [](Edit& e) { e.set("/VTKHDF/PointData/volume", 5, -1); }),
    edited("has a negative material", [](Edit& e) { e.set("/VTKHDF/PointData/material", 5, -1); }),
    edited("has an id twice", [](Edit& e) { e.set("/VTKHDF/PointData/id", 5, 0); }),
    edited("has a /firn of another format",
           [](Edit& e) { e.attribute("/firn", "format", "firn-results"); }),
    edited("has a /firn of a later version", [](Edit& e) { e.attribute("/firn", "version", 2); }),
    edited("has an unknown precision", [](Edit& e) { e.attribute("/firn", "precision", "half"); }),
    edited("has restart data for one frame only",
           [](Edit& e) {
             e.replace("/firn/restart", H5T_STD_U8LE, {1, 3});
           }),
    edited("counts more rows than it has",
           [](Edit& e) { e.attribute("/firn/diagnostics", "rows", 3); }),
    edited("has no momentum", [](Edit& e) { e.remove("/firn/diagnostics/momentum"); })};

/// What reading everything in the file complains of.
std::string message_of(const Path& path) {
  try {
    const TrajectoryReader reader(path);
    for (std::int64_t k = 0; k < reader.frames(); ++k) {
      reader.read_frame(k);
      reader.restart(k);
    }
    reader.diagnostics();
    read_last_frame(path);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "read without complaint";
  return {};
}

std::string table() {
  const TemporaryFolder folder;
  const std::string name = "snow.vtkhdf";
  std::string text;
  for (const BadFile& bad : bad_files) {
    SCOPED_TRACE(bad.description);
    std::filesystem::remove_all(folder / name);
    write_good(folder / name);
    bad.spoil(folder / name);
    std::string message = message_of(folder / name);
    EXPECT_EQ(message.rfind((folder / name).string(), 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    message.erase(0, (folder / name).string().size() - name.size());
    text += std::string("| ") + bad.description + " | `" + message + "` |\n";
  }
  return text;
}

TEST(BadTrajectory, GetsTheMessageThatTheDocumentationLists) {
  const Path document = FIRN_SOURCE_DIR "/docs/files.md";
  std::ifstream in(document);
  std::string text(std::istreambuf_iterator<char>(in), {});
  const std::string head = "| the file | the message |\n|---|---|\n";
  const std::size_t begin = text.find(head) + head.size();
  ASSERT_NE(text.find(head), std::string::npos);
  std::size_t end = begin;
  while (text.compare(end, 2, "| ") == 0) end = text.find('\n', end) + 1;
  const std::string listed = text.substr(begin, end - begin);
  if (std::getenv("FIRN_UPDATE_DOCS") == nullptr) {
    EXPECT_EQ(table(), listed);
  } else {
    text.replace(begin, end - begin, table());
    std::ofstream(document) << text;
  }
}

TEST(BadTrajectory, TheGoodFileIsGood) {
  const TemporaryFolder folder;
  write_good(folder / "snow.vtkhdf");
  const TrajectoryReader reader(folder / "snow.vtkhdf");
  EXPECT_EQ(reader.read_frame(1).particles.size(), 5u);
  EXPECT_EQ(reader.diagnostics().size(), 2u);
}

}  // namespace
}  // namespace firn
