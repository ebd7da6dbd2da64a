// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/threads/background_thread.h"

#include <utility>

#include "base/system.h"

namespace otg {

bool BackgroundThread::isForeign() const {
  const long process = process_;
  return process != 0 && process != processId();
}

void BackgroundThread::run(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  if (isForeign()) {
    static_cast<void>(thread_.release());  // there is no such thread here that could be joined
    isBusy_ = false;
  }
  process_ = processId();
  next_ = std::move(work);
  if (isBusy_) return;
  if (thread_) thread_->join();  // it has ended, all but
  thread_.reset();
  isBusy_ = true;
  try {
    thread_ = std::make_unique<std::thread>([this] { loop(); });
  } catch (...) {
    isBusy_ = false;
    next_ = {};
    throw;
  }
}

void BackgroundThread::loop() {
  for (;;) {
    std::function<void()> work;
    {
      const std::lock_guard lock(mutex_);
      work.swap(next_);
      if (!work) {
        isBusy_ = false;
        idle_.notify_all();
        return;
      }
    }
    work();
  }
}

bool BackgroundThread::wait(std::chrono::milliseconds most) {
  if (isForeign()) return true;
  std::unique_lock lock(mutex_);
  return idle_.wait_for(lock, most, [this] { return !isBusy_; });
}

void BackgroundThread::join() noexcept {
  if (isForeign()) {
    static_cast<void>(thread_.release());
    return;
  }
  std::unique_ptr<std::thread> thread;
  {
    const std::lock_guard lock(mutex_);
    next_ = {};
    thread.swap(thread_);
  }
  if (!thread) return;
  if (thread->get_id() == std::this_thread::get_id()) {  // it ends the process itself
    static_cast<void>(thread.release());
    return;
  }
  thread->join();
}

}  // namespace otg
