// SPDX-License-Identifier: BSD-3-Clause
// Small regions beside large ones, as the host describes them from what a device says of them: to the last bit what it
// makes of the whole pair, in the same order.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include "collide/solid/edge_pieces.h"
#include "collide/solid/found_overlap.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/contact_samples.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A pair described as a whole, and the region of each crossing.
class Whole {
 public:
  explicit Whole(const Query& query) : meshes_(query) {
    findIntersectingPairs(query, workspace_);
    std::sort(workspace_.intersecting.begin(), workspace_.intersecting.end());
    traceContour(meshes_, workspace_.intersecting, contour_);
    floodInside(meshes_, contour_, inside_);
    builder_.build(meshes_, contour_, inside_, regions_);
    EdgePieces::Storage storage;
    const EdgePieces pieces(meshes_, contour_, inside_, regions_.origin, storage);
    parent_.resize(pieces.count());
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (const Chord& chord : contour_.chords) join(chord.start, chord.end);
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t edge : contour_.crossedEdges[m]) {
        for (const EdgePiece& piece : pieces.on(m, edge)) {
          join(piece.fromElement, piece.toElement);
          stretches_[{edge, m}].push_back(piece.fromVertex ? piece.toElement : piece.fromElement);
        }
      }
    }
    for (std::uint32_t c = 0; c < contour_.crossings.size(); ++c) {
      if (root(c) == c) roots_.push_back(c);
    }
  }
  const PlacedMeshes& meshes() const { return meshes_; }
  const OverlapRegions& regions() const { return regions_; }
  bool isPlain() const {
    return contour_.anomalies + inside_.anomalies + regions_.anomalies == 0 &&
           roots_.size() == regions_.regions.size() && count(true) <= OTG_OVERLAP_REGIONS;
  }
  bool isLarge(const Region& region) const { return region.cellEnd > region.cellBegin; }
  std::size_t count(bool large) const {
    return static_cast<std::size_t>(std::count_if(regions_.regions.begin(), regions_.regions.end(),
                                                  [&](const Region& region) { return isLarge(region) == large; }));
  }

  /// What a device says: the head, hits of small regions, and of the parts that these share with large ones.
  otg_overlap_state head() const {
    otg_overlap_state head{};
    head.counts[OTG_OVERLAP_REGION_COUNT] = static_cast<otg_uint>(regions_.regions.size());
    for (const Region& region : regions_.regions) {
      if (isLarge(region)) head.regions[head.counts[OTG_OVERLAP_LARGE]++].first = region.first;
    }
    head.origin[0] = regions_.origin.x;
    head.origin[1] = regions_.origin.y;
    head.origin[2] = regions_.origin.z;
    return head;
  }
  std::vector<otg_found_inside> said(std::map<otg_uint, std::size_t>& kinds) {
    std::vector<otg_found_inside> list;
    std::map<std::uint32_t, std::uint32_t> smallest[2];  // by B's triangle, in small regions and in large ones
    for (const Chord& chord : contour_.chords) {
      const bool large = isOfLarge(chord.start);
      const auto [at, isNew] = smallest[large ? 1 : 0].emplace(chord.triangleB, chord.triangleA);
      if (!isNew) at->second = std::min(at->second, chord.triangleA);
      if (!large) list.push_back({chord.triangleA, chord.triangleB});
    }
    for (const auto& [triangle, first] : smallest[0]) {
      const auto other = smallest[1].find(triangle);
      if (other == smallest[1].end() || other->second > first) continue;
      list.push_back({triangle, OTG_FOUND_TRIANGLE | other->second});
      ++kinds[OTG_FOUND_TRIANGLE];
    }
    for (const auto& [where, crossings] : stretches_) {
      const auto& [edge, m] = where;
      otg_uint others = 0, own = 0;
      for (const std::uint32_t c : crossings) {
        if (isOfLarge(c)) {
          ++others;
          continue;
        }
        if (others > 0) {
          list.push_back({what(edge, m), OTG_FOUND_BEHIND | own << OTG_BEHIND_BITS | others});
          ++kinds[OTG_FOUND_BEHIND];
        }
        ++own;
      }
      const Contour::Range range = contour_.on(m, edge);
      std::uint32_t first = kNone;
      bool anySmall = false;
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const std::uint32_t c = contour_.alongEdge[i];
        if (isOfLarge(c)) {
          first = std::min(first, contour_.crossings[c].triangle);
        } else {
          anySmall = true;
        }
      }
      if (!anySmall || first == kNone) continue;
      list.push_back({what(edge, m), OTG_FOUND_EDGE | first});
      ++kinds[OTG_FOUND_EDGE];
    }
    std::reverse(list.begin(), list.end());  // in no order
    return list;
  }

 private:
  static otg_uint what(std::uint32_t edge, int m) { return edge << 1 | static_cast<otg_uint>(m); }
  std::uint32_t root(std::uint32_t e) const {
    while (parent_[e] != e) e = parent_[e];
    return e;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  bool isOfLarge(std::uint32_t crossing) const {
    const auto at = std::lower_bound(roots_.begin(), roots_.end(), root(crossing));
    return isLarge(regions_.regions[static_cast<std::size_t>(at - roots_.begin())]);
  }

  PlacedMeshes meshes_;
  Workspace workspace_;
  Contour contour_;
  InsideFlags inside_;
  RegionBuilder builder_;
  OverlapRegions regions_;
  std::vector<std::uint32_t> parent_, roots_;
  std::map<std::pair<std::uint32_t, int>, std::vector<std::uint32_t>> stretches_;  ///< a crossing of each
};

