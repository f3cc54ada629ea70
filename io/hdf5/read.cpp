// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/read.hpp"

#include <algorithm>
#include <limits>
#include <system_error>

#include "firn/error.hpp"
#include "io/hdf5/reading.hpp"
#include "io/one_line.hpp"

namespace firn::hdf5 {

namespace {

herr_t refuse_external_link(const char*, const char*, const char*, const char*, unsigned*, hid_t,
                            void*) {
  return -1;
}

/// Closing reads, too: what is left of the file's structure.
herr_t close_file(hid_t file) {
  const Reading reading;
  return H5Fclose(file);
}

std::string describe(const std::vector<hsize_t>& dimensions) {
  std::string text = "(";
  for (std::size_t i = 0; i < dimensions.size(); ++i)
    text += (i > 0 ? "," : "") + std::to_string(dimensions[i]);
  return text + ")";
}

const char* name(H5T_class_t type_class) {
  switch (type_class) {
    case H5T_INTEGER: return "integer";
    case H5T_FLOAT: return "floating point";
    case H5T_STRING: return "string";
    default: return "another type";
  }
}

/// Filters that are registered with The HDF Group and often met.
const char* registered_name(H5Z_filter_t filter) {
  switch (filter) {
    case H5Z_FILTER_DEFLATE: return "gzip";
    case H5Z_FILTER_SZIP: return "szip";
    case 305: return "LZO";
    case 307: return "bzip2";
    case 32000: return "LZF";
    case 32001: return "Blosc";
    case 32004: return "LZ4";
    case 32008: return "bitshuffle";
    case 32013: return "ZFP";
    case 32015: return "Zstandard";
    case 32017: return "SZ";
    case 32026: return "Blosc2";
    default: return nullptr;
  }
}

/// Why a dataset could not be read, if that is a filter that this machine does not have;
/// otherwise empty.
std::string missing_filter(hid_t dataset) {
  const Id properties(H5Dget_create_plist(dataset), H5Pclose);
  const int count = H5Pget_nfilters(properties.get());
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    char stored_name[64] = "";
    const H5Z_filter_t filter =
        H5Pget_filter2(properties.get(), static_cast<unsigned>(i), &flags, &values, nullptr,
                       sizeof stored_name - 1, stored_name, &config);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    const char* known = registered_name(filter);
    const std::string called = known != nullptr ? known : one_line(stored_name, 60);
    return "it is compressed with filter " + std::to_string(filter) +
           (called.empty() ? "" : " (" + called + ")") +
           ", for which HDF5 finds no plugin here (HDF5_PLUGIN_PATH); gzip is always there";
  }
  return "";
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(path.string() + ": cannot be opened: is a directory");
  file_bytes_ = static_cast<double>(std::filesystem::file_size(path, error));
  if (error) throw InputError(path.string() + ": cannot be opened: " + error.message());
  const Reading reading(path);
  const Id access = file_access();
  file_ = Id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), close_file);
  if (!file_) throw InputError(path.string() + ": is not a readable HDF5 file: " + last_error());
  links_ = Id(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
  H5Pset_elink_cb(links_.get(), refuse_external_link, nullptr);
}

bool InputFile::has(const std::string& name) const {
  const Reading reading(path_);
  // Every part of the path is looked up in turn, as H5Lexists demands.
  for (std::size_t end = name.find('/', 1); true; end = name.find('/', end + 1)) {
    if (H5Lexists(file_.get(), name.substr(0, end).c_str(), links_.get()) <= 0) return false;
    if (end == std::string::npos) break;
  }
  return H5Oexists_by_name(file_.get(), name.c_str(), links_.get()) > 0;
}

bool InputFile::has_attribute(const std::string& object, const char* attribute_name) const {
  const Reading reading(path_);
  return has(object) &&
         H5Aexists_by_name(file_.get(), object.c_str(), attribute_name, links_.get()) > 0;
}

std::vector<std::string> InputFile::children(const std::string& group) const {
  const Reading reading(path_);
  std::vector<std::string> names;
  H5G_info_t info;
  if (!has(group) || H5Gget_info_by_name(file_.get(), group.c_str(), &info, links_.get()) < 0)
    return names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto name_of = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(file_.get(), group.c_str(), H5_INDEX_NAME, H5_ITER_INC, i, text,
                                size, links_.get());
    };
    const ssize_t length = name_of(nullptr, 0);
    if (length < 0) throw InputError(where(group) + ": cannot be read: " + last_error());
    std::string name(static_cast<std::size_t>(length), '\0');
    name_of(name.data(), name.size() + 1);
    names.push_back(name);
  }
  return names;
}

/// Deflate packs at most 1032 : 1.
constexpr double best_packing = 1032;

/// So few bytes do no harm, stored or not.
constexpr double harmless_bytes = 65536;

