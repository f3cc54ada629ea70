// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Creating and filling HDF5 objects. Every function throws OutputError, which
/// names the object and the reason.

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "io/hdf5/id.hpp"
#include "io/output_error.hpp"

namespace firn::hdf5 {

/// "WHERE: cannot be written: REASON".
[[noreturn]] void fail_to_write(const std::string& where);

/// `result`, unless it is HDF5's sign of failure.
hid_t written(hid_t result, const std::string& where);

/// The file at `path` to be changed; a new one if there is none.
Id open_or_create_file(const std::filesystem::path& path);

using Dimensions = std::initializer_list<hsize_t>;

void create_group(hid_t file, const std::string& name);

/// The group at `path`, created together with those above it where missing.
Id open_or_create_group(hid_t location, const std::string& path);

/// Removes the object at `path` if there is one.
void remove(hid_t location, const std::string& path);

/// Contiguous, of fixed size, its place in the file taken at once and not
/// filled, without time stamps; with a `units` attribute unless `units` is null.
Id create_dataset(hid_t file, const std::string& name, hid_t type, Dimensions dimensions,
                  const char* units);

/// One chunk of `room` values, taken at once, of which `size` count at first.
/// H5Dset_extent() up to `room` then changes one number in the file.
Id create_growing_dataset(hid_t file, const std::string& name, hid_t type, hsize_t size,
                          hsize_t room, const char* units);

/// A dataset of integers that is complete from the start.
void write_constant(hid_t file, const std::string& name, Dimensions dimensions,
                    std::span<const std::int64_t> values);

/// A list that is complete from the start: 64-bit floats, UTF-8 strings of variable length.
Id write_numbers(hid_t location, const std::string& name, std::span<const double> values,
                 const char* units);
void write_texts(hid_t location, const std::string& name, const std::vector<std::string>& texts);

/// Rows first … first + rows − 1 of a dataset, from `values` in `memory_type`.
void write_rows(hid_t dataset, const std::string& where, std::int64_t first, std::int64_t rows,
                hid_t memory_type, const void* values);

/// Attributes: a UTF-8 string of variable length, an integer, a 64-bit float. They replace one of
/// the same name. rewrite_integer() changes an integer in its place in the file.
void write_text(hid_t object, const std::string& where, const char* name, const std::string& text);
void write_integer(hid_t object, const std::string& where, const char* name, std::int64_t value);
void write_number(hid_t object, const std::string& where, const char* name, double value);
void rewrite_integer(hid_t file, const std::string& where, const char* name, std::int64_t value);

}  // namespace firn::hdf5
