// SPDX-License-Identifier: BSD-3-Clause
// Any bytes are either a trajectory, whose frames hold what its header says, or an
// InputError of one line. HDF5 itself is not instrumented, and it has defects of its own
// (see io/hdf5/reading.hpp): reads out of bounds inside the library are passed over, and
// where it crashes, the input is kept as hdf5-NUMBER and the process ends with status 77,
// for verification/fuzz/run.sh to start it again.
//
// An input that begins as HDF5 files do is taken as it is. Any other is a list of edits to
// a good file, which hits its structure far more often: the number of the file, then
// places (2 bytes, counted in bytes from the one before) with new values (1 byte).

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

#include "io/hdf5/reading.hpp"
#include "io/trajectory/reader.hpp"
#include "verification/fuzz/judge.hpp"

namespace {

using Bytes = std::vector<char>;

/// In memory where there is such a folder. HDF5 wants a path that is really there.
std::string file_path() {
  const bool shm = std::filesystem::is_directory("/dev/shm");
  return (shm ? "/dev/shm/firn-fuzz-" : "/tmp/firn-fuzz-") + std::to_string(getpid());
}

void read_everything(const std::string& path) {
  using firn::fuzz::require;
  const firn::TrajectoryReader reader(path);
  for (std::int64_t frame = 0; frame < std::min<std::int64_t>(reader.frames(), 4); ++frame) {
    require(std::isfinite(reader.time(frame)), "time", "not finite");
    const firn::State state = reader.read_frame(frame);
    const firn::Particles& p = state.particles;
    require(p.size() == static_cast<std::size_t>(reader.particles(frame)), "particles", "lost");
    for (std::size_t i = 0; i < p.size(); ++i)
      require(p.x[i].allFinite() && p.F_E[i].allFinite() && p.m[i] > 0, "particle",
              std::to_string(i));
    reader.restart(frame);
  }
  require(reader.diagnostics().size() == static_cast<std::size_t>(reader.rows()), "rows", "lost");
}

void write(const std::string& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The good files that edits begin with, in the order of their names.
const std::vector<Bytes>& good_files() {
  static const std::vector<Bytes> files = [] {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(FIRN_GOOD_TRAJECTORIES))
      paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<Bytes> all;
    for (const auto& path : paths) {
      read_everything(path.string());  // throws if it is not good: then nothing would be tested
      std::ifstream file(path, std::ios::binary);
      all.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    firn::fuzz::require(!all.empty(), "good files", "none");
    return all;
  }();
  return files;
}

bool is_hdf5(const std::uint8_t* data, std::size_t size) {
  const std::uint8_t signature[] = {0x89, 'H', 'D', 'F'};
  return size >= 4 && std::equal(signature, signature + 4, data);
}

Bytes edited(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return {};
  Bytes bytes = good_files()[data[0] % good_files().size()];
  std::size_t place = 0;
  for (std::size_t i = 1; i + 2 < size; i += 3) {
    place = (place + data[i] + 256u * data[i + 1]) % bytes.size();
    bytes[place] = static_cast<char>(data[i + 2]);
  }
  return bytes;
}

}  // namespace

/// HDF5 forgets memory when it gives up on a file, and looks beyond the end of buffers.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }
/// A length that the file states may be any; malloc says no, and HDF5 takes that well.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "allocator_may_return_null=1"; }
extern "C" const char* __asan_default_suppressions();
extern "C" const char* __asan_default_suppressions() { return "interceptor_via_lib:libhdf5"; }

namespace {

const std::uint8_t* input = nullptr;
std::size_t input_size = 0;

extern "C" void on_crash(int signal) {
  if (firn::hdf5::file_being_read() == nullptr) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // comes when this handler returns
    return;
  }
  const std::string path = "hdf5-" + std::to_string(getpid());
  if (std::FILE* file = std::fopen(path.c_str(), "wb")) {
    std::fwrite(input, 1, input_size, file);
    std::fclose(file);
  }
  _exit(77);
}

/// libFuzzer has set its own handlers before the first input.
bool handle_crashes() {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT}) std::signal(signal, on_crash);
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = file_path();
  static const bool tidy = std::atexit([] { std::remove(file_path().c_str()); }) == 0;
  static const bool handled = handle_crashes();
  firn::fuzz::require(tidy && handled, "atexit", "refused");
  input = data;
  input_size = size;
  write(path, is_hdf5(data, size) ? Bytes(data, data + size) : edited(data, size));
  try {
    read_everything(path);
  } catch (const firn::InputError& error) {
    firn::fuzz::require_message(error, path);
  }
  return 0;
}