/// Whether the bytes stored for the dataset itself can hold all its values.
bool InputFile::is_stored(const InputDataset& dataset, double bytes) const {
  const Id properties(H5Dget_create_plist(dataset.id_.get()), H5Pclose);
  const double packing = H5Pget_layout(properties.get()) == H5D_CHUNKED ? best_packing : 1;
  const double stored = static_cast<double>(H5Dget_storage_size(dataset.id_.get()));
  return bytes <= packing * std::min(stored, file_bytes_);
}

/// A claim that nothing stands behind is refused before anybody makes room for it. Values that
/// were never written are honest: HDF5 fills them in. But their number must be that of an array
/// that is there, and the file large enough to hold them packed.
void InputFile::require_honest_size(const InputDataset& dataset, double bytes,
                                    std::int64_t stored_rows) const {
  const Id properties(H5Dget_create_plist(dataset.id_.get()), H5Pclose);
  if (H5Pget_layout(properties.get()) == H5D_VIRTUAL || H5Pget_external_count(properties.get()) > 0)
    throw InputError(dataset.where(), "location of its values", "another file", "this file");
  if (bytes <= harmless_bytes || is_stored(dataset, bytes)) return;
  if (dataset.rows() <= stored_rows && bytes <= best_packing * file_bytes_) return;
  throw InputError(dataset.where(), "size of the dataset", to_text(bytes) + " bytes",
                   "what the " +
                       to_text(static_cast<double>(H5Dget_storage_size(dataset.id_.get()))) +
                       " bytes stored for it can hold");
}

InputDataset InputFile::dataset(const std::string& path, Kind kind, std::int64_t components,
                                std::int64_t stored_rows) const {
  const Reading reading(path_);
  InputDataset dataset;
  dataset.where_ = where(path);
  if (!has(path))
    throw InputError(dataset.where_ + (H5Lexists(file_.get(), path.c_str(), links_.get()) > 0
                                           ? ": is a link to another file or to nothing"
                                           : ": missing dataset"));
  dataset.id_ = Id(H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.id_) throw InputError(dataset.where_ + ": cannot be opened: " + last_error());

  Id type(H5Dget_type(dataset.id_.get()), H5Tclose);
  const H5T_class_t type_class = H5Tget_class(type.get());
  const std::size_t size = H5Tget_size(type.get());
  const bool fits = kind == Kind::real ? type_class == H5T_FLOAT && (size == 4 || size == 8)
                                       : type_class == H5T_INTEGER && size <= 8;
  if (!fits)
    throw InputError(
        dataset.where_, "type",
        std::string(name(type_class)) + " of " + std::to_string(size) + " bytes",
        kind == Kind::real ? "floating point of 4 or 8 bytes" : "integer of at most 8 bytes");

  Id space(H5Dget_space(dataset.id_.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> dimensions(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space.get(), dimensions.data(), nullptr);
  const bool plain = rank == 1 && components <= 1;
  const bool table =
      rank == 2 && (components == 0 || dimensions[1] == static_cast<hsize_t>(components));
  if (!plain && !table)
    throw InputError(dataset.where_, "shape", describe(dimensions),
                     components <= 1 ? "(N)" : "(N," + std::to_string(components) + ")");

  double bytes = static_cast<double>(size);
  for (const hsize_t n : dimensions) bytes *= static_cast<double>(n);
  dataset.rows_ = static_cast<std::int64_t>(dimensions[0]);
  if (table) dataset.components_ = static_cast<std::int64_t>(dimensions[1]);
  require_honest_size(dataset, bytes, stored_rows);
  return dataset;
}

std::int64_t InputFile::stored_rows(const std::string& path) const {
  const Reading reading(path_);
  if (!has(path)) return 0;
  InputDataset dataset;
  dataset.id_ = Id(H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.id_) return 0;
  const Id type(H5Dget_type(dataset.id_.get()), H5Tclose);
  const Id space(H5Dget_space(dataset.id_.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1) return 0;
  std::vector<hsize_t> dimensions(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), dimensions.data(), nullptr);
  double bytes = static_cast<double>(H5Tget_size(type.get()));
  for (const hsize_t n : dimensions) bytes *= static_cast<double>(n);
  return is_stored(dataset, bytes) ? static_cast<std::int64_t>(dimensions[0]) : 0;
}

void InputDataset::read_as(hid_t memory_type, std::int64_t first, std::int64_t rows,
                           void* values) const {
  if (first < 0 || rows < 0 || first > rows_ - rows)
    throw InputError(where_, "rows asked for",
                     std::to_string(first) + " … " + std::to_string(first + rows - 1),
                     "0 … " + std::to_string(rows_ - 1));
  if (rows == 0) return;
  const Reading reading;
  Id space(H5Dget_space(id_.get()), H5Sclose);
  hsize_t dimensions[H5S_MAX_RANK] = {};
  const int rank = H5Sget_simple_extent_dims(space.get(), dimensions, nullptr);
  hsize_t start[H5S_MAX_RANK] = {static_cast<hsize_t>(first)};
  dimensions[0] = static_cast<hsize_t>(rows);
  Id memory(H5Screate_simple(rank, dimensions, nullptr), H5Sclose);
  if (rank < 1 ||
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, dimensions, nullptr) < 0 ||
      H5Dread(id_.get(), memory_type, memory.get(), space.get(), H5P_DEFAULT, values) < 0) {
    const std::string reason = last_error(), filter = missing_filter(id_.get());
    throw InputError(where_ + ": cannot be read: " + (filter.empty() ? reason : filter));
  }
}

void InputDataset::read(std::int64_t first, std::int64_t rows, double* values) const {
  read_as(H5T_NATIVE_DOUBLE, first, rows, values);
}

void InputDataset::read(std::int64_t first, std::int64_t rows, std::int64_t* values) const {
  read_as(H5T_NATIVE_INT64, first, rows, values);
}

void InputDataset::read(std::int64_t first, std::int64_t rows, std::byte* values) const {
  read_as(H5T_NATIVE_UINT8, first, rows, values);
}

std::vector<std::int64_t> InputFile::integers(const std::string& path, std::int64_t count,
                                              std::int64_t low, std::int64_t high) const {
  const InputDataset data = dataset(path, Kind::integer, 1);
  if (data.rows() < count)
    throw InputError(data.where(), "number of values", std::to_string(data.rows()),
                     "at least " + std::to_string(count));
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  data.read(0, count, values.data());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < low || values[i] > high)
      throw InputError(data.where() + "[" + std::to_string(i) + "]", "value",
                       std::to_string(values[i]),
                       std::to_string(low) + " … " + std::to_string(high));
  return values;
}

