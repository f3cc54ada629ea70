// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Reading HDF5 files that are not trusted. Every function throws InputError
/// with "FILE: OBJECT: …".

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/id.hpp"

namespace firn::hdf5 {

enum class Kind { real, integer };  ///< 32- or 64-bit floating point; any integer

class InputFile;

/// A dataset of checked type and rank. Its rows are the places along its first
/// axis; `components` is the product of the others.
class InputDataset {
 public:
  std::int64_t rows() const { return rows_; }
  std::int64_t components() const { return components_; }
  const std::string& where() const { return where_; }  ///< "FILE: /path"

  /// Rows first … first + rows − 1, components of a row beside each other.
  void read(std::int64_t first, std::int64_t rows, double* values) const;
  void read(std::int64_t first, std::int64_t rows, std::int64_t* values) const;
  void read(std::int64_t first, std::int64_t rows, std::byte* values) const;

 private:
  friend class InputFile;
  void read_as(hid_t memory_type, std::int64_t first, std::int64_t rows, void* values) const;

  Id id_;
  std::string where_;
  std::int64_t rows_ = 0, components_ = 1;
};

/// An HDF5 file opened for reading. Links that lead to other files, virtual and
/// external datasets are refused: a trajectory is one file. So are datasets of
/// more than 64 KiB that claim more values than the bytes stored could hold.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::string where(const std::string& name) const { return path_.string() + ": " + name; }

  bool has(const std::string& name) const;
  bool has_attribute(const std::string& object, const char* name) const;

  /// Names of what is in a group, in alphabetical order; none if there is no such group.
  std::vector<std::string> children(const std::string& group) const;

  /// A dataset of `components` values per row (0: any number). Values that were never written
  /// are read as HDF5 fills them in if there are no more rows than `stored_rows`, which the
  /// caller knows from another array.
  InputDataset dataset(const std::string& name, Kind kind, std::int64_t components,
                       std::int64_t stored_rows = 0) const;

  /// Rows of a dataset for which the file has bytes; 0 if it has not, or there is no dataset.
  std::int64_t stored_rows(const std::string& name) const;

  /// Integers of a dataset with one value per row, the first `count` of them,
  /// each in [low, high].
  std::vector<std::int64_t> integers(const std::string& name, std::int64_t count, std::int64_t low,
                                     std::int64_t high) const;

  std::int64_t integer_attribute(const std::string& object, const char* name) const;
  std::vector<std::int64_t> integer_list_attribute(const std::string& object,
                                                   const char* name) const;
  std::string text_attribute(const std::string& object, const char* name) const;

 private:
  Id attribute(const std::string& object, const char* name, H5T_class_t type_class) const;
  bool is_stored(const InputDataset& dataset, double bytes) const;
  void require_honest_size(const InputDataset& dataset, double bytes,
                           std::int64_t stored_rows) const;

  std::filesystem::path path_;
  double file_bytes_ = 0;
  Id file_, links_;
};

}  // namespace firn::hdf5
