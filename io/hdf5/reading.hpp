// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// HDF5 1.10 itself crashes on some damaged files, because it trusts the lengths they state.
/// Checking them beforehand would mean writing HDF5 again, but a program can at least report
/// which file it was reading.

#include <filesystem>

namespace firn::hdf5 {

/// Lives around every call that reads a file.
class Reading {
 public:
  Reading() noexcept;
  explicit Reading(const std::filesystem::path& path) noexcept;
  ~Reading();
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
};

/// The file that HDF5 is reading at this moment, or null. Safe in a handler of signals.
const char* file_being_read() noexcept;

}  // namespace firn::hdf5
