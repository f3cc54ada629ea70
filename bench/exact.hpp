#pragma once
/// The problems with known solutions that verification and measurements share.

#include "verification/oracles/exact/exact.hpp"

namespace firn::bench {
using namespace exact;
}
