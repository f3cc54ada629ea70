// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// What one collider does to one velocity (step 5 of the method).

#include "firn/collider.hpp"

namespace firn::check {

enum class ContactKind { none, separates, sticks, slides };

/// `none` outside the collider. In a sticky collider everything sticks.
ContactKind contact_kind(const Collider& collider, const Contact& contact, const Vec3& v);

/// v after contact with this collider [m/s].
Vec3 respond(const Collider& collider, const Contact& contact, const Vec3& v);

}  // namespace firn::check
