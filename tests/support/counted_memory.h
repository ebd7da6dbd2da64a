// SPDX-License-Identifier: BSD-3-Clause
// Counts what a test program takes from the heap. For the one source file of a program: it replaces `operator new`.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace otg::test {

/// Calls of `operator new` so far, of all threads, and what they took.
inline std::atomic<std::size_t> allocations{0}, allocatedBytes{0};

inline void countAllocation(std::size_t size) {
  ++allocations;
  allocatedBytes += size;
}

}  // namespace otg::test

[[gnu::noinline]] void* operator new(std::size_t size) {
  otg::test::countAllocation(size);
  if (void* const memory = std::malloc(size > 0 ? size : 1); memory != nullptr) return memory;
  throw std::bad_alloc();
}
// What std::stable_partition and std::stable_sort call: AddressSanitizer has one of its own, which would not fit.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  otg::test::countAllocation(size);
  return std::malloc(size > 0 ? size : 1);
}
// What polymorphic memory resources call.
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  otg::test::countAllocation(size);
  const auto step = static_cast<std::size_t>(alignment);
  if (void* const memory = std::aligned_alloc(step, (size / step + 1) * step); memory != nullptr) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

// AddressSanitizer has those of arrays of its own, which would not fit.
[[gnu::noinline]] void* operator new[](std::size_t size) {
  return operator new(size);
}
[[gnu::noinline]] void operator delete[](void* memory) noexcept {
  operator delete(memory);
}
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept {
  operator delete(memory);
}
