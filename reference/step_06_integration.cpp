#include "reference/steps.hpp"

namespace firn::reference {

/// Step 6. Integration (Stomakhin et al. 2013, §4.1 step 6), explicit:
///
///     v_i^{n+1} = v_i*                      [m/s]
void integration(Grid& grid) { grid.v_new = grid.v_star; }

}  // namespace firn::reference
