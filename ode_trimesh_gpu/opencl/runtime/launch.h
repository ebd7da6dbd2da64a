// SPDX-License-Identifier: BSD-3-Clause
// Small helpers of everything that enqueues kernels.
#pragma once

#include <cstdint>
#include <deque>
#include <utility>

#include "opencl/runtime/context.h"

namespace otg::opencl {

/// Sets the arguments of a kernel one after the other. Of the kernels of the model `solid`, which have no structure
/// (given.h) yet.
class Arguments {
 public:
  explicit Arguments(Kernel& kernel) : kernel_(kernel) { kernel.begin(); }
  template <class T>
  Arguments& operator<<(const T& value) {
    return bytes(sizeof value, &value);
  }
  Arguments& local(std::size_t size) { return bytes(size, nullptr); }

 private:
  Arguments& bytes(std::size_t size, const void* value) {
    kernel_.set(index_++, size, value);
    return *this;
  }
  Kernel& kernel_;
  cl_uint index_ = 0;
};

/// Times of what was enqueued, by stage, from the device's own clock. Off unless requested: events cost time.
class Profile {
 public:
  enum Stage {
    // clang-format off
    kWrite, kTop, kLevels, kMain, kContacts, kRegions, kSelect, kChoose, kReadBack,
    kWeigh, kWays, kCandidates,  // of large regions
    kTest, kScan, kCompact, kSplit, kSpawn, kNear,  // of the traversal `levels`
    kStages
    // clang-format on
  };
  explicit Profile(bool on) : on_(on) {}
  /// Where an enqueueing function puts its event; null when off.
  cl_event* next(Stage stage) {
    if (!on_) return nullptr;
    pending_.emplace_back(stage, nullptr);
    return &pending_.back().second;
  }
  /// After the queue was waited for: adds the times up, in milliseconds.
  void collect() {
    for (double& ms : ms_) ms = 0;
    for (auto& [stage, event] : pending_) {
      const EventHandle handle(std::exchange(event, nullptr));
      if (!handle) continue;
      cl_ulong start = 0, end = 0;
      const auto ask = [&](cl_profiling_info what, cl_ulong& value) {
        clDo(OTG_CL(clGetEventProfilingInfo), handle.get(), what, sizeof value, static_cast<void*>(&value),
             static_cast<std::size_t*>(nullptr));
      };
      ask(CL_PROFILING_COMMAND_START, start);
      ask(CL_PROFILING_COMMAND_END, end);
      ms_[stage] += 1e-6 * static_cast<double>(end - start);
    }
    pending_.clear();
  }
  double ms(Stage stage) const { return ms_[stage]; }
  bool on() const { return on_; }
  ~Profile() {
    for (auto& [stage, event] : pending_) const EventHandle handle(std::exchange(event, nullptr));
  }
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

 private:
  bool on_;
  std::deque<std::pair<Stage, cl_event>> pending_;  // a deque: places stay where they are
  double ms_[kStages] = {};
};

inline void launch(cl_command_queue queue, const Kernel& kernel, std::size_t groupSize, std::size_t groupsX,
                   std::size_t groupsY = 1, cl_event* event = nullptr) {
  const std::size_t local[2] = {groupSize, 1}, global[2] = {groupsX * groupSize, groupsY};
  clDo(OTG_CL(clEnqueueNDRangeKernel), queue, kernel.get(), cl_uint{2}, static_cast<const std::size_t*>(nullptr),
       static_cast<const std::size_t*>(global), static_cast<const std::size_t*>(local), cl_uint{0},
       static_cast<const cl_event*>(nullptr), event);
}

/// `bytes` from the start of `from`; waits for all that was enqueued before.
inline void readBlocking(cl_command_queue queue, cl_mem from, std::size_t bytes, void* to, cl_event* event = nullptr) {
  clDo(OTG_CL(clEnqueueReadBuffer), queue, from, cl_bool{CL_TRUE}, std::size_t{0}, bytes, to, cl_uint{0},
       static_cast<const cl_event*>(nullptr), event);
}

/// Does not wait: `from` has to stay as it is until something later in the queue was waited for.
inline void writeLater(cl_command_queue queue, cl_mem to, std::size_t bytes, const void* from,
                       cl_event* event = nullptr, std::size_t offset = 0) {
  clDo(OTG_CL(clEnqueueWriteBuffer), queue, to, cl_bool{CL_FALSE}, offset, bytes, from, cl_uint{0},
       static_cast<const cl_event*>(nullptr), event);
}

inline void fillZero(cl_command_queue queue, cl_mem buffer, std::size_t bytes) {
  const cl_uint zero = 0;
  clDo(OTG_CL(clEnqueueFillBuffer), queue, buffer, static_cast<const void*>(&zero), sizeof zero, std::size_t{0}, bytes,
       cl_uint{0}, static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
}

/// A buffer for a number of items that only grows. What it held is lost when it does.
class DeviceList {
 public:
  explicit DeviceList(std::size_t itemSize) : itemSize_(itemSize) {}
  /// Throws ClError, with CL_MEM_OBJECT_ALLOCATION_FAILURE also for more than one buffer of this device can hold.
  void reserve(Context& context, std::uint64_t items, std::size_t headBytes = 0) {
    if (items <= places_) return;
    if (items > 0x7fffffffu || items * itemSize_ + headBytes > context.info().largestAllocation) {
      throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "a list outgrows the device");
    }
    places_ = 0;
    buffer_ = BufferHandle();
    buffer_ = context.makeBuffer(CL_MEM_READ_WRITE, headBytes + items * itemSize_);
    places_ = static_cast<std::uint32_t>(items);
  }
  cl_mem get() const { return buffer_.get(); }
  std::uint32_t places() const { return places_; }

 private:
  std::size_t itemSize_;
  BufferHandle buffer_;
  std::uint32_t places_ = 0;
};

}  // namespace otg::opencl
