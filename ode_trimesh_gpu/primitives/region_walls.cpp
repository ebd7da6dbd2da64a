// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/region_walls.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "collide/inside_test.h"

namespace otg {
namespace {

constexpr std::size_t kMostWalls = 64;
constexpr double kSamePlane = 1 - 1e-12;
constexpr double kSameWay = 0.9986;     // cosine of 3 degrees
constexpr double kSameWall = 1 - 6e-6;  // of 0.2 degrees: a contact that leans more may be left along its wall
constexpr double kFacing = 0.5, kEdgeOn = 0.05;  // cosine between a contact's way out and the normals of what it leaves
constexpr double kEnough = 0.995;       // of a way: what contacts that ask for so much leave is not worth one more
constexpr double kShallow = 0.5;        // of a wall's deepest: points that are less deep hold little
constexpr std::size_t kMostHolds = 4;   // of a wall
constexpr double kOnPlane = 1e-10;      // of the bodies' reach: nearer to a plane it is not known on which side
constexpr double kInside = 1e-3;      // of an edge's stretch: from its crossing, so as not to be on the surface
constexpr double kPast = 1e-3;          // how far past a wall, in parts of the way out of it, a point is outside

}  // namespace

bool RegionWalls::read(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                       const PlacedShape& shape, std::span<const std::uint32_t> triangles, bool isConvex) {
  meshes_ = &meshes;
  origin_ = all.origin;
  walls_.clear();
  points_.clear();
  const double reach = double{meshes.mesh(0).radius()} + meshes.mesh(1).radius();
  rounding_ = 1e-13 * reach;
  far_ = 4 * reach;
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    if (p.mesh == 0 && !add(shape, p.normal, p.offset, p.triangle, !isConvex)) return false;
  }
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    if (all.pieces[i].mesh == 0) addInnerNeighbours(shape, all.pieces[i].triangle);
  }
  for (const std::uint32_t t : triangles) addInnerNeighbours(shape, t);
  if (std::none_of(walls_.begin(), walls_.end(), [](const Wall& w) { return w.counts; })) return false;
  const Vec3d middle = (region.lo + region.hi) * 0.5;
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const SupportPoint& p = all.points[i];
    if (shape.shape().isCurved()) {
      points_.push_back({p.position + (middle - p.position) * kInside, p.position, {0, 0, 0}});
    } else if (p.kind == PointKind::kCrossing && p.mesh == 1) {
      points_.push_back({p.position + p.along * (kInside * p.reach), p.position, p.along * p.reach});
    }
  }
  return true;
}

bool RegionWalls::add(const PlacedShape& shape, const Vec3d& normal, double offset, std::uint32_t triangle,
                      bool counts) {
  const bool known = std::any_of(walls_.begin(), walls_.end(), [&](const Wall& w) {
    return otgDot(w.normal, normal) > kSamePlane && std::fabs(w.offset - offset) <= rounding_;
  });
  if (known) return true;
  if (walls_.size() == kMostWalls) return false;
  walls_.push_back({normal, offset, offset - shape.rearAlong(normal), triangle, counts});
  return true;
}

/// What meets a triangle at an inner edge may be in the shape below the triangle only, where the region has no piece of
/// it.
void RegionWalls::addInnerNeighbours(const PlacedShape& shape, std::uint32_t triangle) {
  const TriMesh& mesh = meshes_->mesh(0);
  const Vec3d& n = meshes_->adjacency(0).normal[triangle];
  const Vec3d corner = meshes_->vertex(0, mesh.triangles()[triangle].v[0]);
  for (std::uint32_t half = 3 * triangle; half < 3 * triangle + 3; ++half) {
    const std::uint32_t twin = mesh.topology().twin[half];
    if (twin == kNone) continue;
    const Vec3d opposite = meshes_->vertex(0, mesh.triangles()[twin / 3].v[(twin + 2) % 3]);
    const Vec3d& other = meshes_->adjacency(0).normal[twin / 3];
    if (otgDot(n, opposite - corner) <= 0 || otgDot(n, other) > kSameWay) continue;
    const double offset = otgDot(other, opposite - origin_);
    if (shape.rearAlong(other) < offset) add(shape, other, offset, twin / 3, true);
  }
}

