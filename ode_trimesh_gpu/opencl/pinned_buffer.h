// SPDX-License-Identifier: BSD-3-Clause
// Host memory that the device's copy engine reaches directly.
#pragma once

#include <cstddef>

#include "opencl/context.h"

namespace otg::opencl {

/// A buffer that the driver allocates, mapped for its whole life; reads and writes of other buffers go through it.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  PinnedBuffer(const PinnedBuffer&) = delete;
  PinnedBuffer& operator=(const PinnedBuffer&) = delete;
  ~PinnedBuffer();

  /// Room for `bytes`; what was there is lost if it has to grow. `queue` has to live as long as this.
  void reserve(Context& context, cl_command_queue queue, std::size_t bytes);
  std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  void unmap() noexcept;
  cl_command_queue queue_ = nullptr;
  BufferHandle buffer_;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace otg::opencl
