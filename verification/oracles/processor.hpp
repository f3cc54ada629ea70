// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The instruction sets that this processor has, asked of the processor itself and not of the
/// library that dispatches.

#include <string>
#include <vector>

namespace firn::verification {

/// By Highway's names, those for which kernels are to be built.
inline std::vector<std::string> instruction_sets_of_the_processor() {
  std::vector<std::string> names;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq"))
    names.push_back("AVX3");
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) names.push_back("AVX2");
  if (__builtin_cpu_supports("sse4.2")) names.push_back("SSE4");
#elif defined(__aarch64__)
  names.push_back("NEON");  // part of the architecture
#endif
  return names;
}

}  // namespace firn::verification
