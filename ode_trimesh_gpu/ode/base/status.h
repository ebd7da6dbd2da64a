// SPDX-License-Identifier: BSD-3-Clause
// From C++ inside to status codes outside: nothing may leave the C API as an exception.
#pragma once

#include "base/fork_gate.h"
#include "ode_trimesh_gpu/library.h"

namespace otg {

/// Remembers a negative status as the calling thread's last error and returns it; others pass through.
int noteStatus(int status) noexcept;
/// The calling thread's last error, which is none from now on.
int takeStatus() noexcept;

/// Runs a function that returns a status; exceptions become one. The only ones that the layers below throw are of want
/// of memory (std::bad_alloc, or std::length_error for sizes that no memory can hold).
template <class Function>
int guarded(Function&& function) noexcept {
  const LibraryCall call;
  try {
    return noteStatus(function());
  } catch (...) {
    return noteStatus(dGPUTRIMESH_ERROR_MEMORY);
  }
}

/// Structures of the API carry the size that the program was compiled with. There is one version of each so far.
template <class Struct>
bool isCurrentSize(const Struct* s) {
  return s != nullptr && s->size == sizeof(Struct);
}

}  // namespace otg
