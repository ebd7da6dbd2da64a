// SPDX-License-Identifier: BSD-3-Clause
// The split of least cost by the surface-area heuristic: the chance that a query opens a side grows with its surface,
// the work below with its triangles. So the cost of a split is the sum of area times triangles over both sides. Source
// of the method: I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.
#include <array>

#include "bvh/split_rules.h"

namespace otg {
namespace {

/// Sets up to this size try every split along each axis; above, bins are cheaper and lose little.
constexpr std::uint32_t kSweepSize = 8;
constexpr int kBins = 16;

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = -1;
  int place = 0;           ///< first bin, or first position in order, on the right
  std::uint32_t left = 0;  ///< triangles on the left

  /// Takes the other over if it costs less, or as much (flat and equal boxes) and is nearer to the middle.
  bool improve(const Split& other, std::uint32_t size) {
    const auto larger = [size](const Split& s) { return std::max(s.left, size - s.left); };
    if (!(other.cost < cost || (other.cost == cost && larger(other) < larger(*this)))) return false;
    *this = other;
    return true;
  }
};

using Order = std::array<std::uint8_t, kSweepSize>;

/// Positions in `set` by centre along the axis, ties by triangle number.
Order orderAlong(const TriangleSet& set, const Float4* centers, int axis) {
  Order order{};
  for (std::uint32_t i = 0; i < set.size; ++i) {
    std::uint32_t j = i;
    for (; j > 0; --j) {
      const std::uint8_t p = order[j - 1];
      const float a = centers[p][axis], b = centers[i][axis];
      if (a < b || (a == b && set.triangles[p] < set.triangles[i])) break;
      order[j] = p;
    }
    order[j] = static_cast<std::uint8_t>(i);
  }
  return order;
}

std::uint32_t splitBySweep(TriangleSet set) {
  const std::uint32_t n = set.size;
  Float4 centers[kSweepSize];
  for (std::uint32_t i = 0; i < n; ++i) centers[i] = set.boxes[i].middle();
  Split best;
  Order bestOrder{};
  for (int axis = 0; axis < 3; ++axis) {
    const Order order = orderAlong(set, centers, axis);
    double rightCost[kSweepSize];
    MeshBox box;
    for (std::uint32_t i = n - 1; i > 0; --i) {
      box.grow(set.boxes[order[i]]);
      rightCost[i] = (n - i) * box.halfArea();
    }
    box = {};
    for (std::uint32_t i = 1; i < n; ++i) {
      box.grow(set.boxes[order[i - 1]]);
      const double cost = i * box.halfArea() + rightCost[i];
      if (best.improve({cost, axis, static_cast<int>(i), i}, n)) bestOrder = order;
    }
  }
  MeshBox boxes[kSweepSize];
  std::uint32_t triangles[kSweepSize];
  for (std::uint32_t i = 0; i < n; ++i) {
    boxes[i] = set.boxes[bestOrder[i]];
    triangles[i] = set.triangles[bestOrder[i]];
  }
  std::copy(boxes, boxes + n, set.boxes);
  std::copy(triangles, triangles + n, set.triangles);
  return static_cast<std::uint32_t>(best.place);
}

/// Bin of each centre along each axis. Works on halves of the coordinates, whose differences are finite for any floats.
class Binning {
 public:
  explicit Binning(const MeshBox& centers) : lo_(0.5f * centers.lo) {
    for (int k = 0; k < 3; ++k) {
      // Where the inverse of the width is not finite, all centres fall into bin 0 and the axis offers no split.
      const float scale = static_cast<float>(kBins) / (0.5f * centers.hi[k] - lo_[k]);
      scale_[k] = std::isfinite(scale) ? scale : 0.0f;
    }
  }
  using Bins = std::int32_t __attribute__((vector_size(16)));
  Bins operator()(const MeshBox& box) const {
    const Bins bins = __builtin_convertvector((0.5f * box.middle() - lo_) * scale_, Bins);
    constexpr Bins kLast{kBins - 1, kBins - 1, kBins - 1, kBins - 1};
    return bins < kLast ? bins : kLast;
  }

 private:
  Float4 lo_, scale_{0, 0, 0, 0};
};

std::uint32_t splitByBins(TriangleSet set, const MeshBox& centers) {
  struct Bin {
    MeshBox box;
    std::uint32_t count = 0;
  };
  const Binning binOf(centers);
  std::array<std::array<Bin, kBins>, 3> bins;
  for (std::uint32_t i = 0; i < set.size; ++i) {
    const MeshBox& box = set.boxes[i];
    const Binning::Bins place = binOf(box);
    for (int k = 0; k < 3; ++k) {
      Bin& bin = bins[k][place[k]];
      bin.box.grow(box);
      ++bin.count;
    }
  }
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    double rightCost[kBins];
    MeshBox box;
    std::uint32_t count = 0;
    for (int i = kBins - 1; i > 0; --i) {
      box.grow(bins[axis][i].box);
      count += bins[axis][i].count;
      rightCost[i] = count > 0 ? count * box.halfArea() : 0;
    }
    box = {};
    count = 0;
    for (int i = 1; i < kBins; ++i) {
      box.grow(bins[axis][i - 1].box);
      count += bins[axis][i - 1].count;
      if (count == 0 || count == set.size) continue;
      const double cost = count * box.halfArea() + rightCost[i];
      best.improve({cost, axis, i, count}, set.size);
    }
  }
  if (best.axis < 0) return 0;
  return set.partition([&](const MeshBox& box, std::uint32_t) { return binOf(box)[best.axis] < best.place; });
}

}  // namespace

std::uint32_t splitBySah(TriangleSet set, const MeshBox& centers) {
  if (set.size == 2) return 1;
  return set.size <= kSweepSize ? splitBySweep(set) : splitByBins(set, centers);
}

}  // namespace otg