template <class... T>
bool sameBits(const T&... pairs) {
  return (... && (std::bit_cast<std::uint64_t>(pairs.first) == std::bit_cast<std::uint64_t>(pairs.second)));
}
std::pair<double, double> two(double x, double y) {
  return {x, y};
}
bool sameVector(const Vec3d& a, const Vec3d& b) {
  return sameBits(two(a.x, b.x), two(a.y, b.y), two(a.z, b.z));
}

bool same(const Piece& x, const Piece& y) {
  return x.triangle == y.triangle && x.mesh == y.mesh && sameVector(x.vector, y.vector) && sameVector(x.lo, y.lo) &&
         sameVector(x.hi, y.hi) && sameBits(two(x.area, y.area), two(x.offset, y.offset));
}
bool same(const SupportPoint& x, const SupportPoint& y) {
  return x.mesh == y.mesh && x.kind == y.kind && x.feature == y.feature && x.ordinal == y.ordinal &&
         sameVector(x.position, y.position) && sameVector(x.along, y.along) && x.triangleA == y.triangleA &&
         x.triangleB == y.triangleB && sameBits(two(x.reach, y.reach));
}
bool same(const Region& x, const Region& y) {
  return sameVector(x.push, y.push) && sameVector(x.lo, y.lo) && sameVector(x.hi, y.hi) &&
         sameBits(two(x.areaA, y.areaA), two(x.areaB, y.areaB), two(x.volume, y.volume), two(x.coherence, y.coherence),
                  two(x.thickness, y.thickness)) &&
         x.bad == y.bad;
}

}  // namespace

TEST_CASE("small regions are described from their hits as with all others") {
  // A coarse box, a little aslant, on hills of different heights: its triangles and edges pass through several of them.
  const auto hills = [](double x, double y) { return (0.3 + 0.08 * x) * std::sin(3 * x) * std::cos(2.5 * y); };
  const CollisionMesh ground(scenes::build(scenes::makeGround(4, 1, 64, hills)), BuildStrategy::kSah);
  const CollisionMesh box(scenes::build(scenes::makeBox({2.6, 2.4, 0.5}, 2)), BuildStrategy::kSah);
  Draw draw(3);
  std::size_t compared = 0, wrong = 0;
  std::map<otg_uint, std::size_t> kinds;
  SmallRegions small;
  for (int i = 0; i < 1500; ++i) {
    const Transformd pose = makePose(draw.direction(), draw.uniform(0, 0.2),
                                     {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(0.3, 0.55)});
    Query query;
    query.a = i % 2 != 0 ? &box : &ground;
    query.b = i % 2 != 0 ? &ground : &box;
    query.bInA = pose;
    if (i % 2 != 0) {
      for (int k = 0; k < 9; ++k) query.bInA.r[k] = pose.r[3 * (k % 3) + k / 3];
      query.bInA.t = otgScale(otgRotateBack(pose, pose.t), -1.0);
    }
    Whole whole(query);
    if (!whole.isPlain() || whole.count(true) == 0 || whole.count(false) == 0) continue;
    const std::vector<otg_found_inside> said = whole.said(kinds);
    REQUIRE(describeSmall(whole.meshes(), whole.head(), said, small));
    REQUIRE(small.regions.regions.size() == whole.count(false));
    const std::vector<FoundRegion> order = regionsInOrder(whole.head(), small);
    REQUIRE(order.size() == whole.regions().regions.size());
    std::size_t next = 0;
    for (const Region& all : whole.regions().regions) {
      const FoundRegion& place = order[next++];
      REQUIRE(place.isLarge == whole.isLarge(all));
      if (place.isLarge) continue;
      const Region& own = small.regions.regions[place.number];
      const auto part = [](const auto& list, std::uint32_t begin, std::uint32_t end) {
        return std::span(list.data() + begin, list.data() + end);
      };
      const auto equal = [](const auto& x, const auto& y) { return same(x, y); };
      const auto pieces = part(whole.regions().pieces, all.pieceBegin, all.pieceEnd);
      const auto points = part(whole.regions().points, all.pointBegin, all.pointEnd);
      const auto ownPieces = part(small.regions.pieces, own.pieceBegin, own.pieceEnd);
      const auto ownPoints = part(small.regions.points, own.pointBegin, own.pointEnd);
      ++compared;
      wrong += same(all, own) && std::equal(pieces.begin(), pieces.end(), ownPieces.begin(), ownPieces.end(), equal) &&
                       std::equal(points.begin(), points.end(), ownPoints.begin(), ownPoints.end(), equal)
                   ? 0
                   : 1;
    }
  }
  CHECK(wrong == 0);
  CHECK(compared >= 1000);
  CHECK(kinds[OTG_FOUND_TRIANGLE] >= 100);
  CHECK(kinds[OTG_FOUND_BEHIND] >= 100);
  CHECK(kinds[OTG_FOUND_EDGE] >= 150);
}
