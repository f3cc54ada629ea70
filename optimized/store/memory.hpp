// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// Aligned memory that grows and never shrinks, and pages of particles.

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "optimized/store/layout.hpp"

namespace firn::optimized {

/// Memory lies on a cache-line boundary; from huge_page bytes on, on a boundary of those and
/// with a request for them. A block's particles, its tile and the tiles around it lie on
/// dozens of pages of 4 KiB: more than the processor's address caches hold.
inline constexpr std::size_t huge_page = std::size_t{1} << 21;

constexpr std::size_t to_cache_lines(std::size_t n) {
  return (n + cache_line - 1) / cache_line * cache_line;
}

struct AlignedDelete {
  std::align_val_t alignment{cache_line};
  void operator()(void* p) const { ::operator delete(p, alignment); }
};

template <class T>
using AlignedPointer = std::unique_ptr<T, AlignedDelete>;

template <class T>
AlignedPointer<T> allocate_aligned(std::size_t n) {
  const std::size_t bytes = n * sizeof(T);
  const AlignedDelete free{std::align_val_t(bytes < huge_page ? cache_line : huge_page)};
  AlignedPointer<T> memory(static_cast<T*>(::operator new(bytes, free.alignment)), free);
#if defined(__linux__)
  if (bytes >= huge_page) madvise(memory.get(), bytes, MADV_HUGEPAGE);  // a wish: may fail
#endif
  return memory;
}

/// An array on a cache-line boundary. require() keeps nothing of the old contents.
template <class T>
class AlignedArray {
 public:
  /// At least n elements. Grows by half more than asked, so that a slowly growing
  /// need allocates rarely.
  void require(std::size_t n) { require(n, n / 2); }

  /// The same with room for `spare` more where it has to grow.
  void require(std::size_t n, std::size_t spare) {
    if (n <= size_) return;
    size_ = n + spare;
    data_.reset();
    data_ = allocate_aligned<T>(size_);
  }
  /// All of its memory, for another use in between: the elements lose their values.
  std::span<std::byte> lend() const {
    return std::as_writable_bytes(std::span<T>(data_.get(), size_));
  }
  T* data() const { return data_.get(); }
  T& operator[](std::size_t i) const { return data_.get()[i]; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  AlignedPointer<T> data_;
  std::size_t size_ = 0;
};

/// Typed arrays, one after the other, in memory that somebody lends.
class Arena {
 public:
  explicit Arena(std::span<std::byte> memory) : memory_(memory) {}

  /// n numbers, not set to anything.
  template <class T>
  T* take(std::size_t n) {
    assert(n * sizeof(T) <= memory_.size());
    T* const numbers = reinterpret_cast<T*>(memory_.data());
    memory_ = memory_.subspan(n * sizeof(T));
    std::uninitialized_default_construct_n(numbers, n);  // begins their life, writes nothing
    return numbers;
  }

  /// What is left.
  std::span<std::byte> rest() const { return memory_; }

 private:
  std::span<std::byte> memory_;
};

/// Pages of page_particles particles with `slots` values each.
template <class T>
class PagePool {
 public:
  void reset(std::size_t slots) {
    slabs_.clear();
    free_.clear();
    pages_ = 0;
    page_size_ = page_particles * slots;
  }

  /// A page of zeros: undeformed particles at rest, so that lanes without a
  /// particle compute harmless numbers.
  T* take() {
    if (free_.empty()) add_slab();
    T* page = free_.back();
    free_.pop_back();
    for (std::size_t i = 0; i < page_size_; ++i) page[i] = 0;
    return page;
  }
  void give_back(T* page) { free_.push_back(page); }

  std::size_t bytes() const { return pages_ * page_size_ * sizeof(T); }

 private:
  /// Slabs grow from 64 pages, so that a snowball of a thousand particles stays small, to
  /// one huge page: at most a quarter of what is in use is taken in advance.
  void add_slab() {
    const std::size_t page_bytes = page_size_ * sizeof(T);
    const std::size_t most = (huge_page + page_bytes - 1) / page_bytes;
    const std::size_t n = std::clamp(pages_ / 4, std::size_t{64}, most);
    slabs_.push_back(allocate_aligned<T>(n * page_size_));
    pages_ += n;
    free_.reserve(pages_);
    for (std::size_t i = n; i-- > 0;) free_.push_back(slabs_.back().get() + i * page_size_);
  }

  std::vector<AlignedPointer<T>> slabs_;
  std::vector<T*> free_;
  std::size_t page_size_ = 0, pages_ = 0;
};

}  // namespace firn::optimized
