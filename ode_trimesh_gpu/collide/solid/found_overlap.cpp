// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/found_overlap.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/vectors.h"
#include "collide/solid/region_cells.h"
#include "collide/solid/support_point.h"

namespace otg {
namespace {

Vec3d vec(const double* p) {
  return {p[0], p[1], p[2]};
}

class Taker {
 public:
  Taker(const PlacedMeshes& meshes, const FoundOverlap& found, SmallRegions& small, OverlapRegions& out)
      : meshes_(meshes), found_(found), small_(small), out_(out) {}

  bool run() {
    out_.origin = vec(found_.head->origin);
    out_.regions.clear();
    out_.pieces.clear();
    out_.points.clear();
    out_.extents.cells.clear();
    out_.extents.positions.clear();
    out_.extents.query = &meshes_.query();
    out_.anomalies = 0;
    if (!describeSmall(meshes_, *found_.head, found_.small, small_)) return false;
    for (const FoundRegion& region : regionsInOrder(*found_.head, small_)) {
      if (!region.isLarge) {
        copySmall(region.number);
        continue;
      }
      takeLarge(region.number);
      if (needsTriangles(out_, out_.regions.back(), found_.head->regions[region.number].load)) return false;
    }
    return true;
  }

 private:
  void copySmall(std::size_t which) {
    const auto number = static_cast<std::uint32_t>(out_.regions.size());
    Region region = small_.regions.regions[which];
    const auto copy = [&](auto& from, auto& to, std::uint32_t& begin, std::uint32_t& end) {
      const auto first = static_cast<std::uint32_t>(to.size());
      to.insert(to.end(), from.begin() + begin, from.begin() + end);
      for (std::size_t i = first; i < to.size(); ++i) to[i].region = number;
      end = first + (end - begin);
      begin = first;
    };
    copy(small_.regions.pieces, out_.pieces, region.pieceBegin, region.pieceEnd);
    copy(small_.regions.points, out_.points, region.pointBegin, region.pointEnd);
    region.cellBegin = region.cellEnd = static_cast<std::uint32_t>(out_.extents.cells.size());
    out_.regions.push_back(region);
  }

  void takeLarge(std::uint32_t which) {
    const otg_found_region& found = found_.head->regions[which];
    const auto number = static_cast<std::uint32_t>(out_.regions.size());
    Region region;
    region.lo = vec(found.lo);
    region.hi = vec(found.hi);
    region.diagonal = norm(region.hi - region.lo);
    region.roundCorner = (found_.head->corners >> which & 1) != 0;
    takePieces(which, number, surfaceUnits(found.load, found.largest, region), region);
    takePoints(which, number, region);
    takeExtents(which, region);
    out_.regions.push_back(region);
  }

  void takePieces(std::uint32_t which, std::uint32_t number, const SurfaceUnits& units, Region& region) {
    cells_.clear();
    for (const otg_found_cell& cell : found_.cells) {
      if (cell.key >> 16 == which) cells_.push_back(&cell);
    }
    std::sort(cells_.begin(), cells_.end(),
              [](const otg_found_cell* x, const otg_found_cell* y) { return x->key < y->key; });
    RegionSums sums;
    region.pieceBegin = static_cast<std::uint32_t>(out_.pieces.size());
    for (const otg_found_cell* found : cells_) {
      PieceCells::Cell cell{{}, vec(found->lo), vec(found->hi), found->key & 0xffff, found->name};
      std::copy_n(found->vector, 3, cell.sum.vector);
      cell.sum.area = found->area;
      cell.sum.gross = found->gross;
      cell.sum.moment = found->moment;
      sums.add(cell, units);
      addPieceOfCell(meshes_, cell, number, units, out_.pieces);
    }
    region.pieceEnd = static_cast<std::uint32_t>(out_.pieces.size());
    sums.measure(region);
  }

  void takePoints(std::uint32_t which, std::uint32_t number, Region& region) {
    points_.clear();
    for (const otg_found_point& point : found_.points) {
      if (point.key >> 16 == which) points_.push_back(&point);
    }
    std::sort(points_.begin(), points_.end(), [](const otg_found_point* x, const otg_found_point* y) {
      if (x->key != y->key) return x->key < y->key;
      return x->feature != y->feature ? x->feature < y->feature : x->ordinal < y->ordinal;
    });
    region.pointBegin = static_cast<std::uint32_t>(out_.points.size());
    std::uint32_t last = kNone;
    for (const otg_found_point* p : points_) {
      if (p->key == last) continue;  // as deep as the one before
      last = p->key;
      const PointSeed seed{vec(p->position),
                           vec(p->span),
                           number,
                           p->feature,
                           p->ordinal,
                           kNone,
                           static_cast<std::uint8_t>(p->key >> 1 & 1),
                           static_cast<PointKind>(p->key >> 2 & 3),
                           (p->key & 1) != 0};
      out_.points.push_back(supportPoint(meshes_, seed, p->triangle));
    }
    region.pointEnd = static_cast<std::uint32_t>(out_.points.size());
  }

