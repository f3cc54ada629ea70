// SPDX-License-Identifier: BSD-3-Clause
// The same as native_hash.cpp, in WebAssembly under Node:
//   node hash.js firn_web.js PRESET STEPS [PARAMETER=VALUE…]
const path = require('path');
const [, , script, preset, steps, ...settings] = process.argv;

require(path.resolve(script))().then(firn => {
  firn._firn_start(Number(preset));
  for (const setting of settings) {
    const [parameter, value] = setting.split('=');
    firn._firn_set(Number(parameter), Number(value));
  }
  firn._firn_restart();
  for (let stage = 0; stage < 10 * Number(steps); ++stage)
    if (!firn._firn_advance()) {
      console.error(firn.UTF8ToString(firn._firn_error()));
      process.exit(3);
    }
  console.log(firn.UTF8ToString(firn._firn_hash()));
});
