// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

namespace firn {

/// Creates /VTKHDF with the attributes that make it poly data of version 2.0.
void create_vtkhdf_group(hid_t file);

}  // namespace firn
