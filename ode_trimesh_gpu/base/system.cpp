// SPDX-License-Identifier: BSD-3-Clause
#include "base/system.h"

#include <cstdlib>

#ifdef _WIN32
#include <malloc.h>
#include <windows.h>
#else
#include <dlfcn.h>
#include <unistd.h>
#endif

namespace otg {

#ifdef _WIN32

void* openSharedLibrary(std::initializer_list<const char*> names) noexcept {
  for (const char* const name : names) {
    if (const HMODULE library = LoadLibraryA(name); library != nullptr) return library;
  }
  return nullptr;
}

void* findFunction(void* library, const char* name) noexcept {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}

long processId() noexcept {
  return static_cast<long>(GetCurrentProcessId());
}

bool isMainThread() noexcept {
  return false;
}

void* allocateAligned(std::size_t alignment, std::size_t size) noexcept {
  return _aligned_malloc(size, alignment);
}

void freeAligned(void* memory) noexcept {
  _aligned_free(memory);
}

#else

void* openSharedLibrary(std::initializer_list<const char*> names) noexcept {
  for (const char* const name : names) {
    if (void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL); library != nullptr) return library;
  }
  return nullptr;
}

void* findFunction(void* library, const char* name) noexcept {
  return dlsym(library, name);
}

long processId() noexcept {
  return getpid();
}

bool isMainThread() noexcept {
  return getpid() == gettid();
}

void* allocateAligned(std::size_t alignment, std::size_t size) noexcept {
  return std::aligned_alloc(alignment, size);
}

void freeAligned(void* memory) noexcept {
  std::free(memory);
}

#endif

}  // namespace otg
