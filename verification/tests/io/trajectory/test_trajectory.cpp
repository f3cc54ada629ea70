// SPDX-License-Identifier: BSD-3-Clause
/// Writer and reader: what goes in comes out, to the last bit; what is complete
/// is counted; what stood at the output's place stays until then.

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>

#include "firn/error.hpp"
#include "io/output_error.hpp"
#include "io/trajectory/reader.hpp"
#include "io/trajectory/writer.hpp"
#include "verification/support/same_state.hpp"
#include "verification/support/scenes.hpp"
#include "verification/support/temporary_folder.hpp"
#include "verification/support/through_float.hpp"

namespace firn {
namespace {

using fixtures::odd_particles;
using fixtures::same_particles;
using fixtures::TemporaryFolder;
using fixtures::tiny_scene;

TrajectoryInfo some_info(Precision precision) {
  return {"somebody", precision, 3, "1.2.3", "a processor", "name = \"θ\"\n"};
}

DiagnosticsRow some_row(int n) {
  DiagnosticsRow d;
  for (std::size_t c = 0; c < diagnostics_columns.size(); ++c) {
    const double x = 10.0 * n + static_cast<double>(c);
    const double values[3] = {diagnostics_columns[c].integer ? x : x / 7, x / 11, -x / 13};
    set_column(d, c, values);
  }
  return d;
}

State some_state(int n, int particles) {
  State state;
  state.time = n / 48.0;
  state.step = 2 * n;
  state.particles = odd_particles(particles);
  for (Vec3& x : state.particles.x) x[0] += n;
  return state;
}

std::vector<std::byte> some_bytes(std::size_t size, int n) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::byte>((31 * i + 7 * static_cast<std::size_t>(n)) % 256);
  return bytes;
}

/// Frames 0 … count − 1, each with the two rows of its steps.
void write_trajectory(TrajectoryWriter& writer, int count, int particles,
                      std::size_t restart_size) {
  for (int k = 0; k < count; ++k) {
    if (k > 0) {
      writer.add_row(some_row(2 * k - 2));
      writer.add_row(some_row(2 * k - 1));
    }
    writer.write_frame(some_state(k, particles), some_bytes(restart_size, k));
  }
}

void expect_trajectory(const std::filesystem::path& path, int count, int particles,
                       Precision precision, std::size_t restart_size) {
  const TrajectoryReader reader(path);
  ASSERT_EQ(reader.frames(), count);
  for (int k = 0; k < count; ++k) {
    const State expected = some_state(k, particles);
    const State found = reader.read_frame(k);
    EXPECT_EQ(found.time, expected.time);
    EXPECT_EQ(found.step, expected.step);
    EXPECT_TRUE(same_particles(found.particles, precision == Precision::float64
                                                    ? expected.particles
                                                    : fixtures::through_float(expected.particles)))
        << "frame " << k;
    EXPECT_EQ(reader.restart(k), some_bytes(restart_size, k));
  }
  const std::vector<DiagnosticsRow> rows = reader.diagnostics();
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(count == 0 ? 0 : 2 * (count - 1)));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const DiagnosticsRow expected = some_row(static_cast<int>(r));
    EXPECT_EQ(rows[r].time, expected.time);
    EXPECT_EQ(rows[r].momentum, expected.momentum);
    EXPECT_EQ(rows[r].angular_momentum, expected.angular_momentum);
    EXPECT_EQ(rows[r].center_of_mass, expected.center_of_mass);
    EXPECT_EQ(rows[r].max_J_E, expected.max_J_E);
    EXPECT_EQ(rows[r].grid_nodes, expected.grid_nodes);
    EXPECT_EQ(rows[r].solver_iterations, expected.solver_iterations);
    EXPECT_EQ(rows[r].solver_residual, expected.solver_residual);
  }
}

struct Case {
  Precision precision;
  int particles;
  std::size_t restart_size;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << (c.precision == Precision::float64 ? "double, " : "float, ") << c.particles
       << " particles, " << c.restart_size << " bytes of restart data";
}

class RoundTrip : public ::testing::TestWithParam<Case> {};

TEST_P(RoundTrip, KeepsEveryBit) {
  const auto [precision, particles, restart_size] = GetParam();
  const TemporaryFolder folder;
  const auto path = folder / "out.vtkhdf";
  {
    TrajectoryWriter writer(path, some_info(precision), particles, restart_size, 3, 4);
    write_trajectory(writer, 3, particles, restart_size);
    writer.finish();
  }
  expect_trajectory(path, 3, particles, precision, restart_size);
  const TrajectoryReader reader(path);
  ASSERT_TRUE(reader.info());
  EXPECT_EQ(reader.info()->solver, "somebody");
  EXPECT_EQ(reader.info()->precision, precision);
  EXPECT_EQ(reader.info()->threads, 3);
  EXPECT_EQ(reader.info()->firn_version, "1.2.3");
  EXPECT_EQ(reader.info()->processor, "a processor");
  EXPECT_EQ(reader.info()->scene, "name = \"θ\"\n");
}

