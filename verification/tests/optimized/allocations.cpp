// SPDX-License-Identifier: BSD-3-Clause
// Its own file: where the compiler sees a `delete` from here beside a library's `new`, it warns.

#include "verification/tests/optimized/allocations.hpp"

#include <cstddef>
#include <cstdlib>
#include <new>

namespace firn::test {
std::atomic<long> allocations{0};
}

namespace {

void* counted_or_null(std::size_t n, std::size_t alignment) {
  ++firn::test::allocations;
  return std::aligned_alloc(alignment, (n + alignment - 1) / alignment * alignment);
}

void* counted(std::size_t n, std::size_t alignment) {
  void* p = counted_or_null(n, alignment);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

}  // namespace

void* operator new(std::size_t n) { return counted(n, alignof(std::max_align_t)); }
// std::stable_sort takes its buffer from this one and gives it to the plain delete.
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  return counted_or_null(n, alignof(std::max_align_t));
}
void* operator new(std::size_t n, std::align_val_t a) {
  return counted(n, static_cast<std::size_t>(a));
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
