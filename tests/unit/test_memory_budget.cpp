// SPDX-License-Identifier: BSD-3-Clause
// The budget that several stores of one device share: what they take together, and who makes room for whom.
#include <cstdint>
#include <thread>
#include <vector>

#include "opencl/runtime/memory_budget.h"
#include "support/catch.h"

using otg::opencl::MemoryBudget;

namespace {

/// Holds some of a budget, and lets go unless that is in use.
class Store : private MemoryBudget::Sharer {
 public:
  explicit Store(MemoryBudget& budget) : budget_(budget) { budget.join(*this); }
  ~Store() {
    budget_.leave(*this);
    budget_.giveBack(held);
  }
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  bool take(std::uint64_t bytes) {
    if (!budget_.take(bytes)) return false;
    held += bytes;
    return true;
  }
  bool askOthers() { return budget_.askOthers(*this); }
  std::uint64_t held = 0;
  bool inUse = false;

 private:
  void letGo() noexcept override {
    if (inUse) return;
    budget_.giveBack(held);
    held = 0;
  }
  MemoryBudget& budget_;
};

}  // namespace

TEST_CASE("what stores take together is never more than the budget") {
  MemoryBudget budget(100);
  CHECK(budget.bytes() == 100);
  CHECK(budget.left() == 100);
  Store first(budget);
  CHECK(first.take(70));
  {
    Store second(budget);
    CHECK_FALSE(second.take(31));
    CHECK(second.take(30));
    CHECK(budget.left() == 0);
    CHECK_FALSE(second.take(1));
    CHECK(second.take(0));
  }
  CHECK(budget.left() == 30);  // who goes gives back
}

TEST_CASE("others let go of what they do not use, and who asks keeps what it has") {
  MemoryBudget budget(100);
  Store asker(budget);
  CHECK_FALSE(asker.askOthers());  // there are none
  Store idle(budget), busy(budget);
  busy.inUse = true;
  CHECK(asker.take(10));
  CHECK(idle.take(50));
  CHECK(busy.take(40));
  CHECK(asker.askOthers());
  CHECK(asker.held == 10);
  CHECK(idle.held == 0);
  CHECK(busy.held == 40);
  CHECK(budget.left() == 50);
}

TEST_CASE("threads that take and give back leave the budget as it was") {
  MemoryBudget budget(64);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 2000; ++i) {
        if (budget.take(40)) budget.giveBack(40);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(budget.left() == 64);
}
