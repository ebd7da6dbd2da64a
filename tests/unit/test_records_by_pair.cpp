// SPDX-License-Identifier: BSD-3-Clause
// Records of a batch by the pairs that they belong to: by one thread and by several, against a list for each pair.
#include <cstdint>
#include <vector>

#include "dispatch/threads/thread_pool.h"
#include "opencl/results/take_records.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::opencl;
using otg::test::Draw;

TEST_CASE("records are listed by pairs, ascending, by any number of threads") {
  constexpr std::uint32_t kPairs = 77;
  Draw draw(4);
  ThreadPool pool(3);
  const RunParts threads = [&](std::size_t count, const ThreadPool::Work& work) { pool.run(count, 1, work); };
  for (const std::uint32_t count : {0u, 1u, 1000u, 65535u, 65536u, 200001u}) {
    std::vector<otg_pair_record> records(count);
    std::vector<std::vector<std::uint32_t>> expected(kPairs);
    for (std::uint32_t r = 0; r < count; ++r) {
      // In runs, as work-groups write them. Some pairs have none.
      const bool goesOn = r > 0 && draw.below(8) != 0;
      records[r].pair = goesOn ? records[r - 1].pair : draw.below(kPairs - 5);
      expected[records[r].pair].push_back(r);
    }
    const Answer answer{nullptr, reinterpret_cast<const std::byte*>(records.data()), count, sizeof(otg_pair_record)};
    for (const RunParts* by : {static_cast<const RunParts*>(nullptr), &threads}) {
      const RecordsByPair found(answer, kPairs, by);
      std::size_t wrong = 0;
      for (std::uint32_t pair = 0; pair < kPairs; ++pair) {
        const std::span<const std::uint32_t> own = found.of(pair);
        wrong += std::vector<std::uint32_t>(own.begin(), own.end()) == expected[pair] ? 0 : 1;
      }
      CHECK(wrong == 0);
    }
  }
}
