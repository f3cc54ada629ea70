// SPDX-License-Identifier: BSD-3-Clause
/* Loaded before HDF5: looking for an attribute, which only readers do, crashes as HDF5
 * does on a damaged file. */
#include <signal.h>

int H5Aexists_by_name(void);
int H5Aexists_by_name(void) { return raise(SIGSEGV); }
