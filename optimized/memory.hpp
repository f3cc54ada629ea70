#pragma once
/// Aligned memory that grows and never shrinks, and pages of particles.

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

#include "optimized/layout.hpp"

namespace firn::optimized {

struct AlignedDelete {
  void operator()(void* p) const { ::operator delete(p, std::align_val_t(64)); }
};

/// An array on a cache-line boundary. require() keeps nothing of the old contents.
template <class T>
class AlignedArray {
 public:
  /// At least n elements. Grows by half more than asked, so that a slowly growing
  /// need allocates rarely.
  void require(std::size_t n) {
    if (n <= size_) return;
    size_ = n + n / 2;
    data_.reset();
    data_.reset(static_cast<T*>(::operator new(size_ * sizeof(T), std::align_val_t(64))));
  }
  T* data() const { return data_.get(); }
  T& operator[](std::size_t i) const { return data_.get()[i]; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  std::unique_ptr<T, AlignedDelete> data_;
  std::size_t size_ = 0;
};

/// Pages of page_particles particles with `slots` values each.
template <class T>
class PagePool {
 public:
  void reset(int slots) {
    slabs_.clear();
    free_.clear();
    page_size_ = static_cast<std::size_t>(page_particles * slots);
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

  std::size_t bytes() const { return slabs_.size() * pages_per_slab * page_size_ * sizeof(T); }

 private:
  static constexpr std::size_t pages_per_slab = 64;

  void add_slab() {
    slabs_.emplace_back();
    slabs_.back().reset(static_cast<T*>(
        ::operator new(pages_per_slab* page_size_ * sizeof(T), std::align_val_t(64))));
    free_.reserve(slabs_.size() * pages_per_slab);
    for (std::size_t i = pages_per_slab; i-- > 0;)
      free_.push_back(slabs_.back().get() + i * page_size_);
  }

  std::vector<std::unique_ptr<T, AlignedDelete>> slabs_;
  std::vector<T*> free_;
  std::size_t page_size_ = 0;
};

}  // namespace firn::optimized
