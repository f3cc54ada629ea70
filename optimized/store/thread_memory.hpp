// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// The scratch memory of one thread, and how much work it takes at a time.

#include <algorithm>
#include <cstdint>
#include <omp.h>
#include <vector>

#include "optimized/store/memory.hpp"

namespace firn::optimized {

/// How many of n blocks a thread takes at a time: up to 16 neighbours, since each block asks for
/// the next one's particles in advance and shares nodes with it, but six turns per thread at least,
/// so that a thread which is held up holds up nobody.
inline std::size_t blocks_per_turn(std::size_t n, std::size_t threads) {
  constexpr std::size_t most = 16, turns = 6;
  return std::clamp(n / (turns * threads), std::size_t{1}, most);
}

/// Number of the calling thread among those of the innermost parallel loop.
inline std::size_t this_thread() { return static_cast<std::size_t>(omp_get_thread_num()); }

template <class T>
struct ThreadMemory {
  AlignedArray<T> numbers, sorting;
  AlignedArray<std::uint8_t> cells;
  AlignedArray<std::int32_t> leavers;
  AlignedArray<NodeFields<T>> node;
  AlignedArray<T> sums;
  std::vector<std::size_t> colliders;
  Workspace<T> work{};

  /// Room for blocks of up to `particles`.
  void require(std::size_t particles, const TileShape& shape);
  /// Room for so many bytes in `numbers` alone, and `spare` more where it has to grow.
  void require_bytes(std::size_t n, std::size_t spare) {
    require_numbers(n / sizeof(T), spare / sizeof(T));
  }
  std::size_t bytes() const;

 private:
  void require_numbers(std::size_t n, std::size_t spare);
  void lay_out_workspace();
  /// Values for records; whole cache lines keep the rest aligned.
  std::size_t records_size() const { return to_cache_lines(cells.bytes()) * record_size; }
};

template <class T>
void ThreadMemory<T>::require(std::size_t particles, const TileShape& shape) {
  const std::size_t n = particles + 2 * page_particles;
  if (n <= cells.bytes()) return;
  cells.require(n);
  leavers.require(cells.bytes(), 0);
  node.require(1, 0);
  sums.require(shape.sums_size, 0);
  std::fill_n(sums.data(), shape.sums_size, T(0));  // and planar() leaves zeros
  require_numbers(records_size() + moments_size + local_size + coefficients_size, 0);
  lay_out_workspace();
}

template <class T>
void ThreadMemory<T>::require_numbers(std::size_t n, std::size_t spare) {
  if (n <= numbers.bytes() / sizeof(T)) return;
  numbers.require(n, spare);
  // Spare lanes compute with what nobody wrote: any numbers will do, but numbers.
  std::fill_n(numbers.data(), n + spare, T(0));
  lay_out_workspace();
}

template <class T>
void ThreadMemory<T>::lay_out_workspace() {
  work.records = numbers.data();
  work.moments = work.records + records_size();
  work.local = work.moments + moments_size;
  work.coefficients = work.local + local_size;
  work.cells = cells.data();
  work.leavers = leavers.data();
}

template <class T>
std::size_t ThreadMemory<T>::bytes() const {
  return numbers.bytes() + sorting.bytes() + cells.bytes() + leavers.bytes() + node.bytes() +
         sums.bytes();
}

}  // namespace firn::optimized
