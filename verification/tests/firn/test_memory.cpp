// SPDX-License-Identifier: BSD-3-Clause
/// How much memory there is, from files as Linux has them, and how much a scene takes.

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "firn/error.hpp"
#include "firn/memory.hpp"
#include "verification/support/temporary_folder.hpp"

namespace firn {
namespace {

using fixtures::TemporaryFolder;

class AvailableMemory : public testing::Test {
 protected:
  void SetUp() override { write("proc/meminfo", "MemTotal: 64 kB\nMemAvailable:   1000000 kB\n"); }
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  TemporaryFolder root_;
};

TEST_F(AvailableMemory, IsWhatTheSystemSays) { EXPECT_EQ(available_memory(root_.path()), 1024e6); }

TEST_F(AvailableMemory, IsLimitedByTheControlGroupOfVersion2AndThoseAboveIt) {
  write("proc/self/cgroup", "0::/box/inner\n");
  write("sys/fs/cgroup/box/inner/memory.max", "max\n");
  EXPECT_EQ(available_memory(root_.path()), 1024e6);
  write("sys/fs/cgroup/box/memory.max", "5000000\n");
  write("sys/fs/cgroup/box/memory.current", "3000000\n");
  write("sys/fs/cgroup/box/memory.stat", "anon 7\ninactive_file 1000000\n");
  EXPECT_EQ(available_memory(root_.path()), 3e6) << "cached files count as free";
  write("sys/fs/cgroup/box/inner/memory.max", "2000000\n");
  EXPECT_EQ(available_memory(root_.path()), 2e6);
}

TEST_F(AvailableMemory, IsLimitedByTheControlGroupOfVersion1) {
  write("proc/self/cgroup", "3:cpu,cpuacct:/other\n7:memory:/box\n");
  write("sys/fs/cgroup/memory/box/memory.limit_in_bytes", "4000000\n");
  write("sys/fs/cgroup/memory/box/memory.usage_in_bytes", "1000000\n");
  EXPECT_EQ(available_memory(root_.path()), 3e6);
  write("sys/fs/cgroup/memory/box/memory.usage_in_bytes", "9000000\n");
  EXPECT_EQ(available_memory(root_.path()), 0);
}

TEST(ExpectedParticles, AreThoseThatSamplingPlaces) {
  GridSettings grid;
  grid.spacing = 0.1;
  Body body;
  body.shape = Sphere{{0.3, 0, 0}, 1.0};
  const double sphere = 8 * 4 / 3.0 * M_PI * 1000;
  EXPECT_NEAR(expected_particles(grid, body), sphere, 0.03 * sphere);
  body.shape = Box{{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(expected_particles(grid, body), 8 * 6000);
}

TEST(RequireMemory, NamesWhatIsNeededAndWhatThereIs) {
  require_memory("scene.toml:3", 1e6, 1000, 1e9);
  try {
    require_memory("scene.toml:3", 2e6, 1000, 1e9);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "scene.toml:3: memory for about 2e+06 particles: got 2 GB, allowed: the 1 GB "
                 "available");
  }
}

}  // namespace
}  // namespace firn
