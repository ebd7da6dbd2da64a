// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/stop.h"

#include <utility>

#include "base/fork_gate.h"

namespace otg::opencl {
namespace {

thread_local const StopScope* scopeOfThread = nullptr;

}  // namespace

StopScope::StopScope(const std::atomic<bool>& flag, std::function<void()> loaded)
    : flag_(flag), loaded_(std::move(loaded)) {
  scopeOfThread = this;
}

StopScope::~StopScope() {
  scopeOfThread = nullptr;
}

void checkStop() {
  if (scopeOfThread != nullptr && scopeOfThread->flag_.load(std::memory_order_relaxed)) throw Stopped();
}

bool isStoppable() {
  return scopeOfThread != nullptr;
}

void tellLoaded() {
  const LibraryCall noFork;
  if (scopeOfThread != nullptr && scopeOfThread->loaded_) scopeOfThread->loaded_();
}

}  // namespace otg::opencl
