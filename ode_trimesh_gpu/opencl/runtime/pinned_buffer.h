// SPDX-License-Identifier: BSD-3-Clause
// Host memory that the device's copy engine reaches directly.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "opencl/runtime/context.h"

namespace otg::opencl {

/// A buffer that the driver allocates, mapped for its whole life; reads and writes of other buffers go through it.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  PinnedBuffer(const PinnedBuffer&) = delete;
  PinnedBuffer& operator=(const PinnedBuffer&) = delete;
  ~PinnedBuffer();

  /// Room for `bytes`; what was there is lost if it has to grow. `queue` has to live as long as this.
  /// `forKernels`: in host memory also for kernels, where the device can (Context::hostBuffers).
  void reserve(Context& context, cl_command_queue queue, std::size_t bytes, bool forKernels = false);
  cl_mem get() const { return buffer_.get(); }
  std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  void unmap() noexcept;
  cl_command_queue queue_ = nullptr;
  BufferHandle buffer_;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Buffers that outlive the query that filled them: whoever shares one has its contents to himself until he lets go,
/// and then it is there for another query. Lives as long as any of them. Any thread.
class PinnedPool : public std::enable_shared_from_this<PinnedPool> {
 public:
  static std::shared_ptr<PinnedPool> make(Context& context);
  std::shared_ptr<PinnedBuffer> take();
  /// Where the buffers are mapped.
  cl_command_queue queue() const { return queue_.get(); }

 private:
  explicit PinnedPool(QueueHandle queue) : queue_(std::move(queue)) {}
  QueueHandle queue_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<PinnedBuffer>> idle_;
};

}  // namespace otg::opencl
