// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/pinned_buffer.h"

#include <algorithm>
#include <bit>

namespace otg::opencl {

PinnedBuffer::~PinnedBuffer() {
  unmap();
}

void PinnedBuffer::unmap() noexcept {
  if (data_ == nullptr) return;
  clRelease(OTG_CL(clEnqueueUnmapMemObject), queue_, buffer_.get(), static_cast<void*>(data_), cl_uint{0},
            static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
  clRelease(OTG_CL(clFinish), queue_);
  data_ = nullptr;
}

void PinnedBuffer::reserve(Context& context, cl_command_queue queue, std::size_t bytes, bool forKernels) {
  if (bytes <= size_) return;
  unmap();
  size_ = 0;
  queue_ = queue;
  buffer_ = BufferHandle();
  const std::size_t wanted = std::bit_ceil(std::max<std::size_t>(bytes, 4096));
  buffer_ = forKernels && context.hostBuffers() ? context.makeHostBuffer(wanted)
                                                : context.makeBuffer(CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, wanted);
  data_ = static_cast<std::byte*>(clMake(OTG_CL(clEnqueueMapBuffer), queue, buffer_.get(), cl_bool{CL_TRUE},
                                         cl_map_flags{CL_MAP_READ | CL_MAP_WRITE}, std::size_t{0}, wanted, cl_uint{0},
                                         static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr)));
  size_ = wanted;
}

std::shared_ptr<PinnedPool> PinnedPool::make(Context& context) {
  return std::shared_ptr<PinnedPool>(new PinnedPool(context.makeQueue(false)));
}

std::shared_ptr<PinnedBuffer> PinnedPool::take() {
  std::unique_ptr<PinnedBuffer> buffer;
  {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) {
      buffer = std::make_unique<PinnedBuffer>();
      idle_.reserve(idle_.capacity() + 1);  // giving back needs no memory
    } else {
      buffer = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  return {buffer.release(), [pool = shared_from_this()](PinnedBuffer* back) {
            std::unique_ptr<PinnedBuffer> owned(back);
            const std::lock_guard lock(pool->mutex_);
            pool->idle_.push_back(std::move(owned));
          }};
}

}  // namespace otg::opencl
