// SPDX-License-Identifier: BSD-3-Clause
// Six-dimensional binning of contacts by position and normal.
#include <algorithm>
#include <cstddef>
#include <limits>

#include "collide/contact_order.h"
#include "collide/reduction.h"

namespace otg {
namespace {

constexpr int kMaxBins = 64;  // 64^6 bins = 36 bits of key

using Point6 = std::array<double, 6>;

Point6 coordinates(const Contact& c) {
  return {c.position.x, c.position.y, c.position.z, c.normal.x, c.normal.y, c.normal.z};
}

/// The box that is scaled to the unit cube: the positions' own bounds, and [-1, 1] for normals.
struct Bounds6 {
  Point6 low, high;

  explicit Bounds6(std::span<const Contact> contacts) {
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const Contact& c : contacts) {
      const Point6 p = coordinates(c);
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
    for (std::size_t k = 3; k < 6; ++k) {
      low[k] = -1;
      high[k] = 1;
    }
  }

  /// An axis along which all positions agree says nothing: its coordinate is the middle of the cube. Halves are
  /// subtracted so that bounds near the largest double do not overflow.
  Point6 toUnitCube(const Contact& c) const {
    Point6 u = coordinates(c);
    for (std::size_t k = 0; k < 6; ++k) {
      const double half = 0.5 * high[k] - 0.5 * low[k];
      u[k] = half > 0 ? (0.5 * u[k] - 0.5 * low[k]) / half : 0.5;
    }
    return u;
  }
};

struct Entry {
  std::uint64_t bin;
  double score;  // squared distance from the centre of the 6-cube
  std::uint32_t contact;
};

std::uint64_t binOf(const Point6& u, const std::array<int, 6>& bins) {
  std::uint64_t key = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const int n = std::clamp(bins[k], 1, kMaxBins);
    const double scaled = u[k] * n;
    // The upper face belongs to the last bin, and a normal that rounding made longer than 1 to the outermost one. The
    // comparison that is false for NaN comes before the cast, which would be undefined for it.
    const int cell = scaled > 0 ? static_cast<int>(std::min(scaled, n - 1.0)) : 0;
    key = key * kMaxBins + static_cast<std::uint64_t>(cell);
  }
  return key;
}

}  // namespace

std::vector<Contact> reduceByBinning(std::span<const Contact> contacts, const std::array<int, 6>& bins) {
  const Bounds6 bounds(contacts);
  std::vector<Entry> entries;
  entries.reserve(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Point6 u = bounds.toUnitCube(contacts[i]);
    double score = 0;
    for (const double x : u) score += (x - 0.5) * (x - 0.5);
    entries.push_back({binOf(u, bins), score, static_cast<std::uint32_t>(i)});
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
