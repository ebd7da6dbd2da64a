// SPDX-License-Identifier: BSD-3-Clause
// Threads that share the items of a call with its caller.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace otg {

/// A scheduler of the program's own. `run` calls task(context, i) for each i below `count`, on any threads, and returns
/// when all calls have returned.
struct TaskRunner {
  void (*run)(void* data, int count, void (*task)(void* context, int index), void* context) = nullptr;
  void* data = nullptr;
};

/// Any number of threads may call run() at once, from within work too: a caller works on its own items, so that no call
/// ever waits for a thread that has none to give. Who has to wait spins for a while before it sleeps. Calls often
/// follow each other at once, and waking a thread takes longer than a small call; not where there are more threads than
/// cores.
class ThreadPool {
 public:
  /// `threads`: how many work on one call at most, the caller among them; 0 is taken for 1. Fewer where the system
  /// gives no more.
  explicit ThreadPool(unsigned threads) : ThreadPool(threads, TaskRunner{}) {}
  /// With a runner the pool has no threads of its own, and takes `threads` for the number of tasks.
  ThreadPool(unsigned threads, TaskRunner runner);
  /// No call may be under way.
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned threadCount() const { return runner_.run ? tasks_ : static_cast<unsigned>(threads_.size()) + 1; }

  using Work = std::function<void(std::size_t begin, std::size_t end)>;
  /// Calls work for consecutive parts of [0, count), `grain` items each but the last one, and returns when all are
  /// done. Which thread does which part, and when, is open. The first exception out of `work` is thrown again here;
  /// parts that were not begun by then are left out. `urgent`: threads that help with other calls leave these after the
  /// part that they are at.
  void run(std::size_t count, std::size_t grain, const Work& work, bool urgent = false);
  /// run() for parts of some microseconds. The caller begins alone. Others help once what is left is expected to take
  /// longer than waking them.
  void runShort(std::size_t count, std::size_t grain, const Work& work);

 private:
  struct Job;
  void help();
  void runTasks(Job& job, std::size_t parts);

  void setJobs(std::size_t count) { queued_.store(count, std::memory_order_release); }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job*> jobs_;               ///< with parts that have not begun; urgent ones first
  std::atomic<std::size_t> queued_{0};  ///< as many as jobs_ has, for who looks without the mutex
  std::size_t asleep_ = 0;              ///< threads that wait for wake_
  std::atomic<int> urgent_{0};          ///< calls that have such parts
  bool stop_ = false;
  const bool looks_;  ///< before it sleeps
  const TaskRunner runner_;
  const unsigned tasks_;  ///< at most, of one call with a runner
  std::vector<std::thread> threads_;
};

/// The threads that the environment variable OTG_THREADS requests, else one for each core that this process may use.
/// `besideDevices`: of kManyCores and more, one is left to the thread that gives a device its work. Its driver waits
/// without sleeping, and all threads of a call wait for one that has to share its core with it.
unsigned defaultThreadCount(bool besideDevices = false);
constexpr unsigned kManyCores = 8;
/// What that is for so many cores, where nothing else is requested.
unsigned threadsOfCores(unsigned cores, bool besideDevices);

}  // namespace otg
