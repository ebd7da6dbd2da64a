// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/vectors.h"
#include "shared/contacts/uneven_model.h"

namespace otg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSameNormal = OTG_UNEVEN_SAME_NORMAL;
constexpr double kSurely = OTG_UNEVEN_SURELY;
constexpr double kBoundsError = 1e-9;  ///< of a triangle's size: OTG_ON_TRIANGLE and what rounds
/// Radii within which the shortest way is looked for: of the longest way, of the way before, and of the last radius.
constexpr double kFirstRadius = 1.0 / 64, kSameLength = 2, kNextRadius = 4;
constexpr std::size_t kNoSlot = ~std::size_t{0};

}  // namespace

void RegionTriangles::collect(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  slack_ = OTG_SOLID_ON_EDGE * region.diagonal;
  behind_ = OTG_SOLID_BELOW_SURFACE * region.diagonal;
  triangles_.clear();
  planes_.clear();
  for (int m = 0; m < 2; ++m) {
    faces_[m].clear();
    edges_[m].clear();
    stretches_[m].clear();
  }
  edgesAdded_.clear();
  sameAs_.clear();
  triangles_.reserve(region.pieceEnd - region.pieceBegin);
  planes_.reserve(region.pieceEnd - region.pieceBegin);
  for (int m = 0; m < 2; ++m) {
    const auto first = all.pieces.begin() + region.pieceBegin, last = all.pieces.begin() + region.pieceEnd;
    const auto count =
        static_cast<std::size_t>(std::count_if(first, last, [m](const Piece& p) { return p.mesh == m; }));
    faces_[m].reserve(count);
    edges_[m].reserve(2 * count);  // of closed surfaces there are 1.5 for each triangle, and some at the rim
    stretches_[m].reserve(2 * count);
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      if (all.pieces[i].mesh == m) addTriangle(meshes, all.origin, all.pieces[i]);
    }
    begin_[m + 1] = triangles_.size();
  }
  curved_.assign(triangles_.size(), Curved::kUnknown);
  lastLength_ = 0;
}

void RegionTriangles::addTriangle(const PlacedMeshes& meshes, const Vec3d& origin, const Piece& piece) {
  RegionTriangle t;
  t.normal = piece.normal;
  t.offset = piece.offset;
  const auto& v = meshes.mesh(piece.mesh).triangles()[piece.triangle].v;
  for (int k = 0; k < 3; ++k) t.corner[k] = otgSub(meshes.vertex(piece.mesh, v[k]), origin);
  for (int k = 0; k < 3; ++k) {
    t.inward[k] = otgInward(t.normal, t.corner[k], t.corner[(k + 1) % 3]);
    t.edge[k] = otgDot(t.inward[k], t.corner[k]);
  }
  triangles_.push_back(t);
  planes_.push_back({t.normal, t.offset});
  addFace(piece.mesh, t);
  addEdges(meshes, t, piece.mesh, piece.triangle);
}

/// The bounds hold all places in the plane that are beside the triangle by the slack at most: at a corner they reach as
/// far as where the edges' lines meet that have been moved out.
void RegionTriangles::addFace(int m, const RegionTriangle& t) {
  double least = kInfinity;
  bool hasEdges = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d sum = otgAdd(t.inward[k], t.inward[(k + 1) % 3]);
    least = std::min(least, otgDot(sum, sum));
    hasEdges = hasEdges && otgDot(t.inward[k], t.inward[k]) > 0;
  }
  Vec3d lo = minimum(t.corner[0], minimum(t.corner[1], t.corner[2]));
  Vec3d hi = maximum(t.corner[0], maximum(t.corner[1], t.corner[2]));
  const double reach = hasEdges ? 1 + 2 / std::sqrt(least) : kInfinity;
  const double beside = hasEdges ? slack_ * reach : kInfinity;
  const double pad = kBoundsError * norm(otgSub(hi, lo)) + beside;
  const Vec3d all{pad, pad, pad};
  lo = otgSub(lo, all);
  hi = otgAdd(hi, all);
  faces_[m].add(
      {t.normal, t.offset, {t.inward[0], t.inward[1], t.inward[2]}, {t.edge[0], t.edge[1], t.edge[2]}, lo, hi, reach});
}

