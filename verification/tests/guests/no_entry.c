// SPDX-License-Identifier: BSD-3-Clause
/* A shared library that is no guest: the one function is missing. */
int firn_guest_entrance(void);
int firn_guest_entrance(void) { return 0; }
