#pragma once
/// The few HDF5 operations that a results file needs: groups, numbers, texts.

#include <hdf5.h>
#include <string>
#include <vector>

namespace firn::results::h5 {

/// Owns one HDF5 handle of any kind.
class Id {
 public:
  /// Throws std::runtime_error naming `what` if id is negative.
  Id(hid_t id, const std::string& what);
  ~Id();
  Id(Id&& other) noexcept : id_(other.id_) { other.id_ = -1; }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }
  hid_t get() const { return id_; }

 private:
  hid_t id_;
};

/// InputError if there is no HDF5 file at `path`.
Id open_file(const std::string& path, bool writable);
Id create_file(const std::string& path);

bool exists(hid_t location, const std::string& path);
/// Groups along the path are created where missing.
Id open_or_create_group(hid_t location, const std::string& path);
std::vector<std::string> children(hid_t group);

void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, const std::string& value);
inline void write_attribute(hid_t object, const std::string& name, const char* value) {
  write_attribute(object, name, std::string(value));
}
/// "" if there is no text attribute of that name.
std::string read_attribute(hid_t object, const std::string& name);

Id write_dataset(hid_t group, const std::string& name, const std::vector<double>& values);
void write_texts(hid_t group, const std::string& name, const std::vector<std::string>& texts);

}  // namespace firn::results::h5
