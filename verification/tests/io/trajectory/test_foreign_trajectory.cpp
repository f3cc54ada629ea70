// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories as other programs write them: arrays left to their fill value, one frame without
/// Steps, padded strings, filters that are not installed.

#include <gtest/gtest.h>
#include <hdf5.h>
#include <vector>

#include "firn/error.hpp"
#include "io/hdf5/id.hpp"
#include "io/hdf5/write.hpp"
#include "io/trajectory/reader.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::TemporaryFolder;
using Shape = std::vector<hsize_t>;

/// More than any file may claim without bytes: F_E alone takes 216 kB.
constexpr hsize_t N = 3000;

hdf5::Id properties() { return {H5Pcreate(H5P_DATASET_CREATE), H5Pclose}; }

hdf5::Id chunked(bool deflate) {
  hdf5::Id list = properties();
  const hsize_t chunk[] = {500, 9};
  H5Pset_chunk(list.get(), 2, chunk);
  if (deflate) H5Pset_deflate(list.get(), 9);
  return list;
}

/// A file with one frame at t = 0; everything is written but F_P.
class OneFrame {
 public:
  explicit OneFrame(const std::filesystem::path& path)
      : file_(hdf5::open_or_create_file(path)), path_(path) {
    for (const char* group : {"VTKHDF", "VTKHDF/PointData"})
      hdf5::open_or_create_group(file_.get(), group);
    text("PolyData", H5T_STR_NULLTERM, 8);
    const hsize_t two = 2;
    const std::int64_t version[] = {2, 0};
    const hdf5::Id at(H5Gopen2(file_.get(), "/VTKHDF", H5P_DEFAULT), H5Gclose);
    const hdf5::Id space(H5Screate_simple(1, &two, nullptr), H5Sclose);
    const hdf5::Id attribute(
        H5Acreate2(at.get(), "Version", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    H5Awrite(attribute.get(), H5T_NATIVE_INT64, version);
    std::vector<double> ones(9 * N, 1.0), points(3 * N);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = 1e-3 * static_cast<double>(i);
    std::vector<double> ids(N);
    for (std::size_t i = 0; i < N; ++i) ids[i] = static_cast<double>(i);
    add("/VTKHDF/NumberOfPoints", H5T_STD_I64LE, {1}, std::vector<double>{N});
    add("/VTKHDF/Points", H5T_IEEE_F64LE, {N, 3}, points);
    add("/VTKHDF/PointData/velocity", H5T_IEEE_F64LE, {N, 3}, ones);
    add("/VTKHDF/PointData/mass", H5T_IEEE_F64LE, {N}, ones);
    add("/VTKHDF/PointData/volume", H5T_IEEE_F64LE, {N}, ones);
    add("/VTKHDF/PointData/F_E", H5T_IEEE_F64LE, {N, 9}, ones);
    add("/VTKHDF/PointData/id", H5T_STD_I64LE, {N}, ids);
    add("/VTKHDF/PointData/material", H5T_STD_I32LE, {N}, std::vector<double>(N, 0.0));
  }

  hdf5::Id create(const char* name, hid_t type, const Shape& shape, const hdf5::Id& list) {
    const hdf5::Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                         H5Sclose);
    return {H5Dcreate2(file_.get(), name, type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
            H5Dclose};
  }

  void add(const char* name, hid_t type, const Shape& shape, const std::vector<double>& values) {
    const hdf5::Id set = create(name, type, shape, properties());
    H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }

  /// The kind of data, as a string of fixed length.
  void text(std::string value, H5T_str_t padding, std::size_t size) {
    value.resize(size, padding == H5T_STR_SPACEPAD ? ' ' : '\0');
    const hdf5::Id at(H5Gopen2(file_.get(), "/VTKHDF", H5P_DEFAULT), H5Gclose);
    H5Adelete(at.get(), "Type");
    const hdf5::Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), size);
    H5Tset_strpad(type.get(), padding);
    const hdf5::Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const hdf5::Id attribute(
        H5Acreate2(at.get(), "Type", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(attribute.get(), type.get(), value.data());
  }

  /// The message of reading it.
  std::string message() {
    close();
    try {
      read_last_frame(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  Particles read() {
    close();
    return read_last_frame(path_);
  }
  void close() { file_ = {}; }

 private:
  hdf5::Id file_;
  std::filesystem::path path_;
};

class ForeignTrajectory : public testing::Test {
 protected:
  ForeignTrajectory() : file(folder_ / "snow.vtkhdf") {}
  TemporaryFolder folder_;
  OneFrame file;
};

constexpr const char* F_P = "/VTKHDF/PointData/F_P";

TEST_F(ForeignTrajectory, AnArrayThatWasNeverWrittenHoldsItsFillValue) {
  const hdf5::Id list = properties();
  const double fill = 1.5;
  H5Pset_fill_value(list.get(), H5T_NATIVE_DOUBLE, &fill);
  file.create(F_P, H5T_IEEE_F64LE, {N, 9}, list);
  const Particles p = file.read();
  ASSERT_EQ(p.size(), N);
  EXPECT_EQ(p.F_P[N - 1](2, 2), 1.5);
  EXPECT_EQ(p.x[N - 1][2], 1e-3 * (3 * N - 1));
}

TEST_F(ForeignTrajectory, SoDoChunksThatWereNeverWritten) {
  const hdf5::Id set = file.create(F_P, H5T_IEEE_F64LE, {N, 9}, chunked(true));
  const std::vector<double> row(9, 2.0);
  hdf5::write_rows(set.get(), F_P, 700, 1, H5T_NATIVE_DOUBLE, row.data());
  const Particles p = file.read();
  EXPECT_EQ(p.F_P[700](0, 0), 2);
  EXPECT_EQ(p.F_P[701](0, 0), 0);
  EXPECT_EQ(p.F_P[N - 1](0, 0), 0);
}

TEST_F(ForeignTrajectory, ItsLengthMustStillBeThatOfAnArrayThatIsThere) {
  file.create(F_P, H5T_IEEE_F64LE, {1'000'000'000'000, 9}, chunked(true));
  EXPECT_NE(file.message().find(std::string(F_P) + ": size of the dataset"), std::string::npos);
}

TEST_F(ForeignTrajectory, AFilterThatIsNotInstalledIsNamed) {
  hdf5::Id list = chunked(false);
  H5Pset_filter(list.get(), 32015, H5Z_FLAG_OPTIONAL, 0, nullptr);
  hdf5::Id set = file.create(F_P, H5T_IEEE_F64LE, {N, 9}, list);
  const hsize_t first[] = {0, 0};
  const std::vector<char> bytes(100, 'z');
  if (H5Zfilter_avail(32015) > 0 ||
      H5Dwrite_chunk(set.get(), H5P_DEFAULT, 0, first, bytes.size(), bytes.data()) < 0)
    GTEST_SKIP() << "HDF5 has this filter";
  set = {};
  const std::string message = file.message();
  EXPECT_NE(message.find("filter 32015 (Zstandard)"), std::string::npos) << message;
  EXPECT_NE(message.find(F_P), std::string::npos) << message;
}

TEST_F(ForeignTrajectory, StringsMayBePaddedWithSpaces) {
  file.add(F_P, H5T_IEEE_F64LE, {N, 9}, std::vector<double>(9 * N, 1.0));
  file.text("PolyData", H5T_STR_SPACEPAD, 16);
  EXPECT_EQ(file.message(), "");
}

TEST_F(ForeignTrajectory, OneFrameNeedsNoSteps) {
  file.add(F_P, H5T_IEEE_F64LE, {N, 9}, std::vector<double>(9 * N, 1.0));
  file.close();
  const TrajectoryReader reader(folder_ / "snow.vtkhdf");
  EXPECT_EQ(reader.frames(), 1);
  EXPECT_EQ(reader.time(0), 0);
  EXPECT_EQ(reader.particles(0), static_cast<std::int64_t>(N));
}

}  // namespace
}  // namespace firn
