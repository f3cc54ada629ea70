// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/id.hpp"

#include "io/one_line.hpp"

namespace firn::hdf5 {

namespace {

/// Takes what stands between quotes behind "error message = ", where the
/// low-level driver puts strerror(errno); else keeps the first description.
herr_t collect(unsigned /*depth*/, const H5E_error2_t* error, void* data) {
  std::string& text = *static_cast<std::string*>(data);
  const std::string description = error->desc != nullptr ? error->desc : "";
  const std::string mark = "error message = '";
  const auto begin = description.find(mark);
  if (begin != std::string::npos) {
    const auto from = begin + mark.size();
    text = description.substr(from, description.find('\'', from) - from);
    return 1;
  }
  if (text.empty()) text = description;
  return 0;
}

/// Our objects close what they open. HDF5's own exit handler would write a file
/// once more that a full disk has already made us give up, and crash. It has to be
/// told before any other call of the library.
[[maybe_unused]] const bool no_exit_handler = [] { return H5dont_atexit() >= 0; }();

}  // namespace

std::string last_error() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &text);
  return text.empty() ? "HDF5 gives no reason" : one_line(text, 200);
}

Id file_access() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Id properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(properties.get(), false, true);
  H5Pset_fclose_degree(properties.get(), H5F_CLOSE_STRONG);
  return properties;
}

}  // namespace firn::hdf5
