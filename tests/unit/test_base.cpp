// SPDX-License-Identifier: BSD-3-Clause
// What knows no mesh: hashes, disjoint sets, operators, objects that are made when they are needed.
#include <atomic>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/hash.h"
#include "base/of_thread.h"
#include "base/owned_later.h"
#include "base/union_find.h"
#include "base/vectors.h"
#include "support/catch.h"

using namespace otg;

namespace {

struct Counted {
  static inline std::atomic<int> made{0}, gone{0};
  Counted() { ++made; }
  ~Counted() { ++gone; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
};

/// What a thread keeps: its memory must be there until the destructor has run.
struct OfThread {
  static inline std::atomic<int> made{0}, gone{0}, sum{0};
  std::vector<int> values;
  OfThread() { ++made; }
  ~OfThread() {
    for (const int value : values) sum += value;
    ++gone;
  }
  OfThread(const OfThread&) = delete;
  OfThread& operator=(const OfThread&) = delete;
};

}  // namespace

TEST_CASE("FNV-1a has the published values, and goes on where it was") {
  const auto hash = [](const std::string& text) { return fnv1a(text.data(), text.size()); };
  CHECK(hash("") == 0xcbf29ce484222325u);
  CHECK(hash("a") == 0xaf63dc4c8601ec8cu);
  CHECK(hash("foobar") == 0x85944171f73967e8u);
  CHECK(fnv1a("bar", 3, fnv1a("foo", 3)) == hash("foobar"));
}

TEST_CASE("texts that differ in one place or in their length have other hashes of words") {
  const std::string text = "a text of several words, and a few bytes more than that";
  std::set<std::uint64_t> hashes;
  for (std::size_t count = 0; count <= text.size(); ++count) hashes.insert(hashOfWords(text.data(), count));
  CHECK(hashes.size() == text.size() + 1);
  for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string other = text;
    other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << bit % 8));
    hashes.insert(hashOfWords(other.data(), other.size()));
  }
  CHECK(hashes.size() == 9 * text.size() + 1);
  CHECK(hashOfWords("\0", 1) != hashOfWords("", 0));
}

TEST_CASE("numbers that differ anywhere get other places in small tables") {
  for (const int shift : {0, 4, 20, 32, 48}) {
    std::set<std::uint64_t> places;
    for (std::uint64_t i = 0; i < 256; ++i) places.insert(spreadBits(i << shift) & 1023);
    CHECK(places.size() > 192);  // 226 of random ones
  }
}

TEST_CASE("sets are named by their smallest member, and begin anew") {
  UnionFind sets(6);
  sets.unite(5, 3);
  sets.unite(3, 4);
  sets.unite(1, 2);
  CHECK(sets.find(5) == 3);
  CHECK(sets.find(4) == 3);
  CHECK(sets.find(2) == 1);
  CHECK(sets.find(0) == 0);
  sets.unite(4, 2);
  CHECK(sets.find(5) == 1);
  sets.reset(3);
  CHECK(sets.find(2) == 2);
}

TEST_CASE("operators are the shared formulas, bit for bit") {
  const Vec3d a{0.1, -2.7e10, 1e-300}, b{3.3, 0.7, -5e-301};
  CHECK(a + b == otgAdd(a, b));
  CHECK(a - b == otgSub(a, b));
  CHECK(a * 0.3 == otgScale(a, 0.3));
  CHECK(norm(b) == std::sqrt(otgDot(b, b)));
  CHECK(unit({0, 0, 0}) == Vec3d{0, 0, 0});
  CHECK(unit({0, -4, 3}) == otgScale(Vec3d{0, -4, 3}, 1.0 / 5));
}

TEST_CASE("what is owned later is made once, whoever comes first, and goes with its owner") {
  {
    const OwnedLater<Counted> never;
    CHECK(never.get() == nullptr);
  }
  CHECK(Counted::made == 0);
  {
    OwnedLater<Counted> later;
    std::vector<std::thread> threads;
    std::atomic<Counted*> seen[4]{};
    for (auto& s : seen) threads.emplace_back([&later, &s] { s = &later.make(); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& s : seen) CHECK(s == later.get());
    CHECK(Counted::made - Counted::gone == 1);
  }
  CHECK(Counted::made == Counted::gone);
}

TEST_CASE("each thread has an object of its own, destroyed with what it holds when the thread ends") {
  static_assert(noexcept(ofThread<OfThread>()));
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&wrong, t] {
      OfThread* const mine = &ofThread<OfThread>();
      for (int i = 0; i < 1000; ++i) ofThread<OfThread>().values.push_back(t);
      if (&ofThread<OfThread>() != mine || mine->values.size() != 1000) ++wrong;
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
  CHECK(OfThread::made == 8);
  CHECK(OfThread::gone == 8);
  CHECK(OfThread::sum == 28 * 1000);
}
