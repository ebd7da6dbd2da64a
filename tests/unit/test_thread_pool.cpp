// SPDX-License-Identifier: BSD-3-Clause
// The thread pool: every item once, from several callers and from within, and exceptions that come back.
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "dispatch/dispatcher.h"
#include "dispatch/threads/thread_pool.h"
#include "support/catch.h"
#include "support/environment_variable.h"

using otg::ThreadPool;

namespace {

/// How often each item was worked on by `run`; parts have the length that they should.
template <class Run>
std::vector<int> countsOf(const Run& run, std::size_t items, std::size_t grain) {
  std::vector<std::atomic<int>> seen(items);
  std::atomic<int> wrongParts{0};
  run(items, grain, [&](std::size_t begin, std::size_t end) {
    if (begin % grain != 0 || end != std::min(items, begin + grain)) ++wrongParts;
    for (std::size_t i = begin; i < end; ++i) ++seen[i];
  });
  CHECK(wrongParts == 0);
  return {seen.begin(), seen.end()};
}

std::vector<int> counts(ThreadPool& pool, std::size_t items, std::size_t grain) {
  return countsOf([&](auto&&... of) { pool.run(of...); }, items, grain);
}

/// Not sleep_for(): some systems sleep for whole milliseconds, or not at all.
void spend(int microseconds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(microseconds);
  while (microseconds > 0 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
}

/// The same by runShort() of a pool or a dispatcher, where each part takes so many microseconds: with 0 the caller does
/// all, with 30 others help.
template <class Runner>
std::vector<int> shortCounts(Runner& runner, std::size_t items, std::size_t grain, int microseconds) {
  const auto run = [&](std::size_t all, std::size_t each, const ThreadPool::Work& work) {
    runner.runShort(all, each, [&](std::size_t begin, std::size_t end) {
      work(begin, end);
      spend(microseconds);
    });
  };
  return countsOf(run, items, grain);
}

}  // namespace

TEST_CASE("every item is worked on once, for any number of threads and any grain") {
  for (const unsigned threads : {0u, 1u, 2u, 3u, 8u}) {
    ThreadPool pool(threads);
    CHECK(pool.threadCount() == std::max(threads, 1u));
    for (const std::size_t items : {0u, 1u, 2u, 7u, 1000u}) {
      for (const std::size_t grain : {1u, 3u, 100u, 5000u})
        CHECK(counts(pool, items, grain) == std::vector<int>(items, 1));
    }
  }
}

TEST_CASE("callers in several threads and calls from within work share the pool") {
  ThreadPool pool(3);
  std::vector<std::thread> callers;
  std::atomic<int> sum{0};
  for (int t = 0; t < 4; ++t) {
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round) {
        pool.run(20, 2, [&](std::size_t begin, std::size_t end) {
          pool.run(end - begin, 1, [&](std::size_t, std::size_t) { ++sum; });
        });
      }
    });
  }
  for (std::thread& t : callers) t.join();
  CHECK(sum == 4 * 50 * 20);
}

TEST_CASE("a runner of the program's own does every item once") {
  struct Seen {
    std::atomic<int> calls{0}, tasks{0};
    bool atOnce = false;
  };
  const auto runner = [](void* data, int count, void (*task)(void*, int), void* context) {
    Seen& seen = *static_cast<Seen*>(data);
    ++seen.calls;
    seen.tasks += count;
    if (!seen.atOnce) {
      for (int i = 0; i < count; ++i) task(context, i);
      return;
    }
    std::vector<std::thread> team;
    for (int i = 0; i < count; ++i) team.emplace_back([=] { task(context, i); });
    for (std::thread& thread : team) thread.join();
  };
  for (const bool atOnce : {false, true}) {
    Seen seen;
    seen.atOnce = atOnce;
    ThreadPool pool(3, {runner, &seen});
    CHECK(pool.threadCount() == 3);
    for (const std::size_t items : {0u, 1u, 2u, 7u, 1000u}) CHECK(counts(pool, items, 2) == std::vector<int>(items, 1));
    CHECK(seen.calls == 2);  // two items and fewer are one part
    CHECK(seen.tasks == 6);
    CHECK_THROWS_AS(pool.run(10, 1, [](std::size_t, std::size_t) { throw std::runtime_error("x"); }),
                    std::runtime_error);
  }
  Seen alone;
  ThreadPool one(1, {runner, &alone});
  CHECK(counts(one, 10, 1) == std::vector<int>(10, 1));
  CHECK(alone.calls == 0);
}

