// SPDX-License-Identifier: BSD-3-Clause
// What a geom remembers of its pairs, against a list that is searched.
#include <algorithm>
#include <random>
#include <vector>

#include "ode/geom/pair_memory.h"
#include "support/catch.h"

using namespace otg;

namespace {

/// Oldest first.
class ListedMemory {
 public:
  struct Item {
    std::uint64_t key;
    int value;
  };
  void store(std::uint64_t key, int value) {
    forget(key);
    if (items.size() == PairMemory::kMost) items.erase(items.begin());
    items.push_back({key, value});
  }
  void renew(std::uint64_t key) {
    const auto it = find(key);
    if (it != items.end()) std::rotate(it, it + 1, items.end());
  }
  void forget(std::uint64_t key) {
    const auto it = find(key);
    if (it != items.end()) items.erase(it);
  }
  std::vector<Item>::iterator find(std::uint64_t key) {
    return std::find_if(items.begin(), items.end(), [&](const Item& i) { return i.key == key; });
  }
  std::vector<Item> items;
};

SolidHistory historyOf(int value) {
  SolidHistory history;
  history.used = true;
  history.current.escapeLeft = value;
  return history;
}

bool isSame(PairMemory& memory, const ListedMemory& listed) {
  const auto all = memory.all();
  return std::equal(all.begin(), all.end(), listed.items.begin(), listed.items.end(),
                    [](const PairMemory::Remembered& x, const ListedMemory::Item& y) {
                      return x.key == y.key && x.history.current.escapeLeft == y.value;
                    });
}

}  // namespace

TEST_CASE("a geom remembers as many pairs as it may, and forgets the one that was asked for longest ago") {
  std::mt19937 random(1);
  const std::uint64_t keyRange = 2 * PairMemory::kMost;
  PairMemory memory, other;
  ListedMemory listed;
  std::uint64_t last = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t key = random() % keyRange;
    switch (random() % 8) {
      case 0:
        memory.forget(key);
        listed.forget(key);
        break;
      case 1: {
        const bool isKnown = listed.find(key) != listed.items.end();
        const std::uint64_t stamp = memory.renew(key);
        REQUIRE((stamp != 0) == isKnown);
        listed.renew(key);
        REQUIRE(memory.stampOf(key) == stamp);
        break;
      }
      case 2: {
        SolidHistory history;
        const auto it = listed.find(key);
        REQUIRE((memory.recall(key, history) != 0) == (it != listed.items.end()));
        if (it != listed.items.end()) REQUIRE(history.current.escapeLeft == it->value);
        break;
      }
      default: {
        const std::uint64_t stamp = memory.store(key, historyOf(i));
        REQUIRE(stamp > last);
        last = stamp;
        listed.store(key, i);
      }
    }
    if (i % 500 == 499) {
      memory.swap(other);
      REQUIRE(isSame(other, listed));
      memory.swap(other);
    }
    if (i % 100 == 99) REQUIRE(isSame(memory, listed));
  }
  CHECK(listed.items.size() == PairMemory::kMost);
  memory.clear();
  CHECK(memory.empty());
  CHECK(memory.all().empty());
}
