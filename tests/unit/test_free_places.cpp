// SPDX-License-Identifier: BSD-3-Clause
// Gaps of a buffer, against a list of all its places.
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "opencl/meshes/free_places.h"
#include "support/catch.h"
#include "support/draw.h"

using otg::opencl::FreePlaces;
using otg::test::Draw;

namespace {

/// Every place by itself.
struct PlaceList {
  std::vector<bool> taken;

  std::map<std::uint32_t, std::uint32_t> gaps() const {  ///< begin to size
    std::map<std::uint32_t, std::uint32_t> out;
    for (std::uint32_t i = 0; i < taken.size(); ++i) {
      if (taken[i]) continue;
      if (i > 0 && !taken[i - 1]) {
        ++out.rbegin()->second;
      } else {
        out[i] = 1;
      }
    }
    return out;
  }
  /// The smallest gap that is large enough, the first of several.
  std::optional<std::uint32_t> best(std::uint32_t count) const {
    std::optional<std::uint32_t> at;
    std::uint32_t size = 0;
    for (const auto& [begin, length] : gaps()) {
      if (length < count || (at && length >= size)) continue;
      at = begin;
      size = length;
    }
    return at;
  }
  void set(std::uint32_t begin, std::uint32_t count, bool value) {
    for (std::uint32_t i = begin; i < begin + count; ++i) taken[i] = value;
  }
};

}  // namespace

TEST_CASE("places are taken from the smallest gap that has them, and gaps that touch are one") {
  Draw draw(7);
  for (int round = 0; round < 20; ++round) {
    FreePlaces places;
    PlaceList list;
    std::map<std::uint32_t, std::uint32_t> held;
    for (int step = 0; step < 600; ++step) {
      const std::uint32_t what = draw.below(16), count = 1 + draw.below(what < 4 ? 40 : 6);
      if (what == 0) {
        places.grow(count);
        list.taken.resize(list.taken.size() + count, false);
      } else if (what < 9) {
        const std::optional<std::uint32_t> begin = places.take(count);
        REQUIRE(begin == list.best(count));
        if (!begin) continue;
        list.set(*begin, count, true);
        held[*begin] = count;
      } else if (!held.empty()) {
        auto it = held.begin();
        std::advance(it, draw.below(static_cast<std::uint32_t>(held.size())));
        places.giveBack(it->first, it->second);
        list.set(it->first, it->second, false);
        held.erase(it);
      }
      std::uint32_t free = 0;
      for (const auto& gap : list.gaps()) free += gap.second;
      REQUIRE(places.free() == free);
      REQUIRE(places.gaps() == list.gaps().size());
      REQUIRE(places.capacity() == list.taken.size());
    }
    places.clear();
    CHECK(places.capacity() == 0);
    CHECK_FALSE(places.take(1));
  }
}
