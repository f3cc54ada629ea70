#pragma once
/// The scratch memory of one thread, and how much work it takes at a time.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "optimized/passes/kernel_table.hpp"
#include "optimized/store/memory.hpp"

namespace firn::optimized {

/// How many of n blocks a thread takes at a time: up to 16 neighbours, since each block asks for
/// the next one's particles in advance and shares nodes with it, but six turns per thread at least,
/// so that a thread which is held up holds up nobody.
inline int blocks_per_turn(int n, int threads) { return std::clamp(n / (6 * threads), 1, 16); }

template <class T>
struct ThreadMemory {
  AlignedArray<T> numbers, sorting;
  AlignedArray<std::uint8_t> cells;
  AlignedArray<std::int32_t> leavers;
  AlignedArray<NodeFields<T>> node;
  AlignedArray<T> sums;
  std::vector<int> colliders;
  Workspace<T> work{};

  /// Room for blocks of up to `particles`.
  void require(int particles, const KernelTable<T>& kernels);
  /// Room for so many values in `numbers` alone; they lose what they hold.
  void require_numbers(std::size_t n, std::size_t spare);
  std::size_t bytes() const;

 private:
  void lay_out_workspace();
  /// Values for records; a multiple of 64 keeps the rest aligned.
  std::size_t records_size() const { return (cells.bytes() + 63) / 64 * 64 * record_size; }
};

template <class T>
void ThreadMemory<T>::require(int particles, const KernelTable<T>& kernels) {
  const std::size_t n = static_cast<std::size_t>(particles) + 2 * page_particles;
  if (n <= cells.bytes()) return;
  cells.require(n);
  leavers.require(cells.bytes(), 0);
  node.require(1, 0);
  sums.require(static_cast<std::size_t>(kernels.sums_size), 0);
  std::fill_n(sums.data(), kernels.sums_size, T(0));  // and planar() leaves zeros
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
