// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/write.hpp"

namespace firn::hdf5 {

void fail_to_write(const std::string& where) {
  throw OutputError(where + ": cannot be written: " + last_error());
}

hid_t written(hid_t result, const std::string& where) {
  if (result < 0) fail_to_write(where);
  return result;
}

Id open_or_create_file(const std::filesystem::path& path) {
  const Id access = file_access();
  const hid_t file = std::filesystem::exists(path)
                         ? H5Fopen(path.c_str(), H5F_ACC_RDWR, access.get())
                         : H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get());
  return {written(file, path.string()), H5Fclose};
}

void create_group(hid_t file, const std::string& name) {
  Id properties(written(H5Pcreate(H5P_GROUP_CREATE), name), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  Id(written(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), name),
     H5Gclose);
}

namespace {

bool has(hid_t location, const std::string& path) {
  // Every part of the path is looked up in turn, as H5Lexists demands.
  for (std::size_t end = 0; end != std::string::npos;) {
    end = path.find('/', end + 1);
    if (H5Lexists(location, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

Id text_type(const std::string& where) {
  Id type(written(H5Tcopy(H5T_C_S1), where), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

Id create_attribute(hid_t object, const std::string& where, const char* name, hid_t type) {
  if (H5Aexists(object, name) > 0) written(H5Adelete(object, name), where);
  const Id space(written(H5Screate(H5S_SCALAR), where), H5Sclose);
  return {written(H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), where),
          H5Aclose};
}

Id dataset_properties(const std::string& name) {
  Id properties(written(H5Pcreate(H5P_DATASET_CREATE), name), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER);
  return properties;
}

Id create(hid_t file, const std::string& name, hid_t type, const Id& space, const Id& properties,
          const char* units) {
  Id dataset(written(H5Dcreate2(file, name.c_str(), type, space.get(), H5P_DEFAULT,
                                properties.get(), H5P_DEFAULT),
                     name),
             H5Dclose);
  if (units != nullptr) write_text(dataset.get(), name, "units", units);
  return dataset;
}

}  // namespace

Id open_or_create_group(hid_t location, const std::string& path) {
  if (!has(location, path)) {
    for (std::size_t end = path.find('/'); end != std::string::npos; end = path.find('/', end + 1))
      if (const std::string above = path.substr(0, end); !has(location, above))
        create_group(location, above);
    create_group(location, path);
  }
  return {written(H5Gopen2(location, path.c_str(), H5P_DEFAULT), path), H5Gclose};
}

void remove(hid_t location, const std::string& path) {
  if (has(location, path)) written(H5Ldelete(location, path.c_str(), H5P_DEFAULT), path);
}

Id create_dataset(hid_t file, const std::string& name, hid_t type, Dimensions dimensions,
                  const char* units) {
  Id space(
      written(H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.begin(), nullptr),
              name),
      H5Sclose);
  return create(file, name, type, space, dataset_properties(name), units);
}

Id create_growing_dataset(hid_t file, const std::string& name, hid_t type, hsize_t size,
                          hsize_t room, const char* units) {
  Id space(written(H5Screate_simple(1, &size, &room), name), H5Sclose);
  Id properties = dataset_properties(name);
  written(H5Pset_chunk(properties.get(), 1, &room), name);
  return create(file, name, type, space, properties, units);
}

void write_constant(hid_t file, const std::string& name, Dimensions dimensions,
                    std::span<const std::int64_t> values) {
  const Id dataset = create_dataset(file, name, H5T_STD_I64LE, dimensions, "1");
  written(H5Dwrite(dataset.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
          name);
}

Id write_numbers(hid_t location, const std::string& name, std::span<const double> values,
                 const char* units) {
  Id dataset = create_dataset(location, name, H5T_IEEE_F64LE, {values.size()}, units);
  write_rows(dataset.get(), name, 0, static_cast<std::int64_t>(values.size()), H5T_NATIVE_DOUBLE,
             values.data());
  return dataset;
}

void write_texts(hid_t location, const std::string& name, const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const hsize_t size = texts.size();
  const Id space(written(H5Screate_simple(1, &size, nullptr), name), H5Sclose);
  const Id type = text_type(name);
  const Id properties(written(H5Pcreate(H5P_DATASET_CREATE), name), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const Id dataset = create(location, name, type.get(), space, properties, nullptr);
  write_rows(dataset.get(), name, 0, static_cast<std::int64_t>(size), type.get(), pointers.data());
}

void write_rows(hid_t dataset, const std::string& where, std::int64_t first, std::int64_t rows,
                hid_t memory_type, const void* values) {
  if (rows == 0) return;
  Id space(written(H5Dget_space(dataset), where), H5Sclose);
  hsize_t dimensions[H5S_MAX_RANK] = {};
  const int rank = H5Sget_simple_extent_dims(space.get(), dimensions, nullptr);
  written(rank, where);
  hsize_t start[H5S_MAX_RANK] = {static_cast<hsize_t>(first)};
  dimensions[0] = static_cast<hsize_t>(rows);
  written(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, dimensions, nullptr),
          where);
  Id memory(written(H5Screate_simple(rank, dimensions, nullptr), where), H5Sclose);
  written(H5Dwrite(dataset, memory_type, memory.get(), space.get(), H5P_DEFAULT, values), where);
}

void write_text(hid_t object, const std::string& where, const char* name, const std::string& text) {
  const Id type = text_type(where);
  const Id attribute = create_attribute(object, where, name, type.get());
  const char* characters = text.c_str();
  written(H5Awrite(attribute.get(), type.get(), &characters), where);
}

void write_integer(hid_t object, const std::string& where, const char* name, std::int64_t value) {
  const Id attribute = create_attribute(object, where, name, H5T_STD_I64LE);
  written(H5Awrite(attribute.get(), H5T_NATIVE_INT64, &value), where);
}

void write_number(hid_t object, const std::string& where, const char* name, double value) {
  const Id attribute = create_attribute(object, where, name, H5T_IEEE_F64LE);
  written(H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &value), where);
}

void rewrite_integer(hid_t file, const std::string& where, const char* name, std::int64_t value) {
  // Not H5Aopen_by_name: HDF5 1.10.8 then refuses to write ("can't locate open attribute").
  Id object(written(H5Oopen(file, where.c_str(), H5P_DEFAULT), where), H5Oclose);
  Id attribute(written(H5Aopen(object.get(), name, H5P_DEFAULT), where), H5Aclose);
  written(H5Awrite(attribute.get(), H5T_NATIVE_INT64, &value), where);
}

}  // namespace firn::hdf5
