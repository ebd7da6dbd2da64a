// SPDX-License-Identifier: BSD-3-Clause
// Choosing the contacts that go into a caller's smaller array.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <unordered_set>

#include "collide/contact_order.h"
#include "collide/pairwise/reduction.h"
#include "collide/position_bounds.h"
#include "shared/contacts/contact_choice.h"

namespace otg {
namespace {

/// Spreading costs (contacts x places). Beyond this many places the contacts already lie densely, and what is left is
/// filled by depth.
constexpr std::size_t kMaxSpreadPlaces = 1024;

/// The contacts that are not yet chosen, as a structure of arrays: the distance loop is the whole cost.
class Remaining {
 public:
  explicit Remaining(std::span<const Contact> contacts) : bounds_(contacts) {}

  void reserve(std::size_t n) {
    for (std::vector<std::int16_t>& axis : x_) axis.reserve(n);
    nearest_.reserve(n);
    index_.reserve(n);
  }

  void add(const Contact& c, std::uint32_t index) {
    const std::array<int, 6> p = point(c);
    for (std::size_t k = 0; k < 6; ++k) x_[k].push_back(static_cast<std::int16_t>(p[k]));
    nearest_.push_back(std::numeric_limits<int>::max());
    index_.push_back(index);
  }

  /// Accounts for a chosen contact.
  void spreadFrom(const Contact& chosen) {
    const std::array<int, 6> p = point(chosen);
    const std::size_t n = index_.size();
    for (std::size_t i = 0; i < n; ++i) {
      int d = 0;
      for (std::size_t k = 0; k < 6; ++k) d += (x_[k][i] - p[k]) * (x_[k][i] - p[k]);
      nearest_[i] = d < nearest_[i] ? d : nearest_[i];
    }
  }

  /// Removes the contact farthest from all chosen ones (ties: the smallest index) and returns its index.
  std::uint32_t takeFarthest() {
    std::size_t best = 0;
    for (std::size_t i = 1; i < index_.size(); ++i) {
      if (nearest_[i] > nearest_[best] || (nearest_[i] == nearest_[best] && index_[i] < index_[best])) best = i;
    }
    const std::uint32_t taken = index_[best];
    for (std::vector<std::int16_t>& axis : x_) {
      axis[best] = axis.back();
      axis.pop_back();
    }
    nearest_[best] = nearest_.back();
    nearest_.pop_back();
    index_[best] = index_.back();
    index_.pop_back();
    return taken;
  }

 private:
  std::array<int, 6> point(const Contact& c) const {
    std::array<int, 6> p{};
    otgSpreadPoint(c.position, c.normal, bounds_.low, bounds_.high, p.data());
    return p;
  }

  PositionBounds bounds_;
  std::array<std::vector<std::int16_t>, 6> x_;
  std::vector<int> nearest_;  // squared distance to the nearest chosen contact, in steps of the grid
  std::vector<std::uint32_t> index_;
};

/// Leaves so many of the contacts, which come deepest first.
void keepSpread(std::vector<Contact>& sorted, std::size_t places) {
  // Deepest first, so the first contact of a region is its deepest, and regions come in the order of their depth.
  std::vector<std::uint8_t> chosen(sorted.size(), 0);
  std::size_t chosenCount = 0;
  const auto choose = [&](std::size_t i) {
    chosen[i] = 1;
    ++chosenCount;
  };
  std::unordered_set<std::uint32_t> regions;
  for (std::size_t i = 0; i < sorted.size() && chosenCount < places; ++i) {
    if (regions.insert(sorted[i].region).second) choose(i);
  }
  const std::size_t spreadPlaces = std::min(places, std::max(chosenCount, kMaxSpreadPlaces));
  if (chosenCount < spreadPlaces) {
    Remaining remaining(sorted);
    remaining.reserve(sorted.size() - chosenCount);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      if (!chosen[i]) remaining.add(sorted[i], static_cast<std::uint32_t>(i));
    }
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      if (chosen[i]) remaining.spreadFrom(sorted[i]);
    }
    while (chosenCount < spreadPlaces) {
      const std::uint32_t next = remaining.takeFarthest();
      choose(next);
      remaining.spreadFrom(sorted[next]);
    }
  }
  for (std::size_t i = 0; i < sorted.size() && chosenCount < places; ++i) {
    if (!chosen[i]) choose(i);
  }

  std::size_t kept = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (chosen[i]) sorted[kept++] = sorted[i];
  }
  sorted.resize(kept);
}

}  // namespace

void limitContacts(std::span<const Contact> contacts, int count, std::vector<Contact>& out) {
  out.assign(contacts.begin(), contacts.end());
  std::sort(out.begin(), out.end(), contactDeeper);
  const std::size_t places = static_cast<std::size_t>(std::max(count, 0));
  if (places == 0) out.clear();
  if (out.size() > places) keepSpread(out, places);
}

std::vector<Contact> limitContacts(std::span<const Contact> contacts, int count) {
  std::vector<Contact> out;
  limitContacts(contacts, count, out);
  return out;
}

}  // namespace otg