  void takeExtents(std::uint32_t which, Region& region) {
    region.cellBegin = static_cast<std::uint32_t>(out_.extents.cells.size());
    for (const otg_found_inside& inside : found_.clusters) {
      if (inside.region != which) continue;
      const int m = static_cast<int>(inside.what & 1);
      const Adjacency::Cluster* cluster = &meshes_.adjacency(m).clusters[inside.what >> 1];
      const PartBox box = boxOfCluster(meshes_, m, *cluster, out_.origin);
      out_.extents.cells.push_back({box.lo, box.hi, cluster->first, cluster[1].first, m});
    }
    positions_.clear();
    for (const otg_found_inside& inside : found_.vertices) {
      if (inside.region != which) continue;
      positions_.push_back(meshes_.vertex(static_cast<int>(inside.what & 1), inside.what >> 1) - out_.origin);
    }
    for (const otg_found_crossing& crossing : found_.crossings) {
      if (crossing.region == which) positions_.push_back(vec(crossing.point));
    }
    addExtentCells(region, positions_, cellScratch_, out_.extents);
  }

  const PlacedMeshes& meshes_;
  const FoundOverlap& found_;
  SmallRegions& small_;
  OverlapRegions& out_;
  std::vector<const otg_found_cell*> cells_;
  std::vector<const otg_found_point*> points_;
  std::vector<Vec3d> positions_;
  std::vector<std::uint32_t> cellScratch_;
};

}  // namespace

bool isApart(const otg_contacts_head& head) {
  return std::any_of(std::begin(head.regions), std::end(head.regions),
                     [](const otg_found_contacts& region) { return (region.status & OTG_FOUND_APART) != 0; });
}

std::vector<FoundRegion> regionsInOrder(const otg_overlap_state& head, const SmallRegions& small) {
  std::vector<FoundRegion> order;
  for (std::uint32_t r = 0; r < head.counts[OTG_OVERLAP_LARGE]; ++r) order.push_back({head.regions[r].first, r, true});
  for (std::uint32_t r = 0; r < small.regions.regions.size(); ++r) {
    order.push_back({small.regions.regions[r].first, r, false});
  }
  std::sort(order.begin(), order.end(), [](const FoundRegion& x, const FoundRegion& y) { return x.first < y.first; });
  return order;
}

namespace {

/// Edges and triangles of small regions that are crossed in large ones, too. They come in the order in which they are
/// met in all regions together; and stretches inside are counted along an edge, those of all regions.
class SharedParts {
 public:
  SharedParts(const PlacedMeshes& meshes, SmallRegions& small) : meshes_(meshes), small_(small) {
    std::sort(small_.shared.begin(), small_.shared.end(), before);
  }

  /// Before regions are made of the contour:
  void orderEdges() {
    if (!any(OTG_FOUND_EDGE)) return;
    for (int m = 0; m < 2; ++m) {
      std::vector<std::uint32_t>& edges = small_.contour.crossedEdges[m];
      std::sort(edges.begin(), edges.end(),
                [&](std::uint32_t x, std::uint32_t y) { return placeOfEdge(m, x) < placeOfEdge(m, y); });
    }
  }
  /// and of the regions:
  void countStretches() {
    if (!any(OTG_FOUND_BEHIND)) return;
    for (SupportPoint& point : small_.regions.points) {
      if (point.kind != PointKind::kVertex) countOthers(point);
    }
  }
  void orderPieces() {
    if (!any(OTG_FOUND_TRIANGLE)) return;
    meet_[0].clear();
    meet_[1].clear();
    for (const Chord& chord : small_.contour.chords) {
      meet_[0].emplace_back(chord.triangleA, 0);
      meet_[1].emplace_back(chord.triangleB, chord.triangleA);
    }
    for (const otg_found_inside& shared : small_.shared) {
      if (kindOf(shared) == OTG_FOUND_TRIANGLE) meet_[1].emplace_back(shared.what, shared.region & ~OTG_FOUND_KIND);
    }
    for (auto& list : meet_) std::sort(list.begin(), list.end());
    for (Region& region : small_.regions.regions) {
      const auto begin = small_.regions.pieces.begin() + region.pieceBegin;
      const auto end = small_.regions.pieces.begin() + region.pieceEnd;
      std::stable_sort(begin, end, [&](const Piece& x, const Piece& y) { return placeOf(x) < placeOf(y); });
      RegionSums sums;
      std::for_each(begin, end, [&](const Piece& p) { sums.add(p.mesh, p.vector, p.area, p.offset * p.area); });
      sums.measure(region);
    }
  }

