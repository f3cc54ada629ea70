// SPDX-License-Identifier: BSD-3-Clause
/// Prints the hash of a session after some steps: what the same session must reach as
/// WebAssembly.   firn_web_hash PRESET STEPS [PARAMETER=VALUE…], PARAMETER by its number

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "web/session.hpp"

int main(int argc, char** argv) {
  if (argc < 3) {
    (void)std::fprintf(stderr, "firn_web_hash PRESET STEPS [PARAMETER=VALUE...]\n");
    return 2;
  }
  using namespace firn::web;
  Session session(static_cast<Preset>(std::atoi(argv[1])));
  for (int k = 3; k < argc; ++k) {
    const char* value = std::strchr(argv[k], '=');
    if (value == nullptr) return 2;
    session.set(static_cast<Parameter>(std::atoi(argv[k])), std::strtod(value + 1, nullptr));
  }
  session.restart();
  const long steps = std::atol(argv[2]);
  for (long stage = 0; stage < steps * firn::stage_count; ++stage)
    if (!session.advance()) {
      (void)std::fprintf(stderr, "%s\n", session.error().c_str());
      return 3;
    }
  std::printf("%016" PRIx64 "\n", session.hash());
  return 0;
}