void RegionTriangles::addEdges(const PlacedMeshes& meshes, const RegionTriangle& t, std::uint8_t mesh,
                               std::uint32_t number) {
  const Topology& topology = meshes.mesh(mesh).topology();
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t half = 3 * number + k, twin = topology.twin[half];
    if (twin == kNone) continue;
    const Vec3d ends = otgSub(t.corner[(k + 1) % 3], t.corner[k]), other = meshes.normal(mesh, twin / 3);
    if (otgIsConvex(t.normal, other, ends) == 0) continue;
    bool isNew = false;
    edgesAdded_.insert(std::uint64_t{mesh} << 32 | std::min(half, twin), 0, &isNew);
    if (!isNew) continue;
    const RegionEdge edge{otgAdd(t.corner[k], otgScale(ends, 0.5)), unit(ends), 0.5 * norm(ends), {t.normal, other}};
    edges_[mesh].push_back(edge);
    stretches_[mesh].add(edge.middle, edge.along, edge.reach);
  }
}

bool RegionTriangles::isCurved(int m, std::uint32_t face) const {
  const std::size_t i = begin_[m] + face;
  if (curved_[i] == Curved::kUnknown) {
    const auto first = planes_.begin(), begin = first + static_cast<std::ptrdiff_t>(begin_[m]),
               end = first + static_cast<std::ptrdiff_t>(begin_[m + 1]);
    const bool is = std::any_of(
        begin, end, [&](const Plane& other) { return otgIsTurned(otgDot(other.normal, planes_[i].normal)) != 0; });
    curved_[i] = is ? Curved::kYes : Curved::kNo;
  }
  return curved_[i] == Curved::kYes;
}

double RegionTriangles::distanceOf(std::size_t i, const Vec3d& p) const {
  const RegionTriangle& t = triangles_[i];
  return otgDistanceOfTriangle(t.corner[0], t.corner[1], t.corner[2], p);
}

const std::pmr::vector<RegionTriangles::Exit>& RegionTriangles::exitsOf(int m, const Vec3d& p, double limit) {
  exits_.clear();
  if (faces_[m].size() == 0) return exits_;
  const bool isLimited = limit < kInfinity;
  const double enough = (isLimited ? limit : distanceOf(begin_[m] + faces_[m].nearest(p), p)) + slack_;
  const std::span<const std::uint32_t> near = faces_[m].near(p, kSurely * enough);
  distances_.assign(near.size(), kInfinity);
  double nearest = kInfinity;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const std::size_t i = begin_[m] + near[k];
    if (std::fabs(depthBelow(i, p)) > otgAsNear(nearest, slack_)) continue;
    distances_[k] = distanceOf(i, p);
    nearest = std::min(nearest, distances_[k]);
  }
  if (!(nearest < limit)) return exits_;
  for (std::size_t k = 0; k < near.size(); ++k) {
    if (!(distances_[k] <= otgAsNear(nearest, slack_))) continue;
    const std::size_t i = begin_[m] + near[k];
    const double depth = depthBelow(i, p);
    const Vec3d& normal = planes_[i].normal;
    if (!(depth > -slack_) || depth > otgAsNear(nearest, slack_)) continue;
    if (std::any_of(exits_.begin(), exits_.end(),
                    [&](const Exit& e) { return otgDot(e.normal, normal) > kSameNormal; }))
      continue;
    exits_.push_back({normal, planes_[i].offset, std::max(depth, 0.0), near[k]});
  }
  return exits_;
}

RegionTriangles::StretchExit RegionTriangles::stretchExit(int m, std::uint32_t face, const Vec3d& from,
                                                          const Vec3d& to) const {
  const std::size_t i = begin_[m] + face;
  const double first = depthBelow(i, from), last = depthBelow(i, to);
  return {{planes_[i].normal, planes_[i].offset, otgDeeperEnd(first, last), face}, last > first};
}

