// SPDX-License-Identifier: BSD-3-Clause
// The table of geoms, against the standard library's, with addresses as allocators give them.
#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "ode/base/geom_table.h"
#include "support/catch.h"

using namespace otg;

namespace {

/// Never looked behind.
template <class Pointer>
Pointer pointer(std::uintptr_t address) {
  return reinterpret_cast<Pointer>(address);
}

}  // namespace

TEST_CASE("a table of geoms finds what is in it and nothing else") {
  GeomTable table;
  CHECK(table.find(pointer<dGeomID>(64)) == nullptr);
  table.erase(pointer<dGeomID>(64));
  table.fetch(pointer<dGeomID>(64));
  std::map<std::uintptr_t, std::uintptr_t> expected;
  std::mt19937 random(3);
  // Distances of equal objects side by side, of pages, and none at all.
  for (const std::uintptr_t step : {std::uintptr_t{16}, std::uintptr_t{272}, std::uintptr_t{4096}, std::uintptr_t{1}}) {
    for (int i = 0; i < 20000; ++i) {
      const std::uintptr_t address = 4096 + step * (random() % 700);
      switch (random() % 4) {
        case 0:
        case 1:
          table.insertOrAssign(pointer<dGeomID>(address), pointer<GeomObject*>(8u * static_cast<unsigned>(i) + 8));
          expected[address] = 8u * static_cast<unsigned>(i) + 8;
          break;
        case 2:
          table.erase(pointer<dGeomID>(address));
          expected.erase(address);
          break;
        default:
          table.fetch(pointer<dGeomID>(address));
      }
      REQUIRE(table.size() == expected.size());
      if (i % 500 != 0) continue;
      std::size_t wrong = 0;
      for (std::uintptr_t k = 0; k < 800; ++k) {
        const std::uintptr_t asked = 4096 + step * k;
        const auto found = expected.find(asked);
        const auto object = found == expected.end() ? nullptr : pointer<GeomObject*>(found->second);
        wrong += table.find(pointer<dGeomID>(asked)) == object ? 0 : 1;
      }
      REQUIRE(wrong == 0);
    }
  }
  while (!expected.empty()) {
    table.erase(pointer<dGeomID>(expected.begin()->first));
    expected.erase(expected.begin());
    std::size_t wrong = 0;
    for (const auto& [address, object] : expected) {
      wrong += table.find(pointer<dGeomID>(address)) == pointer<GeomObject*>(object) ? 0 : 1;
    }
    REQUIRE(wrong == 0);
  }
  CHECK(table.size() == 0);
}
