// SPDX-License-Identifier: BSD-3-Clause
// Arrays of items that are asked about one by one, by the CPU's threads or with a device.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "dispatch/device_slot.h"
#include "dispatch/threads/thread_pool.h"

namespace otg {

/// Items begin to end - 1, in the frame of the mesh -> to[0] and up. Called by any thread.
template <class Item>
using ArraySource = std::function<void(std::size_t begin, std::size_t end, Item* to)>;
/// The same items with their answers. Called by any thread, once for each item.
template <class Item, class Answer>
using ArraySink = std::function<void(std::size_t begin, std::size_t end, const Item* items, const Answer* answers)>;

/// Items that one thread takes at a time.
inline constexpr std::size_t kItemsAtOnce = 64;

/// All items by the pool's threads, from number `first` on; one(item): its answer.
template <class Item, class Answer, class One>
void answerOnHost(ThreadPool& pool, std::size_t first, std::size_t count, const ArraySource<Item>& source,
                  const ArraySink<Item, Answer>& sink, const One& one) {
  pool.run(count, kItemsAtOnce, [&](std::size_t begin, std::size_t end) {
    Item items[kItemsAtOnce];
    Answer answers[kItemsAtOnce];
    for (std::size_t from = begin; from < end; from += kItemsAtOnce) {
      const std::size_t to = std::min(end, from + kItemsAtOnce);
      source(first + from, first + to, items);
      for (std::size_t i = from; i < to; ++i) answers[i - from] = one(items[i - from]);
      sink(first + from, first + to, items, answers);
    }
  });
}

/// With a device that finds a word for each item: ask(fill, take) has it do so, as Backend::askPoints, and returns how
/// many it did. answer(item, word): what the CPU's threads make of it. Returns what ask does.
template <class Item, class Answer, class Ask, class FromWord>
std::size_t answerWithDevice(DeviceSlot& slot, ThreadPool& pool, std::size_t count, const ArraySource<Item>& source,
                             const ArraySink<Item, Answer>& sink, const Ask& ask, const FromWord& answer) {
  constexpr std::size_t kPart = 1024;  // of a thread
  const auto fill = [&](std::size_t begin, std::size_t end, Item* to) {
    pool.run(end - begin, kPart, [&](std::size_t b, std::size_t e) { source(begin + b, begin + e, to + b); });
  };
  const auto take = [&](std::size_t begin, std::size_t end, const Item* items, const otg_uint* words) {
    pool.run(end - begin, kPart, [&](std::size_t b, std::size_t e) {
      Answer answers[kItemsAtOnce];
      for (std::size_t from = b; from < e; from += kItemsAtOnce) {
        const std::size_t to = std::min(e, from + kItemsAtOnce);
        for (std::size_t i = from; i < to; ++i) answers[i - from] = answer(items[i], words[i]);
        sink(begin + from, begin + to, items + from, answers);
      }
    });
  };
  slot.underWay.fetch_add(1, std::memory_order_relaxed);
  struct Done {
    DeviceSlot& slot;
    ~Done() { slot.underWay.fetch_sub(1, std::memory_order_relaxed); }
  } const done{slot};
  const std::size_t answered = ask(fill, take);
  slot.note(0, answered == count);
  return answered;
}

}  // namespace otg
