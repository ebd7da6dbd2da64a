// SPDX-License-Identifier: BSD-3-Clause
// Six-dimensional binning of contacts by position and normal.
#include <algorithm>
#include <cstddef>

#include "collide/contact_order.h"
#include "collide/pairwise/reduction.h"
#include "collide/position_bounds.h"
#include "shared/contacts/contact_choice.h"

namespace otg {
namespace {

struct Entry {
  std::uint64_t bin;
  double score;  // squared distance from the centre of the 6-cube
  std::uint32_t contact;
};

}  // namespace

std::vector<Contact> reduceByBinning(std::span<const Contact> contacts, const std::array<int, 6>& bins) {
  const PositionBounds bounds(contacts);
  std::vector<Entry> entries;
  entries.reserve(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    double score = 0;
    const std::uint64_t bin =
        otgBinOf(contacts[i].position, contacts[i].normal, bounds.low, bounds.high, bins.data(), &score);
    entries.push_back({bin, score, static_cast<std::uint32_t>(i)});
  }
  std::sort(entries.begin(), entries.end(), [&](const Entry& x, const Entry& y) {
    if (x.bin != y.bin) return x.bin < y.bin;
    if (x.score != y.score) return x.score > y.score;
    return contactLess(contacts[x.contact], contacts[y.contact]);
  });
  std::vector<Contact> kept;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].bin != entries[i - 1].bin) kept.push_back(contacts[entries[i].contact]);
  }
  std::sort(kept.begin(), kept.end(), contactLess);
  return kept;
}

}  // namespace otg
