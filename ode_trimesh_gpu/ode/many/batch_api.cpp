// SPDX-License-Identifier: BSD-3-Clause
// The C API of arrays of pairs, at once and in the background.
#include "ode_trimesh_gpu/batch.h"

#include <ode/collision.h>

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "base/fork_gate.h"
#include "dispatch/dispatcher.h"
#include "ode/base/status.h"
#include "ode/many/pair_batch.h"

namespace otg {
namespace {

/// dGPUTRIMESH_OK, or why these arguments will not do. Geoms are not looked at.
int checkPairs(const dGpuTriMeshPair* pairs, int count, int flags) {
  return count < 0 || (pairs == nullptr && count > 0) || capacityOf(flags) == 0 ? dGPUTRIMESH_ERROR_ARGUMENT
                                                                                : dGPUTRIMESH_OK;
}

PairBatchRequest requestOf(int flags) {
  return {capacityOf(flags), isUnimportant(flags)};
}

std::span<const dGpuTriMeshPair> asSpan(const dGpuTriMeshPair* pairs, int count) {
  return {pairs, static_cast<std::size_t>(count)};
}

}  // namespace
}  // namespace otg

/// A batch and the thread that computes it.
struct dxGpuTriMeshBatch {
  otg::PairBatch batch;
  bool remembered = false;

  dxGpuTriMeshBatch(std::span<const dGpuTriMeshPair> pairs, const otg::PairBatchRequest& request)
      : batch(pairs, request) {
    if (!batch.areMeshes()) return;
    try {
      // Counted from here on: a fork waits for a thread that has not begun, too.
      thread_ = std::thread([this, work = std::make_shared<otg::BackgroundWork>()]() mutable {
        compute();
        work.reset();
      });
    } catch (const std::system_error&) {  // no thread to be had: now, then
      compute();
    }
  }
  ~dxGpuTriMeshBatch() {
    if (!thread_.joinable()) return;
    if (generation_ == otg::forkGeneration()) {
      thread_.join();
    } else if (auto* const gone = new (std::nothrow) std::thread; gone != nullptr) {
      *gone = std::move(thread_);  // there is no such thread in this process that could be joined
    }
  }  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): see above
  dxGpuTriMeshBatch(const dxGpuTriMeshBatch&) = delete;
  dxGpuTriMeshBatch& operator=(const dxGpuTriMeshBatch&) = delete;

  bool isDone() {
    const otg::CallLock lock(mutex_);
    return done_;
  }
  /// Returns a status.
  int wait() {
    std::unique_lock lock(mutex_);
    finished_.wait(lock, [this] { return done_; });
    return status_;
  }

 private:
  void compute() noexcept {
    int status = dGPUTRIMESH_OK;
    try {
      batch.run();
    } catch (...) {
      status = dGPUTRIMESH_ERROR_MEMORY;
    }
    const std::lock_guard lock(mutex_);
    status_ = status;
    done_ = true;
    finished_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable finished_;
  bool done_ = false;
  int status_ = dGPUTRIMESH_OK;
  std::thread thread_;
  const unsigned generation_ = otg::forkGeneration();
};

int dGpuTriMeshCollidePairs(const dGpuTriMeshPair* pairs, int count, int flags, dContactGeom* contact, int skip,
                            int* contact_count) {
  return otg::guarded([&] {
    if (const int status = otg::checkPairs(pairs, count, flags)) return status;
    const bool hasPlace = contact != nullptr && contact_count != nullptr && skip >= int{sizeof(dContactGeom)};
    if (count > 0 && !hasPlace) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    otg::PairBatch batch(otg::asSpan(pairs, count), otg::requestOf(flags));
    if (!batch.areMeshes()) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    batch.run();
    otg::rememberInto(batch, {otg::capacityOf(flags), contact, skip, contact_count});
    return otg::toInt(batch.contactCount());
  });
}

dGpuTriMeshBatchID dGpuTriMeshBatchSubmit(const dGpuTriMeshPair* pairs, int count, int flags) {
  dGpuTriMeshBatchID batch = nullptr;
  otg::guarded([&] {
    if (const int status = otg::checkPairs(pairs, count, flags)) return status;
    auto made = std::make_unique<dxGpuTriMeshBatch>(otg::asSpan(pairs, count), otg::requestOf(flags));
    if (!made->batch.areMeshes()) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    batch = made.release();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return batch;
}

int dGpuTriMeshBatchIsDone(dGpuTriMeshBatchID batch) {
  if (batch == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  return batch->isDone() ? 1 : 0;
}

int dGpuTriMeshBatchWait(dGpuTriMeshBatchID batch) {
  if (batch == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  if (const int status = batch->wait()) return otg::noteStatus(status);
  return otg::toInt(batch->batch.contactCount());
}

int dGpuTriMeshBatchCollect(dGpuTriMeshBatchID batch, dContactGeom* contact, int skip, dGpuTriMeshContactData* data,
                            int data_skip, int* first) {
  return otg::guarded([&] {
    if (batch == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (const int status = batch->wait()) return status;
    otg::PairBatch& pairs = batch->batch;
    const bool hasPlace = contact != nullptr && skip >= int{sizeof(dContactGeom)} &&
                          (data == nullptr || data_skip >= int{sizeof(dGpuTriMeshContactData)});
    if (pairs.contactCount() > 0 && !hasPlace) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (!batch->remembered) pairs.remember();
    batch->remembered = true;
    char *place = reinterpret_cast<char*>(contact), *dataPlace = reinterpret_cast<char*>(data);
    pairs.forParts([&](std::size_t from, std::size_t to) {
      std::size_t at = pairs.contactsBefore(from);
      for (std::size_t i = from; i < to; ++i) {
        const std::size_t dataAt = data == nullptr ? 0 : at * static_cast<std::size_t>(data_skip);
        if (first != nullptr) first[i] = otg::toInt(at);
        otg::writeContacts(pairs.task(i), pairs.result(i).contacts,
                           {reinterpret_cast<dContactGeom*>(place + at * static_cast<std::size_t>(skip)), skip,
                            reinterpret_cast<dGpuTriMeshContactData*>(dataPlace + dataAt), data_skip});
        at += pairs.result(i).contacts.size();
      }
    });
    const std::size_t at = pairs.contactCount();
    if (first != nullptr) first[pairs.pairCount()] = otg::toInt(at);
    return otg::toInt(at);
  });
}

void dGpuTriMeshBatchDestroy(dGpuTriMeshBatchID batch) {
  const otg::LibraryCall call;
  delete batch;
}

int dGpuTriMeshSetTaskRunner(dGpuTriMeshTaskRunner* runner, void* data) {
  otg::dispatcher().setTaskRunner({runner, data});
  return dGPUTRIMESH_OK;
}

int dGpuTriMeshSetThreadCount(int count) {
  if (count < 0 || count > 1024) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  otg::dispatcher().setThreadCount(static_cast<unsigned>(count));
  return dGPUTRIMESH_OK;
}

int dGpuTriMeshGetThreadCount(void) {
  return static_cast<int>(otg::dispatcher().threadCount());
}
