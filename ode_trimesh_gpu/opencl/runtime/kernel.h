// SPDX-License-Identifier: BSD-3-Clause
// A kernel and the arguments that it was given last.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "opencl/runtime/handle.h"

namespace otg::opencl {

/// Setting an argument costs as much as a short kernel takes to begin, all arguments of a query together: those that
/// are the same as last time are not set again. One thread at a time.
class Kernel {
 public:
  Kernel() = default;
  /// `buffersMade`: Context::buffersMade, which outlives this.
  Kernel(KernelHandle handle, const std::atomic<std::uint64_t>* buffersMade)
      : handle_(std::move(handle)), buffersMade_(buffersMade) {}
  cl_kernel get() const { return handle_.get(); }
  explicit operator bool() const { return static_cast<bool>(handle_); }

  /// Argument number `index`; null `value` for local memory of `size` bytes.
  void set(cl_uint index, std::size_t size, const void* value) {
    if (last_.size() <= index) last_.resize(index + 1);
    Argument& last = last_[index];
    const bool same = last.size == size && (value == nullptr ? last.bytes.empty()
                                                             : last.bytes.size() == size &&
                                                                   std::memcmp(last.bytes.data(), value, size) == 0);
    if (same) return;
    last.size = 0;
    clDo(OTG_CL(clSetKernelArg), handle_.get(), index, size, value);
    last.size = size;
    const auto* bytes = static_cast<const std::byte*>(value);
    last.bytes.assign(bytes, value == nullptr ? bytes : bytes + size);
  }

  /// Before the first argument: forgets them all if a buffer was made since, which may have the handle of one that is
  /// gone.
  void begin() {
    const std::uint64_t made = *buffersMade_;
    if (made != seen_) last_.clear();
    seen_ = made;
  }

 private:
  struct Argument {
    std::size_t size = 0;
    std::vector<std::byte> bytes;
  };
  KernelHandle handle_;
  const std::atomic<std::uint64_t>* buffersMade_ = nullptr;
  std::uint64_t seen_ = 0;
  std::vector<Argument> last_;
};

}  // namespace otg::opencl