// No particles, one, and more than one slice of the writer's buffer (65536).
INSTANTIATE_TEST_SUITE_P(Sizes, RoundTrip,
                         ::testing::Values(Case{Precision::float64, 0, 0},
                                           Case{Precision::float64, 1, 5},
                                           Case{Precision::float64, 7, 0},
                                           Case{Precision::float32, 7, 11},
                                           Case{Precision::float64, 65539, 1}));

TEST(TrajectoryWriter, GrowsInFramesAndRowsAndGivesBackWhatItDidNotUse) {
  const TemporaryFolder folder;
  const auto exact = folder / "exact.vtkhdf", grown = folder / "grown.vtkhdf",
             large = folder / "large.vtkhdf";
  for (const auto& [path, frames, rows] :
       {std::tuple(exact, 9, 16), std::tuple(grown, 1, 0), std::tuple(large, 100, 1000)}) {
    TrajectoryWriter writer(path, some_info(Precision::float64), 5, 3, frames, rows);
    write_trajectory(writer, 9, 5, 3);
    expect_trajectory(path, 9, 5, Precision::float64, 3);  // complete before finish(), too
    writer.finish();
    expect_trajectory(path, 9, 5, Precision::float64, 3);
  }
  // Created without time stamps and of the same size in the end: the same file.
  const auto bytes = [](const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(bytes(exact), bytes(grown));
  EXPECT_EQ(bytes(exact), bytes(large));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".vtkhdf") << entry.path();
}

TEST(TrajectoryWriter, LeavesTheOldFileUntilTheFirstFrameIsComplete) {
  const TemporaryFolder folder;
  const auto path = folder / "out.vtkhdf";
  std::ofstream(path) << "precious";
  {
    TrajectoryWriter writer(path, some_info(Precision::float64), 5, 0, 2, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "out.vtkhdf.partial"));
    State bad = some_state(0, 5);
    bad.particles.F_P[3](1, 2) = std::nan("");
    EXPECT_THROW(writer.write_frame(bad, {}), SimulationError);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out.vtkhdf.partial"));
  std::string text;
  std::ifstream(path) >> text;
  EXPECT_EQ(text, "precious");

  TrajectoryWriter writer(path, some_info(Precision::float64), 5, 0, 2, 0);
  writer.write_frame(some_state(0, 5), {});
  EXPECT_EQ(TrajectoryReader(path).frames(), 1);
}

TEST(TrajectoryWriter, RefusesValuesThatTheFilesPrecisionDoesNotHold) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder / "out.vtkhdf", some_info(Precision::float32), 5, 0, 2, 0);
  writer.write_frame(some_state(0, 5), {});
  State large = some_state(1, 5);
  large.particles.v[4][0] = 1e39;  // the largest float is 3.4e38
  EXPECT_THROW(writer.write_frame(large, {}), SimulationError);
  EXPECT_EQ(TrajectoryReader(folder / "out.vtkhdf").frames(), 1);
}

TEST(TrajectoryWriter, RefusesPlacesWhereItCannotWrite) {
  const TemporaryFolder folder;
  const auto create = [](const std::filesystem::path& path, std::int64_t frames) {
    TrajectoryWriter writer(path, some_info(Precision::float64), 1000, 0, frames, 0);
  };
  EXPECT_THROW(create(folder / "missing/out.vtkhdf", 2), InputError);
  EXPECT_THROW(create(folder.path(), 2), InputError);
  EXPECT_THROW(create("/dev/null", 2), InputError);
  EXPECT_THROW(create(folder / "out.vtkhdf", 1'000'000'000), InputError);  // 200 TB
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(TrajectoryWriter, WritesThroughASymbolicLink) {
  const TemporaryFolder folder;
  std::ofstream(folder / "real.vtkhdf") << "old";
  std::filesystem::create_symlink("real.vtkhdf", folder / "link.vtkhdf");
  TrajectoryWriter writer(folder / "link.vtkhdf", some_info(Precision::float64), 5, 0, 1, 0);
  writer.write_frame(some_state(0, 5), {});
  writer.finish();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.vtkhdf"));
  EXPECT_EQ(TrajectoryReader(folder / "real.vtkhdf").frames(), 1);
}

TEST(TrajectoryReader, GivesTheLastFrameToABody) {
  const TemporaryFolder folder;
  const auto path = folder / "out.vtkhdf";
  TrajectoryWriter writer(path, some_info(Precision::float64), 5, 0, 3, 4);
  write_trajectory(writer, 3, 5, 0);
  EXPECT_TRUE(same_particles(read_last_frame(path), some_state(2, 5).particles));
}

TEST(TrajectoryReader, RefusesAFrameThatIsNotThere) {
  const TemporaryFolder folder;
  const auto path = folder / "out.vtkhdf";
  TrajectoryWriter writer(path, some_info(Precision::float64), 5, 0, 3, 4);
  write_trajectory(writer, 2, 5, 0);
  const TrajectoryReader reader(path);
  EXPECT_THROW(reader.read_frame(2), InputError);
  EXPECT_THROW(reader.read_frame(-1), InputError);
  EXPECT_THROW(reader.time(2), InputError);
  EXPECT_THROW(reader.restart(2), InputError);
}

}  // namespace
}  // namespace firn
