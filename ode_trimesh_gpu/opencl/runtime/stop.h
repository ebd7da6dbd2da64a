// SPDX-License-Identifier: BSD-3-Clause
// Stopping a thread that opens a device. A driver's compiler cannot be interrupted, so the thread looks between
// the programs that it builds. No fork may come between while drivers and compilers are loaded, or an exit handler is
// registered: the C library holds a lock then, which nobody frees in the child. So these steps are LibraryCalls.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

namespace otg::opencl {

/// What building throws on a thread that has to stop. No failure: nothing is logged.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stop was requested"; }
};

/// While it lives, the thread that made it looks at a flag before each program that it builds.
class StopScope {
 public:
  /// `loaded` is called once drivers are there, and again once their compiler is: what they have to do at the end of
  /// the process is registered then.
  StopScope(const std::atomic<bool>& flag, std::function<void()> loaded);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  friend void checkStop();
  friend bool isStoppable();
  friend void tellLoaded();
  const std::atomic<bool>& flag_;
  std::function<void()> loaded_;
};

/// Throws Stopped if the calling thread has to stop.
void checkStop();
/// Whether the calling thread is in a StopScope.
bool isStoppable();
/// Calls what the scope of the calling thread was given, if it is in one.
void tellLoaded();

}  // namespace otg::opencl
