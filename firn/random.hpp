// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Random numbers as a pure function of a seed and of indices: no state, no dependence on the
/// order of calls, the same bits from every compiler (std:: distributions promise none of this).

#include <cstdint>
#include <initializer_list>

namespace firn {

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64 bits in
/// which every input bit flips every output bit with probability near ½.
constexpr std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Hash of a seed and a list of integers; every one passes through its own
/// round of mixing, so that permuted or shifted lists are unrelated.
constexpr std::uint64_t hash_words(std::uint64_t seed, std::initializer_list<std::int64_t> words) {
  constexpr std::uint64_t golden_gamma = 0x9e3779b97f4a7c15ULL;
  std::uint64_t hash = mix_bits(seed + golden_gamma);
  for (const std::int64_t word : words)
    hash = mix_bits(hash + golden_gamma + static_cast<std::uint64_t>(word));
  return hash;
}

/// Uniform in [0, 1): the 53 upper bits of the hash.
constexpr double uniform(std::uint64_t seed, std::initializer_list<std::int64_t> words) {
  return static_cast<double>(hash_words(seed, words) >> 11) * 0x1p-53;
}

}  // namespace firn