bool RegionWalls::isOn(const Wall& wall, const Vec3d& point) const {
  return std::fabs(wall.offset - otgDot(wall.normal, point)) <= kOnPlane * far_;
}

/// Whether the point has to leave the wall: it is inside the mesh still when it has left those that it is out of
/// sooner.
bool RegionWalls::isHeldBy(const Wall& wall, const Vec3d& point, const Inside* from) const {
  const double last = wall.offset - otgDot(wall.normal, point);
  std::vector<std::pair<double, const Wall*>> sooner;
  for (const Wall& w : walls_) {
    const double way = w.offset - otgDot(w.normal, point);
    if (from && isOn(w, from->crossing)) {
      if (std::fabs(otgDot(w.normal, from->stretch)) < last) return false;
      continue;
    }
    if (&w != &wall && way > -kOnPlane * far_ && way < last) sooner.emplace_back(way, &w);
  }
  std::sort(sooner.begin(), sooner.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  Vec3d p = point;
  for (const auto& [unused, w] : sooner) {
    const double onPlane = kOnPlane * far_, ahead = w->offset - otgDot(w->normal, p);
    const double way = ahead > onPlane ? ahead : 0, past = onPlane + kPast * way;
    const double exit = exitDistance(*meshes_, 0, p + origin_, w->normal, far_, 0);
    if (exit < way - past && way > 0) continue;  // the plane belongs to another part of the surface
    if (exit < way + past) return false;
    p = p + w->normal * (way + past);
  }
  const double way = wall.offset - otgDot(wall.normal, p);
  return way > 0 && exitDistance(*meshes_, 0, p + origin_, wall.normal, far_, 0) >= way * (1 - kPast);
}

/// Points of the shape that are behind the wall, the deepest first.
void RegionWalls::collect(const PlacedShape& shape, const Wall& wall, std::vector<Hold>& out) const {
  out.clear();
  const auto add = [&](const Vec3d& p, const Inside* from) {
    const double way = wall.offset - otgDot(wall.normal, p);
    if (way > rounding_) out.push_back({p, way, from});
  };
  if (shape.shape().isCurved()) {
    add(shape.rear(wall.normal), nullptr);
    for (const Inside& p : points_) add(shape.rearNear(wall.normal, p.point), nullptr);
  } else {
    for (const Vec3d& v : shape.shape().vertices) add(shape.fromLocal(v), nullptr);
    for (const Inside& p : points_) {
      if (!isOn(wall, p.crossing)) add(p.point, &p);
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const Hold& x, const Hold& y) { return x.way > y.way; });
}

void RegionWalls::limitDepths(std::vector<Contact>& contacts, std::size_t first) const {
  const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
  std::vector<std::pair<double, const Wall*>> ahead;
  const auto isVoid = [&](Contact& c) {
    const Vec3d point = c.position + c.normal * (0.5 * c.depth) - origin_;  // of the shape
    ahead.clear();
    // The faces of a spike see its tip's way out edge-on.
    for (const double facing : {kFacing, kEdgeOn}) {
      if (!ahead.empty()) break;
      for (const Wall& wall : walls_) {
        const double cosine = -otgDot(wall.normal, c.normal);
        if (cosine > facing) ahead.emplace_back((wall.offset - otgDot(wall.normal, point)) / cosine, &wall);
      }
    }
    std::sort(ahead.begin(), ahead.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
    while (!ahead.empty() && !(ahead.back().first > rounding_)) ahead.pop_back();
    if (!ahead.empty() && c.depth <= ahead.back().first * (1 + kPast)) return false;
    // Of a stair the next step's top faces the same way, and is not what the point is below.
    const auto farthest = std::find_if(ahead.begin(), ahead.end(), [&](const auto& w) { return isHeldBy(*w.second, point, nullptr); });
    if (farthest == ahead.end()) return true;
    const double most = farthest->first;
    if (c.depth <= most) return false;
    c.position = c.position + c.normal * (0.5 * (c.depth - most));
    c.depth = most;
    return false;
  };
  contacts.erase(std::remove_if(begin, contacts.end(), isVoid), contacts.end());
}

void RegionWalls::complete(const PlacedShape& shape, double closest, std::vector<Contact>& contacts,
                           std::size_t first) const {
  std::vector<Hold> holds;
  std::vector<Contact> added;
  const bool dbg = getenv("DBG") != nullptr;
  if (dbg) {
    printf("walls %zu points %zu\n", walls_.size(), points_.size());
    for (const Wall& w : walls_) {
      collect(shape, w, holds);
      printf(" wall n %g %g %g off %.9g holds %zu", w.normal.x, w.normal.y, w.normal.z, w.offset, holds.size());
      for (std::size_t i = 0; i < std::min<std::size_t>(8, holds.size()); ++i) printf(" [%.3g %d]", holds[i].way, isHeldBy(w, holds[i].point, holds[i].from));
      printf("\n");
      for (const Hold& h : holds) if (getenv("DBG2") && isHeldBy(w, h.point, h.from)) { printf("      p %.9g %.9g %.9g held ways", h.point.x, h.point.y, h.point.z); for (const Wall& v : walls_) printf(" %.3g(%.3g)", v.offset-otgDot(v.normal,h.point), exitDistance(*meshes_, 0, h.point + origin_, v.normal, far_, 0)); printf("\n"); }
    }
  }
  for (const Wall& wall : walls_) {
    if (!wall.counts || !(wall.depth > rounding_)) continue;
    double asked = 0;
    for (std::size_t i = first; i < contacts.size(); ++i) {
      const double along = -otgDot(contacts[i].normal, wall.normal);
      if (along > kSameWall) asked = std::max(asked, along * contacts[i].depth);
    }
    if (kEnough * wall.depth <= asked) continue;
    collect(shape, wall, holds);
    double deepest = 0;
    std::vector<Vec3d> taken;
    for (const Hold& hold : holds) {
      if (kEnough * hold.way <= asked || hold.way < kShallow * deepest || taken.size() == kMostHolds) break;
      const bool isNear = std::any_of(taken.begin(), taken.end(),
                                      [&](const Vec3d& p) { return norm(p - hold.point) < closest; });
      if (isNear || !isHeldBy(wall, hold.point, hold.from)) continue;
      taken.push_back(hold.point);
      deepest = std::max(deepest, hold.way);
      Contact contact{};
      contact.position = hold.point + wall.normal * (0.5 * hold.way) + origin_;
      contact.normal = wall.normal * -1.0;
      contact.depth = hold.way;
      contact.triangleA = wall.triangle;
      contact.region = contacts.size() > first ? contacts[first].region : 0;
      contact.coherence = 1;
      added.push_back(contact);
    }
  }
  contacts.insert(contacts.end(), added.begin(), added.end());
}

void keepEachDirection(std::vector<Contact>& contacts, std::size_t first, std::size_t most) {
  const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
  const auto isDeeper = [](const Contact& x, const Contact& y) { return x.depth > y.depth; };
  std::stable_sort(begin, contacts.end(), isDeeper);
  if (contacts.size() <= first + most) return;
  std::vector<Contact> leading, rest;
  for (auto it = begin; it != contacts.end(); ++it) {
    const bool known = std::any_of(leading.begin(), leading.end(),
                                   [&](const Contact& c) { return otgDot(c.normal, it->normal) > kSameWay; });
    (known ? rest : leading).push_back(*it);
  }
  leading.insert(leading.end(), rest.begin(), rest.end());
  leading.resize(most);
  std::stable_sort(leading.begin(), leading.end(), isDeeper);
  contacts.resize(first);
  contacts.insert(contacts.end(), leading.begin(), leading.end());
}

}  // namespace otg
