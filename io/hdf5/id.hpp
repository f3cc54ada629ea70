// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// HDF5 identifiers that close themselves, and its error stack as one line.

#include <hdf5.h>
#include <string>
#include <utility>

namespace firn::hdf5 {

/// Owner of one HDF5 identifier; < 0 = none.
class Id {
 public:
  using Close = herr_t (*)(hid_t);

  Id() = default;
  Id(hid_t id, Close close) : id_(id), close_(close) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Id() {
    if (id_ >= 0) close_(id_);
  }

  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Why the last HDF5 call failed: the system's message where a system call was
/// the cause ("No space left on device"), else HDF5's innermost description.
std::string last_error();

/// Access properties of every file that Firn opens: no lock is taken, so that a
/// run can be watched while it writes and a file can be read from a medium
/// without locks; closing the file closes every object in it. From the first
/// call on HDF5 prints no error stack in this process: failures are exceptions.
Id file_access();

}  // namespace firn::hdf5