Id InputFile::attribute(const std::string& object, const char* attribute_name,
                        H5T_class_t type_class) const {
  const Reading reading(path_);
  const std::string at = where(object) + ": attribute " + attribute_name;
  if (!has(object)) throw InputError(where(object) + ": missing group");
  if (H5Aexists_by_name(file_.get(), object.c_str(), attribute_name, links_.get()) <= 0)
    throw InputError(at + ": missing");
  Id id(H5Aopen_by_name(file_.get(), object.c_str(), attribute_name, H5P_DEFAULT, links_.get()),
        H5Aclose);
  if (!id) throw InputError(at + ": cannot be opened: " + last_error());
  Id type(H5Aget_type(id.get()), H5Tclose);
  if (H5Tget_class(type.get()) != type_class)
    throw InputError(at, "type", name(H5Tget_class(type.get())), name(type_class));
  return id;
}

std::vector<std::int64_t> InputFile::integer_list_attribute(const std::string& object,
                                                            const char* attribute_name) const {
  const Reading reading(path_);
  const Id id = attribute(object, attribute_name, H5T_INTEGER);
  Id space(H5Aget_space(id.get()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  constexpr hssize_t most = 16;
  const std::string at = where(object) + ": attribute " + attribute_name;
  if (count < 1 || count > most)
    throw InputError(at, "number of values", std::to_string(count), "1 … 16");
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  if (H5Aread(id.get(), H5T_NATIVE_INT64, values.data()) < 0)
    throw InputError(at + ": cannot be read: " + last_error());
  return values;
}

std::int64_t InputFile::integer_attribute(const std::string& object,
                                          const char* attribute_name) const {
  return integer_list_attribute(object, attribute_name)[0];
}

std::string InputFile::text_attribute(const std::string& object, const char* attribute_name) const {
  const std::string at = where(object) + ": attribute " + attribute_name;
  const Reading reading(path_);
  const Id id = attribute(object, attribute_name, H5T_STRING);
  Id space(H5Aget_space(id.get()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.get()) != 1)
    throw InputError(at, "number of values",
                     std::to_string(H5Sget_simple_extent_npoints(space.get())), "1");
  Id type(H5Aget_type(id.get()), H5Tclose);
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    Id memory_type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory_type.get(), H5T_VARIABLE);
    H5Tset_cset(memory_type.get(), H5Tget_cset(type.get()));
    if (H5Aread(id.get(), memory_type.get(), &text) < 0)
      throw InputError(at + ": cannot be read: " + last_error());
    const std::string copy = text != nullptr ? text : "";
    H5free_memory(text);
    return copy;
  }
  const std::size_t size = H5Tget_size(type.get());
  if (static_cast<double>(size) > file_bytes_)
    throw InputError(at, "length", std::to_string(size), "what the file can hold");
  std::string text(size, '\0');
  if (H5Aread(id.get(), type.get(), text.data()) < 0)
    throw InputError(at + ": cannot be read: " + last_error());
  text.resize(std::min(text.find('\0'), text.size()));
  if (H5Tget_strpad(type.get()) == H5T_STR_SPACEPAD) text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace firn::hdf5
