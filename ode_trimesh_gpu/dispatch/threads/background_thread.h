// SPDX-License-Identifier: BSD-3-Clause
// A thread that does one piece of work after another, and is waited for where the process ends.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace otg {

/// Any number of threads. In a child process made by fork() the work that was under way is gone, and none waits for
/// it.
class BackgroundThread {
 public:
  BackgroundThread() = default;
  ~BackgroundThread() { join(); }
  BackgroundThread(const BackgroundThread&) = delete;
  BackgroundThread& operator=(const BackgroundThread&) = delete;

  /// Does the work, which must not throw, after the one that is under way; in place of one that has not begun. Throws
  /// std::system_error where no thread is to be had.
  void run(std::function<void()> work);
  /// Waits until nothing is under way, for so long at most; whether that is so.
  bool wait(std::chrono::milliseconds most);
  /// Drops what has not begun, and waits for what has.
  void join() noexcept;

 private:
  void loop();
  bool isForeign() const;
  std::mutex mutex_;
  std::condition_variable idle_;
  std::unique_ptr<std::thread> thread_;
  std::function<void()> next_;
  bool isBusy_ = false;
  std::atomic<long> process_{0};  ///< whose thread it is
};

}  // namespace otg
