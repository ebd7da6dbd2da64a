// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/threads/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <system_error>

#include "base/environment.h"

namespace otg {
namespace {

/// Informs the processor, not the system, that the thread waits: what it shares with another one is free meanwhile.
void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#else
  std::this_thread::yield();
#endif
}

/// Looks for something that other threads are about to do, for no longer than it takes to wake a thread.
template <class Ready>
void lookFor(const Ready& ready) {
  constexpr std::chrono::microseconds kLonger{50};
  constexpr int kLooks = 16;  // between looks at the clock
  const auto end = std::chrono::steady_clock::now() + kLonger;
  do {
    for (int i = 0; i < kLooks; ++i) {
      if (ready()) return;
      relax();
    }
  } while (std::chrono::steady_clock::now() < end);
}

}  // namespace

struct ThreadPool::Job {
  const Work& work;
  const std::size_t count, grain;
  std::atomic<int>* const urgent;   ///< null: it is not
  std::atomic<bool> counted{true};  ///< among those, as long as there are parts that have not begun
  std::atomic<std::size_t> next{0};
  std::atomic<int> helpers{0};  ///< changed under the pool's mutex
  std::exception_ptr error;
  std::condition_variable left;

  Job(const Work& doing, std::size_t items, std::size_t part, std::atomic<int>* urgentCalls)
      : work(doing), count(items), grain(part), urgent(urgentCalls) {
    if (urgent) ++*urgent;
  }
  ~Job() { end(); }
  void end() {
    if (urgent && counted.exchange(false)) --*urgent;
  }
  bool hasMore() const { return next.load(std::memory_order_relaxed) < count; }
  /// Does parts until there are none left, or until there is an urgent call, if others are `urgentCalls` for the
  /// thread.
  void take(std::mutex& mutex, const std::atomic<int>* urgentCalls) {
    while (urgentCalls == nullptr || *urgentCalls == 0) {
      const std::size_t begin = next.fetch_add(grain, std::memory_order_relaxed);
      if (begin >= count) return;
      if (begin + grain >= count) end();
      try {
        work(begin, std::min(count, begin + grain));
      } catch (...) {
        next.store(count, std::memory_order_relaxed);
        end();
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
      }
    }
  }
};

ThreadPool::ThreadPool(unsigned threads, TaskRunner runner)
    : looks_(threads <= std::thread::hardware_concurrency()), runner_(runner), tasks_(std::max(threads, 1u)) {
  if (runner_.run != nullptr) return;
  try {
    for (unsigned i = 1; i < threads; ++i) threads_.emplace_back([this] { help(); });
  } catch (const std::system_error&) {  // as many as the system gives
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::help() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (looks_ && jobs_.empty() && !stop_) {
      lock.unlock();
      lookFor([this] { return queued_.load(std::memory_order_acquire) > 0; });
      lock.lock();
    }
    ++asleep_;
    wake_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
    --asleep_;
    if (jobs_.empty()) return;
    Job& job = *jobs_.front();
    if (!job.hasMore()) {
      jobs_.pop_front();
      setJobs(jobs_.size());
      continue;
    }
    ++job.helpers;
    lock.unlock();
    job.take(mutex_, job.urgent ? nullptr : &urgent_);
    lock.lock();
    if (--job.helpers == 0) job.left.notify_all();
  }
}

void ThreadPool::runTasks(Job& job, std::size_t parts) {
  struct Context {
    Job& job;
    std::mutex& mutex;
  } context{job, mutex_};
  const auto task = [](void* its, int) {
    const Context& here = *static_cast<const Context*>(its);
    here.job.take(here.mutex, nullptr);
  };
  runner_.run(runner_.data, static_cast<int>(std::min<std::size_t>(tasks_, parts)), task, &context);
}

void ThreadPool::run(std::size_t count, std::size_t grain, const Work& work, bool urgent) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const bool shared = !threads_.empty() && count > grain;
  Job job(work, count, grain, urgent && shared ? &urgent_ : nullptr);
  if (shared) {
    std::size_t asleep = 0;
    {
      const std::lock_guard lock(mutex_);
      urgent ? jobs_.push_front(&job) : jobs_.push_back(&job);
      setJobs(jobs_.size());
      asleep = asleep_;
    }
    // The caller does a part itself. Those that are awake come by themselves.
    const std::size_t others = (count - 1) / grain;
    if (asleep <= others) {
      if (asleep > 0) wake_.notify_all();
    } else {
      for (std::size_t i = 0; i < others; ++i) wake_.notify_one();
    }
  }
  if (runner_.run != nullptr && tasks_ > 1 && count > grain) runTasks(job, (count - 1) / grain + 1);
  job.take(mutex_, nullptr);
  if (shared) {
    std::unique_lock lock(mutex_);
    jobs_.erase(std::remove(jobs_.begin(), jobs_.end(), &job), jobs_.end());
    setJobs(jobs_.size());
    if (looks_ && job.helpers != 0) {
      lock.unlock();
      lookFor([&] { return job.helpers == 0; });
      lock.lock();  // those who were helpers are done with the job, too
    }
    job.left.wait(lock, [&] { return job.helpers == 0; });
  }
  if (job.error) std::rethrow_exception(job.error);
}

void ThreadPool::runShort(std::size_t count, std::size_t grain, const Work& work) {
  // Waking a thread takes some 50 us of both sides; the pace of the first 20 us shows what is left.
  constexpr std::chrono::duration<double, std::micro> kPaced{20}, kWorthWaking{300};
  grain = std::max<std::size_t>(grain, 1);
  const auto begin = std::chrono::steady_clock::now();
  std::size_t done = 0;
  // Some systems take a microsecond to read the clock: it is read after 1, 2, 4, 8, ... parts.
  for (std::size_t look = grain; done < count && threadCount() > 1; look *= 2) {
    for (; done < count && done < look; done = std::min(count, done + grain)) work(done, std::min(count, done + grain));
    const std::chrono::duration<double, std::micro> elapsed = std::chrono::steady_clock::now() - begin;
    if (elapsed >= kPaced && elapsed * static_cast<double>(count - done) >= kWorthWaking * static_cast<double>(done))
      break;
  }
  run(count - done, grain, [&](std::size_t from, std::size_t to) { work(done + from, done + to); });
}

unsigned defaultThreadCount(bool besideDevices) {
  return readEnvironment().threads.value_or(threadsOfCores(std::thread::hardware_concurrency(), besideDevices));
}

unsigned threadsOfCores(unsigned cores, bool besideDevices) {
  return besideDevices && cores >= kManyCores ? cores - 1 : std::max(1u, cores);
}

}  // namespace otg
