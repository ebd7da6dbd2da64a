// SPDX-License-Identifier: BSD-3-Clause
// fork() and the library: a fork waits until no call is under way, so that no lock is held in the child.
#pragma once

#include <atomic>
#include <mutex>

namespace otg {

/// While it lives, fork() in another thread waits, for kLongestForkWait seconds at most. Where a fork is under way, the
/// constructor waits for that. Calls inside of calls cost nothing. A thread that forks inside of a call of its own (in
/// a callback) does not wait for itself.
class LibraryCall {
 public:
  LibraryCall() noexcept;
  ~LibraryCall();
  LibraryCall(const LibraryCall&) = delete;
  LibraryCall& operator=(const LibraryCall&) = delete;
};

/// A lock on what more than one geom may use, held within a call: no thread holds it in the child of a fork. For places
/// that calls of ODE and short functions of the C API come to without a LibraryCall of their own.
template <class Mutex>
class CallLock {
 public:
  explicit CallLock(Mutex& mutex) : lock_(mutex) {}

 private:
  const LibraryCall call_;
  const std::lock_guard<Mutex> lock_;
};

/// Work that goes on after the call that began it, on a thread of the library's: a fork waits for that, too. Made
/// within a LibraryCall, destroyed by any thread.
class BackgroundWork {
 public:
  BackgroundWork() noexcept;
  ~BackgroundWork();
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;
};

/// A user's callback that waits for the thread that forks would wait for ever.
inline constexpr int kLongestForkWait = 5;

/// How many forks lie between the process that loaded the library and this one. What has threads compares it: those of
/// another number are not there.
unsigned forkGeneration() noexcept;

/// Called around each fork, when calls have ended: the first in the parent before it, in the reverse order in which
/// they were added, the others after it. At most four, for as long as the process lives.
struct ForkHooks {
  void (*before)();
  void (*inParent)();
  void (*inChild)();
};
void addForkHooks(const ForkHooks& hooks) noexcept;

}  // namespace otg