const std::pmr::vector<RegionTriangles::StretchExit>& RegionTriangles::facesOver(int m, const Vec3d& from,
                                                                                 const Vec3d& to, const Moved& moved) {
  if (sameAs_.empty()) findSameNormals();
  std::pmr::vector<StretchExit>& found = facesOver_;
  found.clear();
  for (const std::uint32_t k : faces_[m].over(from, to, slack_, moved)) {
    const StretchExit exit = stretchExit(m, k, from, to);
    const std::size_t same = sameAs_[begin_[m] + k];
    std::size_t& slot = slots_[same];
    if (slot == kNoSlot) {
      used_.push_back(same);
    } else if (exit.exit.depth < found[slot].exit.depth) {
      found[slot].exit.face = kNone;
    } else {
      continue;
    }
    slot = found.size();
    found.push_back(exit);
  }
  std::erase_if(found, [](const StretchExit& e) { return e.exit.face == kNone; });
  for (const std::size_t i : used_) slots_[i] = kNoSlot;
  used_.clear();
  return found;
}

RegionTriangles::StretchExit RegionTriangles::soonestOver(int m, const Vec3d& from, const Vec3d& to) const {
  const FaceSet::Soonest soonest = faces_[m].soonest(from, to, slack_);
  if (!(soonest.depth < kInfinity)) return {{{0, 0, 0}, 0, kInfinity, kNone}, false};
  return stretchExit(m, soonest.face, from, to);
}

void RegionTriangles::findSameNormals() {
  // What faces the same way lies together along any axis.
  std::pmr::vector<std::size_t> order(triangles_.size(), triangles_.get_allocator());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) {
    const double a = planes_[x].normal.x, b = planes_[y].normal.x;
    return a != b ? a < b : x < y;
  });
  sameAs_.resize(order.size());
  slots_.assign(order.size(), kNoSlot);
  std::iota(sameAs_.begin(), sameAs_.end(), std::size_t{0});
  const double most = std::sqrt(2 * (1 - kSameNormal));
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Vec3d& normal = planes_[order[k]].normal;
    for (std::size_t j = k; j-- > 0 && normal.x - planes_[order[j]].normal.x <= most;) {
      if (!(otgDot(normal, planes_[order[j]].normal) > kSameNormal)) continue;
      sameAs_[order[k]] = sameAs_[order[j]];
      break;
    }
  }
}

void RegionTriangles::lookFrom(const Vec3d& from, double far) {
  for (int m = 0; m < 2; ++m) {
    ahead_[m].clear();
    for (const std::uint32_t k : faces_[m].near(from, kSurely * far)) {
      const std::size_t i = begin_[m] + k;
      const double depth = depthBelow(i, from);
      if (depth >= -behind_ && depth < kSurely * far) ahead_[m].push_back({depth, static_cast<std::uint32_t>(i)});
    }
    std::sort(ahead_[m].begin(), ahead_[m].end(),
              [](const TriangleAhead& x, const TriangleAhead& y) { return x.depth < y.depth; });
  }
}

std::optional<RegionTriangles::Shortest> RegionTriangles::shortestWay(const Vec3d& from, const WaySet& ways, double far,
                                                                      const Vec3d& ending) {
  // Most are short, and as long as that of the point before. Within a radius only triangles in it matter.
  for (double radius = std::max(kSameLength * lastLength_, kFirstRadius * far);; radius *= kNextRadius) {
    const bool isAll = !(radius < far);
    lookFrom(from, isAll ? far : radius);
    ShortestWayArgs args{ways.blocks().data(),
                         ways.blocks().size(),
                         triangles_.data(),
                         {ahead_[0].data(), ahead_[1].data()},
                         {ahead_[0].size(), ahead_[1].size()},
                         from,
                         ending,
                         OTG_SOLID_FACING,
                         OTG_UNEVEN_LEAST_COSINE,
                         slack_,
                         isAll ? kInfinity : radius,
                         kInfinity,
                         0,
                         0,
                         0};
    findShortestWay(args);
    if (args.length < kInfinity) {
      lastLength_ = args.length;
      return Shortest{args.way, args.out, args.back};
    }
    if (isAll) return std::nullopt;
  }
}

double RegionTriangles::distanceToFacing(int m, const Vec3d& p, const Vec3d& direction, double limit) const {
  double nearest = limit;
  for (const std::uint32_t k : faces_[m].near(p, kSurely * limit)) {
    const std::size_t i = begin_[m] + k;
    if (std::fabs(depthBelow(i, p)) >= nearest || otgDot(planes_[i].normal, direction) < OTG_SOLID_FACING) continue;
    nearest = std::min(nearest, distanceOf(i, p));
  }
  return nearest;
}

}  // namespace otg
