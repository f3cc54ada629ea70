// SPDX-License-Identifier: BSD-3-Clause
#include "io/trajectory/vtkhdf_group.hpp"

#include <array>
#include <cstdint>
#include <string>

#include "io/hdf5/write.hpp"

namespace firn {

void create_vtkhdf_group(hid_t file) {
  const std::string vtkhdf = "/VTKHDF";
  hdf5::create_group(file, vtkhdf);
  hdf5::Id group(hdf5::written(H5Gopen2(file, vtkhdf.c_str(), H5P_DEFAULT), vtkhdf), H5Gclose);

  const std::array<std::int64_t, 2> version = {2, 0};
  const hsize_t two = 2;
  hdf5::Id pair(hdf5::written(H5Screate_simple(1, &two, nullptr), vtkhdf), H5Sclose);
  hdf5::Id version_attribute(hdf5::written(H5Acreate2(group.get(), "Version", H5T_STD_I64LE,
                                                      pair.get(), H5P_DEFAULT, H5P_DEFAULT),
                                           vtkhdf),
                             H5Aclose);
  hdf5::written(H5Awrite(version_attribute.get(), H5T_NATIVE_INT64, version.data()), vtkhdf);

  // VTK asks for an ASCII string of fixed length here.
  const std::string type = "PolyData";
  hdf5::Id text(hdf5::written(H5Tcopy(H5T_C_S1), vtkhdf), H5Tclose);
  H5Tset_size(text.get(), type.size());
  H5Tset_strpad(text.get(), H5T_STR_NULLPAD);
  hdf5::Id scalar(hdf5::written(H5Screate(H5S_SCALAR), vtkhdf), H5Sclose);
  hdf5::Id type_attribute(hdf5::written(H5Acreate2(group.get(), "Type", text.get(), scalar.get(),
                                                   H5P_DEFAULT, H5P_DEFAULT),
                                        vtkhdf),
                          H5Aclose);
  hdf5::written(H5Awrite(type_attribute.get(), text.get(), type.data()), vtkhdf);
}

}  // namespace firn
