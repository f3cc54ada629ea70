#include "io/results/hdf5_text.hpp"

#include <stdexcept>

#include "firn/error.hpp"

namespace firn::results::h5 {

namespace {

/// Errors come as exceptions, not as HDF5's own print-outs.
void be_quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Id text_type() {
  Id type(H5Tcopy(H5T_C_S1), "text type");
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

void expect(herr_t status, const std::string& what) {
  if (status < 0) throw std::runtime_error("HDF5: " + what);
}

void replace_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
  const Id space(H5Screate(H5S_SCALAR), "scalar");
  const Id attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), name);
  expect(H5Awrite(attribute, type, value), "writing attribute " + name);
}

}  // namespace

Id::Id(hid_t id, const std::string& what) : id_(id) {
  if (id < 0) throw std::runtime_error("HDF5: " + what);
}

Id::~Id() {
  if (id_ < 0) return;
  switch (H5Iget_type(id_)) {
    case H5I_FILE: H5Fclose(id_); break;
    case H5I_GROUP: H5Gclose(id_); break;
    case H5I_DATASET: H5Dclose(id_); break;
    case H5I_DATASPACE: H5Sclose(id_); break;
    case H5I_DATATYPE: H5Tclose(id_); break;
    case H5I_ATTR: H5Aclose(id_); break;
    default: H5Pclose(id_);
  }
}

Id open_file(const std::string& path, bool writable) {
  be_quiet();
  const hid_t file = H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) throw InputError(path, "results file", "not an HDF5 file", "a file of firn bench");
  return Id(file, path);
}

Id create_file(const std::string& path) {
  be_quiet();
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file < 0) throw InputError(path, "results file", "cannot be written", "a writable path");
  return Id(file, path);
}

bool exists(hid_t location, const std::string& path) {
  for (std::size_t at = 0; at != std::string::npos;) {
    at = path.find('/', at + 1);
    if (H5Lexists(location, path.substr(0, at).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

Id open_or_create_group(hid_t location, const std::string& path) {
  if (exists(location, path)) return Id(H5Gopen2(location, path.c_str(), H5P_DEFAULT), path);
  const Id creation(H5Pcreate(H5P_LINK_CREATE), "link properties");
  H5Pset_create_intermediate_group(creation, 1);
  return Id(H5Gcreate2(location, path.c_str(), creation, H5P_DEFAULT, H5P_DEFAULT), path);
}

std::vector<std::string> children(hid_t group) {
  H5G_info_t info;
  expect(H5Gget_info(group, &info), "group");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    char name[512];
    H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
    names.emplace_back(name);
  }
  return names;
}

void write_attribute(hid_t object, const std::string& name, double value) {
  replace_attribute(object, name, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* text = value.c_str();
  replace_attribute(object, name, text_type(), &text);
}

std::string read_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return "";
  const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), name);
  const Id type(H5Aget_type(attribute), name);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) <= 0) return "";
  char* text = nullptr;
  expect(H5Aread(attribute, text_type(), &text), "reading attribute " + name);
  std::string result = text ? text : "";
  H5free_memory(text);
  return result;
}

Id write_dataset(hid_t group, const std::string& name, const std::vector<double>& values) {
  const hsize_t size = values.size();
  const Id space(H5Screate_simple(1, &size, nullptr), name);
  Id set(H5Dcreate2(group, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT,
                    H5P_DEFAULT),
         name);
  if (size > 0)
    expect(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  return set;
}

void write_texts(hid_t group, const std::string& name, const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const hsize_t size = texts.size();
  const Id space(H5Screate_simple(1, &size, nullptr), name);
  const Id type = text_type();
  const Id set(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               name);
  if (size > 0) expect(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), name);
}

}  // namespace firn::results::h5