 private:
  static otg_uint kindOf(const otg_found_inside& shared) { return shared.region & OTG_FOUND_KIND; }
  static bool before(const otg_found_inside& x, const otg_found_inside& y) {
    return x.what != y.what ? x.what < y.what : x.region < y.region;
  }
  bool any(otg_uint kind) const {
    return std::any_of(small_.shared.begin(), small_.shared.end(),
                       [&](const otg_found_inside& shared) { return kindOf(shared) == kind; });
  }
  /// The first entry of an edge from `region` on, or null.
  const otg_found_inside* find(int m, std::uint32_t edge, otg_uint region) const {
    const otg_found_inside wanted{edge << 1 | static_cast<otg_uint>(m), region};
    const auto found = std::lower_bound(small_.shared.begin(), small_.shared.end(), wanted, before);
    return found != small_.shared.end() && found->what == wanted.what ? &*found : nullptr;
  }

  void countOthers(SupportPoint& point) const {
    const bool isEnd = point.kind == PointKind::kCrossing;  // of which a stretch has two
    const otg_uint first = OTG_FOUND_BEHIND | (isEnd ? point.ordinal / 2 : point.ordinal) << OTG_BEHIND_BITS;
    const otg_found_inside* const found = find(point.mesh, point.feature, first);
    if (found == nullptr || found->region >> OTG_BEHIND_BITS != first >> OTG_BEHIND_BITS) return;
    const otg_uint others = found->region & ((1u << OTG_BEHIND_BITS) - 1);
    point.ordinal += isEnd ? 2 * others : others;
  }

  /// Where an edge is met: the first pair of triangles, and which of its own triangle's edges it is.
  std::array<std::uint32_t, 3> placeOfEdge(int m, std::uint32_t edge) const {
    const std::uint32_t half = meshes_.adjacency(m).halfEdgeOf[edge];
    const std::uint32_t first = std::min(half, meshes_.mesh(m).topology().twin[half]);
    const Contour& contour = small_.contour;
    std::uint32_t triangle = kNone;
    const Contour::Range range = contour.on(m, edge);
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      triangle = std::min(triangle, contour.crossings[contour.alongEdge[i]].triangle);
    }
    const otg_found_inside* const shared = find(m, edge, OTG_FOUND_EDGE);
    if (shared) triangle = std::min(triangle, shared->region & ~OTG_FOUND_KIND);
    return {m == 0 ? first / 3 : triangle, m == 0 ? triangle : first / 3, first % 3};
  }

  /// Clipped triangles of A, then those of B as A's triangles meet them, then whole ones.
  std::array<std::uint32_t, 3> placeOf(const Piece& piece) const {
    const auto& list = meet_[piece.mesh];
    const auto met =
        std::lower_bound(list.begin(), list.end(), std::pair<std::uint32_t, std::uint32_t>{piece.triangle, 0});
    if (met == list.end() || met->first != piece.triangle) return {2, 0, 0};
    return {piece.mesh, met->second, piece.mesh == 0 ? 0 : piece.triangle};
  }

  const PlacedMeshes& meshes_;
  SmallRegions& small_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> meet_[2];  ///< clipped triangles, with A's that meet them
};

}  // namespace

bool describeSmall(const PlacedMeshes& meshes, const otg_overlap_state& head, std::span<const otg_found_inside> hits,
                   SmallRegions& small) {
  const std::size_t count = head.counts[OTG_OVERLAP_REGION_COUNT] - head.counts[OTG_OVERLAP_LARGE];
  small.regions.regions.clear();
  if (count == 0) return true;
  small.hits.clear();
  small.shared.clear();
  for (const otg_found_inside& hit : hits) {
    if ((hit.region & OTG_FOUND_KIND) != 0) {
      small.shared.push_back(hit);
    } else {
      small.hits.push_back({hit.what, hit.region});
    }
  }
  std::sort(small.hits.begin(), small.hits.end());
  SharedParts shared(meshes, small);
  traceContour(meshes, small.hits, small.contour);
  shared.orderEdges();
  floodInside(meshes, small.contour, small.inside);
  small.builder.build(meshes, small.contour, small.inside, vec(head.origin), small.regions);
  shared.countStretches();
  shared.orderPieces();
  return small.regions.regions.size() == count;
}

bool takeOverlap(const PlacedMeshes& meshes, const FoundOverlap& found, SmallRegions& small, OverlapRegions& out) {
  return Taker(meshes, found, small, out).run();
}

}  // namespace otg
