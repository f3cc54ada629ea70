#pragma once
/// The problems with known solutions that verification and measurements share.

#include "verification/exact/exact.hpp"

namespace firn::bench {
using namespace exact;
}
