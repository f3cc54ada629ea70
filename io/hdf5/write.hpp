#pragma once
/// Creating and filling HDF5 objects. Every function throws OutputError, which
/// names the object and the reason.

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

#include "io/hdf5/id.hpp"
#include "io/output_error.hpp"

namespace firn::hdf5 {

/// "WHERE: cannot be written: REASON".
[[noreturn]] void fail_to_write(const std::string& where);

/// `result`, unless it is HDF5's sign of failure.
hid_t written(hid_t result, const std::string& where);

using Dimensions = std::initializer_list<hsize_t>;

void create_group(hid_t file, const std::string& name);

/// Contiguous, of fixed size, its place in the file taken at once and not
/// filled, with a `units` attribute and without time stamps.
Id create_dataset(hid_t file, const std::string& name, hid_t type, Dimensions dimensions,
                  const char* units);

/// One chunk of `room` values, taken at once, of which `size` count at first.
/// H5Dset_extent() up to `room` then changes one number in the file.
Id create_growing_dataset(hid_t file, const std::string& name, hid_t type, hsize_t size,
                          hsize_t room, const char* units);

/// A dataset of integers that is complete from the start.
void write_constant(hid_t file, const std::string& name, Dimensions dimensions,
                    std::span<const std::int64_t> values);

/// Rows first … first + rows − 1 of a dataset, from `values` in `memory_type`.
void write_rows(hid_t dataset, const std::string& where, std::int64_t first, std::int64_t rows,
                hid_t memory_type, const void* values);

/// Attributes: a UTF-8 string of variable length; integers, new and known ones.
void write_text(hid_t object, const std::string& where, const char* name, const std::string& text);
void write_integer(hid_t object, const std::string& where, const char* name, std::int64_t value);
void rewrite_integer(hid_t file, const std::string& where, const char* name, std::int64_t value);

}  // namespace firn::hdf5