TEST_CASE("several threads work at the same time") {
  ThreadPool pool(3);
  std::atomic<int> here{0};
  // Each of three parts waits for the two others: one thread alone would wait for ever.
  pool.run(3, 1, [&](std::size_t, std::size_t) {
    ++here;
    while (here < 3) std::this_thread::yield();
  });
  CHECK(here == 3);
}

TEST_CASE("as many threads are woken as there are parts, however long they have slept") {
  for (const unsigned threads : {2u, 3u, 8u}) {
    ThreadPool pool(threads);
    for (const int milliseconds : {0, 0, 1, 5}) {
      for (unsigned parts = 2; parts <= threads; ++parts) {
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        std::atomic<unsigned> here{0};
        // Each part waits for all others.
        pool.run(parts, 1, [&](std::size_t, std::size_t) {
          ++here;
          while (here < parts) std::this_thread::yield();
        });
        CHECK(here == parts);
      }
    }
  }
}

TEST_CASE("threads that help leave a call for an urgent one") {
  struct Stop {};
  ThreadPool pool(3);
  std::atomic<int> begun{0};
  std::atomic<long> others{0};
  std::atomic<bool> done{false};
  // Goes on until the urgent call is done, which needs two threads at once; its caller is one of them.
  const auto other = [&](std::size_t, std::size_t) {
    if (done) throw Stop();
    ++others;
    std::this_thread::yield();
  };
  std::thread caller([&] {
    try {
      pool.run(std::size_t{1} << 40, 1, other);
    } catch (const Stop&) {
    }
  });
  while (others < 1000) std::this_thread::yield();
  std::atomic<int> together{0};
  pool.run(
      2, 1,
      [&](std::size_t, std::size_t) {
        ++begun;
        const long before = others;
        while (begun < 2 && others < before + 3000000) std::this_thread::yield();
        if (begun == 2) ++together;
      },
      true);
  done = true;
  caller.join();
  CHECK(together == 2);
  // And come back to it: all of both calls is done.
  std::atomic<std::size_t> sum{0};
  std::thread both([&] { pool.run(5000, 1, [&](std::size_t begin, std::size_t) { sum += begin; }); });
  for (int i = 0; i < 50; ++i)
    pool.run(
        20, 3, [&](std::size_t begin, std::size_t end) { sum += end - begin; }, true);
  both.join();
  CHECK(sum == 5000u * 4999u / 2 + 1000);
}

TEST_CASE("an exception comes back to the caller, and the pool goes on") {
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    const auto failing = [](std::size_t begin, std::size_t) {
      if (begin >= 10) throw std::runtime_error("no");
    };
    for (int round = 0; round < 20; ++round) CHECK_THROWS_AS(pool.run(1000, 1, failing), std::runtime_error);
    CHECK(counts(pool, 100, 1) == std::vector<int>(100, 1));
  }
}

