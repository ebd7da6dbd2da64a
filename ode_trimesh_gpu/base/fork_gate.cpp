// SPDX-License-Identifier: BSD-3-Clause
// Each thread has a flag that says whether it is in a call. Who enters raises its own flag and then looks whether a
// fork is under way; who forks says so first and then looks at the flags. One of the two sees the other.
#include "base/fork_gate.h"

#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <new>
#include <thread>

#include "base/of_thread.h"

namespace otg {
namespace {

/// A thread that has called the library.
struct Visitor {
  std::atomic<bool> inside{false};
  unsigned depth = 0;  ///< calls within calls
  Visitor* next = nullptr;
  Visitor* previous = nullptr;
  Visitor();
  ~Visitor();
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;
};

struct Gate {
  std::mutex visitors;  ///< held from before a fork until after it
  Visitor* first = nullptr;
  std::mutex mutex;
  std::condition_variable opened;
};

constexpr std::size_t kMostHooks = 4;

std::atomic<bool> isForking{false};
std::atomic<int> backgroundWork{0};
std::atomic<unsigned> generation{0};
ForkHooks allHooks[kMostHooks];
std::atomic<std::size_t> hookCount{0};

// Windows has no fork, and pthread_atfork() is an empty macro there.
[[maybe_unused]] void beforeFork();
[[maybe_unused]] void inParent();
[[maybe_unused]] void inChild();

/// In the child it is made anew: others may have waited for it.
alignas(Gate) unsigned char gateMemory[sizeof(Gate)];
Gate* gateNow() {
  static const bool registered = [] {
    new (gateMemory) Gate;
    pthread_atfork(&beforeFork, &inParent, &inChild);
    return true;
  }();
  static_cast<void>(registered);
  return std::launder(reinterpret_cast<Gate*>(gateMemory));
}

Visitor::Visitor() {
  Gate* const gate = gateNow();
  const std::lock_guard lock(gate->visitors);
  next = gate->first;
  if (next != nullptr) next->previous = this;
  gate->first = this;
}

Visitor::~Visitor() {
  Gate* const gate = gateNow();
  const std::lock_guard lock(gate->visitors);
  if (next != nullptr) next->previous = previous;
  (previous != nullptr ? previous->next : gate->first) = next;
}

void beforeFork() {
  Gate* const gate = gateNow();
  const Visitor* const self = &ofThread<Visitor>();  // in the list before that is locked
  gate->visitors.lock();
  isForking.store(true, std::memory_order_seq_cst);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kLongestForkWait);
  const auto isQuiet = [&] {
    if (backgroundWork.load(std::memory_order_seq_cst) != 0) return false;
    for (const Visitor* other = gate->first; other != nullptr; other = other->next) {
      if (other != self && other->inside.load(std::memory_order_seq_cst)) return false;
    }
    return true;
  };
  while (!isQuiet() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
  for (std::size_t i = hookCount.load(); i-- > 0;) allHooks[i].before();
}

void inParent() {
  for (std::size_t i = 0; i < hookCount.load(); ++i) allHooks[i].inParent();
  Gate* const gate = gateNow();
  {
    const std::lock_guard lock(gate->mutex);
    isForking.store(false, std::memory_order_seq_cst);
  }
  gate->opened.notify_all();
  gate->visitors.unlock();
}

void inChild() {
  generation.fetch_add(1);
  backgroundWork.store(0);
  Gate* const gate = new (gateMemory) Gate;
  Visitor& self = ofThread<Visitor>();
  self.next = self.previous = nullptr;  // the others are no threads here
  gate->first = &self;
  isForking.store(false);
  for (std::size_t i = 0; i < hookCount.load(); ++i) allHooks[i].inChild();
}

}  // namespace

LibraryCall::LibraryCall() noexcept {
  Visitor& self = ofThread<Visitor>();
  if (self.depth++ > 0) return;
  for (;;) {
    self.inside.store(true, std::memory_order_seq_cst);
    if (!isForking.load(std::memory_order_seq_cst)) return;
    self.inside.store(false, std::memory_order_seq_cst);
    Gate* const gate = gateNow();
    std::unique_lock lock(gate->mutex);
    gate->opened.wait(lock, [] { return !isForking.load(std::memory_order_seq_cst); });
  }
}

LibraryCall::~LibraryCall() {
  Visitor& self = ofThread<Visitor>();
  if (--self.depth == 0) self.inside.store(false, std::memory_order_release);
}

BackgroundWork::BackgroundWork() noexcept {
  backgroundWork.fetch_add(1, std::memory_order_seq_cst);
}

BackgroundWork::~BackgroundWork() {
  backgroundWork.fetch_sub(1, std::memory_order_seq_cst);
}

unsigned forkGeneration() noexcept {
  return generation.load(std::memory_order_relaxed);
}

void addForkHooks(const ForkHooks& hooks) noexcept {
  static_cast<void>(gateNow());
  const std::size_t count = hookCount.load();
  if (count == kMostHooks) return;
  allHooks[count] = hooks;
  hookCount.store(count + 1);
}

}  // namespace otg
