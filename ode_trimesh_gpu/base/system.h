// SPDX-License-Identifier: BSD-3-Clause
// What the operating system gives and standard C++ does not: shared libraries, the process, aligned memory.
#pragma once

#include <cstddef>
#include <initializer_list>

namespace otg {

/// The first of `names` that the system's loader finds, or null. It stays loaded.
void* openSharedLibrary(std::initializer_list<const char*> names) noexcept;

/// The address of a function of that library, or null.
void* findFunction(void* library, const char* name) noexcept;

long processId() noexcept;

/// Whether the calling thread is the one that main() runs in. Windows does not know it: always false there.
bool isMainThread() noexcept;

/// Uninitialised, or null; freeAligned() frees it. `alignment` is a power of two that divides `size`.
void* allocateAligned(std::size_t alignment, std::size_t size) noexcept;
void freeAligned(void* memory) noexcept;

}  // namespace otg