TEST_CASE("short parts are each done once, by the caller or with others") {
  for (const unsigned threads : {0u, 1u, 2u, 3u, 8u}) {
    ThreadPool pool(threads);
    for (const std::size_t items : {0u, 1u, 2u, 7u, 300u}) {
      for (const std::size_t grain : {1u, 3u, 100u, 5000u}) {
        for (const int microseconds : {0, 30})
          CHECK(shortCounts(pool, items, grain, microseconds) == std::vector<int>(items, 1));
      }
    }
  }
  otg::Dispatcher dispatcher;
  dispatcher.setThreadCount(3);
  for (const std::size_t items : {0u, 1u, 7u, 300u}) {
    for (const int microseconds : {0, 30}) {
      for (const std::size_t grain : {1u, 7u, 64u})
        CHECK(shortCounts(dispatcher, items, grain, microseconds) == std::vector<int>(items, 1));
    }
  }
}

TEST_CASE("others help with short parts that take long together") {
  ThreadPool pool(3);
  // The caller is alone until it has seen how long parts take. Each of the last three waits for the two others.
  std::atomic<int> here{0};
  pool.runShort(103, 1, [&](std::size_t begin, std::size_t) {
    if (begin < 100) return spend(50);
    ++here;
    while (here < 3) std::this_thread::yield();
  });
  CHECK(here == 3);
}

TEST_CASE("calls of short parts from within work, short or not, share the pool") {
  ThreadPool pool(3);
  std::vector<std::thread> callers;
  std::atomic<int> sum{0};
  const auto inner = [&](std::size_t, std::size_t) { ++sum; };
  for (int t = 0; t < 4; ++t) {
    callers.emplace_back([&, t] {
      const auto outer = [&](std::size_t begin, std::size_t end) {
        spend(begin == 0 ? 25 : 0);
        begin % 4 == 0 ? pool.run(end - begin, 1, inner) : pool.runShort(end - begin, 1, inner);
      };
      for (int round = 0; round < 50; ++round) t % 2 == 0 ? pool.runShort(20, 2, outer) : pool.run(20, 2, outer);
    });
  }
  for (std::thread& t : callers) t.join();
  CHECK(sum == 4 * 50 * 20);
}

TEST_CASE("an exception out of a short part comes back to the caller, and the pool goes on") {
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    // In the first part, while the caller is alone, and in one that others may do.
    for (const std::size_t first : {std::size_t{0}, std::size_t{50}}) {
      std::atomic<bool> goesOn{false};
      const auto failing = [&](std::size_t begin, std::size_t) {
        spend(begin == 0 ? 30 : 0);
        goesOn = goesOn || begin == 900;
        if (begin >= first) throw std::runtime_error("no");
      };
      for (int round = 0; round < 20; ++round) CHECK_THROWS_AS(pool.runShort(1000, 1, failing), std::runtime_error);
      CHECK_FALSE(goesOn);
      CHECK(shortCounts(pool, 100, 1, 0) == std::vector<int>(100, 1));
      CHECK(counts(pool, 100, 1) == std::vector<int>(100, 1));
    }
  }
}

TEST_CASE("the environment says how many threads there are by default") {
  const auto with = [](const char* value) {
    otg::test::setVariable("OTG_THREADS", value);
    const unsigned threads = otg::defaultThreadCount();
    otg::test::unsetVariable("OTG_THREADS");
    return threads;
  };
  const unsigned cores = otg::defaultThreadCount();
  CHECK(cores >= 1);
  CHECK(cores == otg::threadsOfCores(cores, false));
  CHECK(otg::defaultThreadCount(true) == otg::threadsOfCores(cores, true));
  CHECK(with("3") == 3);
  for (const char* nonsense : {"", "0", "-1", "many", "3x", "1000000"}) CHECK(with(nonsense) == cores);
}

TEST_CASE("one of many cores is left to the driver of a device") {
  CHECK(otg::threadsOfCores(0, false) == 1);
  CHECK(otg::threadsOfCores(0, true) == 1);
  CHECK(otg::threadsOfCores(16, false) == 16);
  CHECK(otg::threadsOfCores(16, true) == 15);
  CHECK(otg::threadsOfCores(otg::kManyCores, true) == otg::kManyCores - 1);
  CHECK(otg::threadsOfCores(otg::kManyCores - 1, true) == otg::kManyCores - 1);
}
