// SPDX-License-Identifier: BSD-3-Clause
/// broken_command FAULT IN OUT STEPS: a guest command that breaks as it is told.

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <hdf5.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Overwrites dataset `name` of the file, all of it, by what `change` makes of it.
template <class T, class Change>
void edit(const fs::path& path, const char* name, hid_t type, Change change) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
  const hid_t space = H5Dget_space(data);
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  change(values);
  H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(data);
  H5Fclose(file);
}

/// Puts an array of zeros in the place of dataset `name`, or nothing (rank 0).
void replace(const fs::path& path, const char* name, hid_t type, int rank,
             const std::vector<hsize_t>& dimensions) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(file, name, H5P_DEFAULT);
  if (rank > 0) {
    const hid_t space = H5Screate_simple(rank, dimensions.data(), nullptr);
    const hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const std::vector<char> zeros(4096);
    H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
    H5Dclose(data);
    H5Sclose(space);
  }
  H5Fclose(file);
}

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Faults that need no trajectory. Comes back from those it does not know.
void break_without_file(const std::string& fault, const fs::path& in, const fs::path& out) {
  if (fault == "segfault") raise(SIGSEGV);
  if (fault == "abort") {
    std::fputs("terminate called\n", stderr);
    std::abort();
  }
  if (fault == "exit") std::exit(3);
  if (fault == "early") std::exit(0);
  if (fault == "words") {
    std::fputs("Traceback (most recent call last):\nValueError: mass is \x1b[31mnegative\n\n",
               stderr);
    std::exit(1);
  }
  if (fault == "hang") {
    std::signal(SIGTERM, SIG_IGN);
    for (;;) pause();
  }
  if (fault == "spin")
    for (volatile unsigned n = 0;;) static_cast<void>(n);
  if (fault == "print")
    for (;;) std::puts("and another line of output");
  if (fault == "empty") write(out, "");
  if (fault == "text") write(out, "x y z\n0 0 0\n");
  if (fault == "directory") fs::create_directory(out);
  if (fault == "pipe" && mkfifo(out.c_str(), 0600) != 0) std::exit(9);
  if (fault == "endless") {  // a file of 2^40 bytes
    std::ofstream file(out);
    file.seekp(std::streamoff(1) << 40).put('x').flush();
  }
  if (fault == "clear") fs::remove_all(in.parent_path());
  if (fault == "stdin" && std::getchar() != EOF) std::exit(9);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 8;
  const std::string fault = argv[1];
  const fs::path in = argv[2], out = argv[3];
  break_without_file(fault, in, out);
  if (fs::exists(out) || !fs::exists(in)) return 0;

  fs::copy_file(in, out);  // a trajectory that can be read; the particles have not moved
  if (fault == "half") fs::resize_file(out, fs::file_size(out) / 2);
  if (fault == "nan")
    edit<double>(out, "/VTKHDF/Points", H5T_NATIVE_DOUBLE, [](auto& x) { x[4] = x[4] * 0 / 0.0; });
  if (fault == "ids")
    edit<std::int64_t>(out, "/VTKHDF/PointData/id", H5T_NATIVE_INT64,
                       [](auto& id) { std::swap(id[0], id[1]); });
  if (fault == "fewer")
    edit<std::int64_t>(out, "/VTKHDF/NumberOfPoints", H5T_NATIVE_INT64, [](auto& n) { --n[0]; });
  if (fault == "more")
    edit<std::int64_t>(out, "/VTKHDF/NumberOfPoints", H5T_NATIVE_INT64, [](auto& n) { n[0] = 99; });
  if (fault == "plane") replace(out, "/VTKHDF/PointData/velocity", H5T_NATIVE_DOUBLE, 2, {2, 2});
  if (fault == "integers") replace(out, "/VTKHDF/PointData/mass", H5T_NATIVE_INT, 1, {2});
  if (fault == "missing") replace(out, "/VTKHDF/PointData/F_P", 0, 0, {});
  if (fault == "noise") {  // all of the file's structure is overwritten, its signature stays
    std::fstream file(out, std::ios::in | std::ios::out | std::ios::binary);
    std::uint32_t state = 1;
    for (std::streamoff at = 16; at < 4096; ++at) {
      state = state * 1664525 + 1013904223;
      file.seekp(at).put(static_cast<char>(state >> 24));
    }
  }
  if (fault == "leftover" && fork() == 0) {  // holds standard output for as long as it can
    setsid();
    sleep(600);
  }
  return 0;
}
