// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/region_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/insertion_sort.h"
#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/shortest_translation.h"
#include "collide/surface/same_direction.h"
#include "queries/closest_point.h"

namespace otg {
namespace {

constexpr std::size_t kMostWalls = 64;
constexpr double kSamePlane = 1 - 1e-12;
// Cosines between a contact's way out and the normals of what it leaves. The faces of a spike see its tip's way
// edge-on.
constexpr double kFacing = 0.5, kEdgeOn = 0.05;
constexpr double kLeft = 0.005;               // of a way: so little is not worth one more contact
constexpr double kTie = 1e-7, kStep = 1e-12;  // differences of lengths and places that rounding makes
constexpr int kMostRounds = 3;
constexpr double kShallow = 0.5;       // of a wall's deepest: points that are less deep hold little
constexpr std::size_t kMostHolds = 4;  // of a wall
constexpr double kInDoubt = 0.5;  // of a contact's depth: where a wall is left after less, the contact may be wrong
constexpr double kInside = 1e-3;  // of an edge's stretch: from its crossing, so as not to be on the surface
constexpr double kNearest = 0.1;  // of a way out: with a surface nearer than that, another wall is left
constexpr double kPast = 1e-3;    // of a way out: so far past it a point is outside

/// Which of two places comes first, alike for every numbering of the mesh: by coordinates in steps, to which rounding
/// does not matter but for places that are a step's end by chance.
bool isBefore(const Vec3d& a, const Vec3d& b, double step) {
  const auto stepOf = [&](double x) { return std::floor(x / step + 0.37); };
  const double x = stepOf(a.x) - stepOf(b.x), y = stepOf(a.y) - stepOf(b.y);
  return x != 0 ? x < 0 : y != 0 ? y < 0 : stepOf(a.z) < stepOf(b.z);
}

/// The shortest translation of the shape that satisfies all contacts; none where they leave no way.
std::optional<Vec3d> shortestMove(std::span<const Contact> contacts, std::pmr::memory_resource* memory) {
  ShortestTranslation t(memory);
  for (const Contact& c : contacts) {
    if (!t.add(c.normal * -1.0, c.depth)) return {};
  }
  return t.value();
}

/// Adds a contact in place of those of its direction that are next to it and no deeper.
void replace(std::vector<Contact>& contacts, std::size_t first, const Contact& added, double closest) {
  const auto isReplaced = [&](const Contact& c) {
    return c.depth <= added.depth && otgDot(c.normal, added.normal) > kSameDirection &&
           norm(c.position - added.position) < closest;
  };
  contacts.erase(std::remove_if(contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(), isReplaced),
                 contacts.end());
  contacts.push_back(added);
}

}  // namespace

/// How far a point lies beside the bounds.
double RegionWalls::Bounds::beside(const Vec3d& p) const {
  const Vec3d out{std::max({low.x - p.x, 0.0, p.x - high.x}), std::max({low.y - p.y, 0.0, p.y - high.y}),
                  std::max({low.z - p.z, 0.0, p.z - high.z})};
  return norm(out);
}

bool RegionWalls::read(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                       const PlacedShape& shape, std::span<const std::uint32_t> triangles, bool isConvex) {
  meshes_ = &meshes;
  origin_ = all.origin;
  walls_.clear();
  points_.clear();
  onMesh_.clear();
  const double reach = double{meshes.mesh(0).radius()} + meshes.mesh(1).radius();
  rounding_ = 1e-13 * reach;
  onPlane_ = 4e-10 * reach;
  far_ = 4 * reach;
  region_ = {region.lo, region.hi};
  walls_.reserve(std::min<std::size_t>(kMostWalls, region.pieceEnd - region.pieceBegin));
  std::uint32_t named = kNone;
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    if (p.mesh != 0) continue;
    if (named == kNone) named = p.triangle;
    if (!add({p.normal, p.offset, {p.lo, p.hi}, p.triangle, !isConvex})) return false;
  }
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    if (all.pieces[i].mesh == 0) addInnerNeighbours(shape, all.pieces[i].triangle, all.pieces[i].triangle);
  }
  for (const std::uint32_t t : triangles) addInnerNeighbours(shape, t, named);
  if (std::none_of(walls_.begin(), walls_.end(), [](const Wall& w) { return w.counts; })) return false;
  vertices_.clear();
  points_.reserve(region.pointEnd - region.pointBegin);
  onMesh_.reserve(region.pointEnd - region.pointBegin);
  if (!shape.shape().isCurved()) {
    vertices_.reserve(shape.shape().vertices.size());
    for (const Vec3d& v : shape.shape().vertices) vertices_.push_back(shape.fromLocal(v));
  }
  const Vec3d middle = (region.lo + region.hi) * 0.5;
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const SupportPoint& p = all.points[i];
    if (p.mesh == 0 && p.kind != PointKind::kCrossing && !p.flat)
      onMesh_.push_back({p.position, p.position, {}, p.triangleA == kNone ? named : p.triangleA});
    if (shape.shape().isCurved()) {
      if (p.kind != PointKind::kMiddleOfContour)
        points_.push_back({p.position + (middle - p.position) * kInside, p.position, {}, named});
    } else if (p.kind == PointKind::kCrossing && p.mesh == 1) {
      points_.push_back({p.position + p.along * (kInside * p.reach), p.position, p.along * p.reach, named});
    }
  }
  return true;
}

bool RegionWalls::add(const Wall& wall) {
  const auto known = std::find_if(walls_.begin(), walls_.end(), [&](const Wall& w) {
    return otgDot(w.normal, wall.normal) > kSamePlane && std::fabs(w.offset - wall.offset) <= rounding_;
  });
  if (known == walls_.end()) {
    if (walls_.size() == kMostWalls) return false;
    walls_.push_back(wall);
    return true;
  }
  known->bounds.low = {std::min(known->bounds.low.x, wall.bounds.low.x),
                       std::min(known->bounds.low.y, wall.bounds.low.y),
                       std::min(known->bounds.low.z, wall.bounds.low.z)};
  known->bounds.high = {std::max(known->bounds.high.x, wall.bounds.high.x),
                        std::max(known->bounds.high.y, wall.bounds.high.y),
                        std::max(known->bounds.high.z, wall.bounds.high.z)};
  return true;
}

/// What meets a triangle at an inner edge may be in the shape below the triangle only, where the region has no piece of
/// it. Or it comes to be in it when the shape leaves the triangle. Contacts of it name a triangle that the shape
/// touches.
void RegionWalls::addInnerNeighbours(const PlacedShape& shape, std::uint32_t triangle, std::uint32_t named) {
  const TriMesh& mesh = meshes_->mesh(0);
  const Vec3d& n = meshes_->adjacency(0).normal[triangle];
  Vec3d p[3];
  for (std::size_t k = 0; k < 3; ++k) p[k] = meshes_->vertex(0, mesh.triangles()[triangle].v[k]) - origin_;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t twin = mesh.topology().twin[3 * triangle + k];
    if (twin == kNone) continue;
    const Vec3d& other = meshes_->adjacency(0).normal[twin / 3];
    const double cosine = otgDot(n, other);
    if (cosine > kSameDirection || otgDot(otgCross(n, other), p[(k + 1) % 3] - p[k]) >= 0) continue;
    const double offset = otgDot(other, p[k]), way = otgDot(n, p[k]) - shape.rearAlong(n);
    if (shape.rearAlong(other) >= offset + std::max(0.0, -cosine * way)) continue;
    Vec3d low = p[k], high = p[k];
    for (const std::uint32_t v : mesh.triangles()[twin / 3].v) {
      const Vec3d q = meshes_->vertex(0, v) - origin_;
      low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
      high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
    }
    add({other, offset, {low, high}, named, true});
  }
}

bool RegionWalls::isOn(const Wall& wall, const Vec3d& point) const {
  return std::fabs(wall.wayOut(point)) <= onPlane_;
}

/// Whether the point has to leave the wall: it is inside the mesh still when it has left those that it is out of
/// sooner.
bool RegionWalls::isHeldBy(const Wall& wall, const Vec3d& point, double moved, const Inside* from) const {
  const double last = wall.wayOut(point), near = 2 * (last + moved);
  if (wall.bounds.beside(point + wall.normal * last) > near) return false;
  std::pmr::vector<std::pair<double, const Wall*>> sooner(memory_);
  for (const Wall& w : walls_) {
    if (&w == &wall) continue;
    const double way = w.wayOut(point);
    if (from && isOn(w, from->crossing)) {
      // The end of a body through which the edge comes in: the edge is held by walls that are nearer than its own end.
      if (std::fabs(otgDot(w.normal, from->stretch)) < last) return false;
    } else if (way > -onPlane_ && way < last) {
      sooner.emplace_back(way, &w);
    }
  }
  std::sort(sooner.begin(), sooner.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  Vec3d p = point;
  for (const auto& [unused, w] : sooner) {
    const double ahead = w->wayOut(p), way = ahead > onPlane_ ? ahead : 0, past = onPlane_ + kPast * way;
    if (w->bounds.beside(p + w->normal * way) > near) continue;
    const double exit = exitDistance(*meshes_, 0, p + origin_, w->normal, far_, 0);
    if (exit < way - past && way > 0) continue;  // the plane belongs to another part of the surface
    if (exit < way + past) return false;
    p = p + w->normal * (way + past);
  }
  const double way = wall.wayOut(p);
  return way > 0 && wall.bounds.beside(p + wall.normal * way) <= near &&
         exitDistance(*meshes_, 0, p + origin_, wall.normal, far_, 0) >= way * (1 - kPast) &&
         closestPoint(meshes_->tree(0), p + origin_, kNearest * way).triangle == kNone;
}

/// Points of the shape that are in the wall still after the move, the deepest first.
void RegionWalls::collect(const PlacedShape& shape, const Wall& wall, const Vec3d& move,
                          std::pmr::vector<Hold>& out) const {
  out.clear();
  const double asked = otgDot(wall.normal, move), near = 2 * norm(move);
  const auto add = [&](const Vec3d& p, const Inside* from) {
    const double way = wall.wayOut(p), left = way - asked;
    if (left <= rounding_ + kLeft * std::fabs(way)) return;
    if (wall.bounds.beside(p + move + wall.normal * left) <= near + 2 * left) out.push_back({p, way, far_, from});
  };
  if (shape.shape().isCurved()) {
    add(shape.rear(wall.normal), nullptr);
    if (shape.standsOnPoint(wall.normal)) return;
    // Where the surface of the wall is in the shape; or anywhere, if the shape is in it below another wall only.
    const bool isThere =
        std::any_of(points_.begin(), points_.end(), [&](const Inside& p) { return isOn(wall, p.crossing); });
    const PlacedShape::Rear rear(shape, wall.normal);
    for (const Inside& p : points_) {
      if (!isThere || isOn(wall, p.crossing)) add(rear.near(p.point), nullptr);
    }
  } else {
    // Those that are in another region, or in none, are not held here.
    for (const Vec3d& v : vertices_) {
      if (region_.beside(v) <= near + onPlane_) add(v, nullptr);
    }
    for (const Inside& p : points_) {
      if (!isOn(wall, p.crossing)) add(p.point, &p);
    }
  }
  double deepest = 0;
  for (const Hold& h : out) deepest = std::max(deepest, std::fabs(h.way));
  const auto stepOf = [&](const Hold& h) { return std::floor(h.way / (kTie * deepest + rounding_) + 0.37); };
  std::sort(out.begin(), out.end(), [&](const Hold& x, const Hold& y) {
    const double a = stepOf(x), b = stepOf(y);
    return a != b ? a > b : isBefore(x.point + origin_, y.point + origin_, kStep * far_);
  });
}

/// Holds the wall at the deepest of the shape's points in it and at those farthest from each other.
bool RegionWalls::hold(const PlacedShape& shape, const Wall& wall, const Vec3d& move, double closest,
                       std::vector<Contact>& contacts, std::size_t first) const {
  std::pmr::vector<Hold> holds(memory_);
  collect(shape, wall, move, holds);
  double deepest = 0;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < holds.size() && taken < kMostHolds; ++i) {
    const auto begin = holds.begin() + static_cast<std::ptrdiff_t>(i);
    const auto isNearer = [&](const Hold& x, const Hold& y) { return x.apart * (1 + kTie) < y.apart; };
    // Keeps the others in order: ties go to those that are deeper, or first by place.
    if (taken > 0) {
      const auto farthest = std::max_element(begin, holds.end(), isNearer);
      std::rotate(begin, farthest, farthest + 1);
    }
    const Hold h = *begin;
    if (h.apart < closest || h.way < kShallow * deepest) continue;
    if (!isHeldBy(wall, h.point + move, norm(move), h.from)) continue;
    ++taken;
    deepest = std::max(deepest, h.way);
    for (Hold& other : holds) other.apart = std::min(other.apart, norm(other.point - h.point));
    Contact contact{};
    contact.position = h.point + wall.normal * (0.5 * h.way) + origin_;
    contact.normal = wall.normal * -1.0;
    contact.depth = std::max(h.way, 0.0);
    contact.triangleA = wall.triangle;
    contact.region = contacts.size() > first ? contacts[first].region : 0;
    contact.coherence = 1;
    replace(contacts, first, contact, closest);
  }
  return taken > 0;
}

/// The walls that count, in an order that is alike for every numbering of the mesh, and how deep the shape is in each.
void RegionWalls::sortWalls(const PlacedShape& shape) {
  sorted_.clear();
  sorted_.reserve(walls_.size());
  for (const Wall& wall : walls_) {
    if (wall.counts) sorted_.push_back({&wall, wall.offset - shape.rearAlong(wall.normal), kNeverTried});
  }
  std::sort(sorted_.begin(), sorted_.end(), [](const SortedWall& x, const SortedWall& y) {
    if (isBefore(x.wall->normal, y.wall->normal, kTie)) return true;
    return !isBefore(y.wall->normal, x.wall->normal, kTie) && x.wall->offset < y.wall->offset;
  });
}

/// Whether the shape may be in the wall after the move.
bool RegionWalls::isUnmet(const SortedWall& sorted, const Vec3d& move) const {
  return sorted.depth - otgDot(sorted.wall->normal, move) > rounding_ + kLeft * std::fabs(sorted.depth);
}

/// Points of the mesh that are in the shape after the move.
std::pmr::vector<const RegionWalls::Inside*> RegionWalls::unmetPoints(const PlacedShape& shape,
                                                                      const Vec3d& move) const {
  std::pmr::vector<const Inside*> unmet(memory_);
  for (const Inside& at : onMesh_) {
    if (shape.exitDistance(at.crossing - move, {0, 0, 1}) >= 0) unmet.push_back(&at);
  }
  std::sort(unmet.begin(), unmet.end(), [&](const Inside* x, const Inside* y) {
    return isBefore(x->crossing + origin_, y->crossing + origin_, kStep * far_);
  });
  return unmet;
}

void RegionWalls::complete(const PlacedShape& shape, double closest, std::vector<Contact>& contacts,
                           std::size_t first) {
  std::optional<Vec3d> move = shortestMove(std::span(contacts).subspan(first), memory_);
  sortWalls(shape);
  int moves = 0;  // so many there have been before this one
  std::pmr::vector<SortedWall*> unmet(memory_);
  unmet.reserve(sorted_.size());
  // A way that one wall requests may lead into another.
  for (int round = 0; move && round < kMostRounds; ++round) {
    bool isDone = true;
    unmet.clear();
    for (SortedWall& sorted : sorted_) {
      if (isUnmet(sorted, *move)) unmet.push_back(&sorted);
    }
    for (SortedWall* const sorted : unmet) {
      if (sorted->triedAt == moves) continue;  // and could not be held
      sorted->triedAt = moves;
      if (!hold(shape, *sorted->wall, *move, closest, contacts, first)) continue;
      isDone = false;
      ++moves;
      move = shortestMove(std::span(contacts).subspan(first), memory_);
      if (!move) return;
    }
    for (const Inside* at : unmetPoints(shape, *move)) {
      if (!holdPoint(shape, *at, *move, closest, contacts, first)) continue;
      isDone = false;
      ++moves;
      move = shortestMove(std::span(contacts).subspan(first), memory_);
      if (!move) return;
    }
    if (isDone) return;
  }
}

/// How far a point in the shape is from the shape's surface.
double RegionWalls::depthIn(const PlacedShape& shape, const Vec3d& point) {
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vec3d& d) { least = std::min(least, shape.exitDistance(point, d)); };
  for (const Vec3d& n : shape.shape().faceNormals) offer(shape.direction(n));
  if (shape.shape().isCurved()) offer(wayToRoundSide(shape, point) * -1.0);
  return least;
}

/// Ways along which a point of the mesh may be left: normals of the walls that it is on, and at an edge between two of
/// them those in which the shape's own surface is nearest.
void RegionWalls::waysAt(const PlacedShape& shape, const Vec3d& point, std::pmr::vector<Vec3d>& out) const {
  out.clear();
  for (const Wall& wall : walls_) {
    if (isOn(wall, point)) out.push_back(wall.normal);
  }
  const std::size_t faces = out.size();
  const auto offerBetween = [&](const Vec3d& d) {
    for (std::size_t i = 0; i < faces; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Vec3d along = otgCross(out[i], out[k]);
        const double nn = otgDot(along, along);
        if (!(nn > 1e-6)) continue;
        const Vec3d across = d - along * (otgDot(along, d) / nn);
        const bool isBetween =
            otgDot(otgCross(out[i], across), along) > 0 && otgDot(otgCross(across, out[k]), along) > 0;
        if (isBetween && otgDot(across, across) > 0.5) out.push_back(unit(across));
      }
    }
  };
  if (shape.shape().isCurved()) offerBetween(wayToRoundSide(shape, point));
  for (const Vec3d& n : shape.shape().faceNormals) offerBetween(shape.direction(n) * -1.0);
}

/// Holds a point of the mesh, if it is in the shape after the move still, along the shortest of its ways.
bool RegionWalls::holdPoint(const PlacedShape& shape, const Inside& at, const Vec3d& move, double closest,
                            std::vector<Contact>& contacts, std::size_t first) const {
  const Vec3d &point = at.crossing, left = point - move;
  if (!(shape.exitDistance(left, {0, 0, 1}) >= 0)) return false;
  std::pmr::vector<Vec3d> ways(memory_);
  waysAt(shape, point, ways);
  Contact contact{};
  double least = far_;
  for (const Vec3d& d : ways) {
    const double way = shape.exitDistance(left, d * -1.0);
    if (way >= least) continue;
    least = way;
    contact.normal = d * -1.0;
    contact.depth = shape.exitDistance(point, d * -1.0);
  }
  if (least == far_ || least <= rounding_ + kLeft * contact.depth) return false;
  if (depthIn(shape, left) < kNearest * least) return false;  // it is left over a face of which the region has no piece
  contact.position = point + contact.normal * (0.5 * contact.depth) + origin_;
  contact.triangleA = at.triangle;
  contact.region = contacts.size() > first ? contacts[first].region : 0;
  contact.coherence = 1;
  replace(contacts, first, contact, closest);
  return true;
}

/// Whether the point is out of the mesh after much less than the contact requests, or there is nothing to leave.
bool RegionWalls::isInDoubt(const Contact& contact, const Vec3d& point) const {
  bool isBehind = false;
  for (const Wall& wall : walls_) {
    const double way = wall.wayOut(point), cosine = -otgDot(wall.normal, contact.normal);
    if (way >= -onPlane_ && way < kInDoubt * contact.depth &&
        wall.bounds.beside(point + wall.normal * way) <= std::max(way, onPlane_))
      return true;
    isBehind = isBehind || (cosine > kEdgeOn && way >= kInDoubt * contact.depth * cosine &&
                            wall.bounds.beside(point + wall.normal * way) <= way);
  }
  return !isBehind;
}

bool RegionWalls::limitDepths(const PlacedShape& shape, std::vector<Contact>& contacts, std::size_t first) const {
  std::pmr::vector<std::pair<double, const Wall*>> ahead(memory_);
  const auto isVoid = [&](Contact& c) {
    const Vec3d point = c.position + c.normal * (0.5 * c.depth) - origin_;  // of the shape
    if ((shape.shape().isCurved() && isOfA(c.feature)) || !isInDoubt(c, point)) return false;
    ahead.clear();
    for (const double facing : {kFacing, kEdgeOn}) {
      if (!ahead.empty()) break;
      for (const Wall& wall : walls_) {
        const double cosine = -otgDot(wall.normal, c.normal);
        if (cosine > facing) ahead.emplace_back(wall.wayOut(point) / cosine, &wall);
      }
    }
    std::sort(ahead.begin(), ahead.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
    while (!ahead.empty() && !(ahead.back().first > rounding_)) ahead.pop_back();
    // Of a stair the next step's top faces the same way, and is not what the point is below.
    const auto farthest =
        std::find_if(ahead.begin(), ahead.end(), [&](const auto& w) { return isHeldBy(*w.second, point, 0, nullptr); });
    if (farthest == ahead.end()) return true;
    const double most = farthest->first;
    if (c.depth <= most) return false;
    c.position = c.position + c.normal * (0.5 * (c.depth - most));
    c.depth = most;
    return false;
  };
  const auto kept = std::remove_if(contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(), isVoid);
  const bool any = kept != contacts.end();
  contacts.erase(kept, contacts.end());
  return any;
}

void keepEachDirection(std::vector<Contact>& contacts, std::size_t first, std::size_t most,
                       std::pmr::memory_resource* memory) {
  const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
  const auto isDeeper = [](const Contact& x, const Contact& y) { return x.depth > y.depth; };
  insertionSort(begin, contacts.end(), isDeeper);
  if (contacts.size() <= first + most) return;
  std::pmr::vector<Contact> leading(memory), rest(memory);
  for (auto it = begin; it != contacts.end(); ++it) {
    const bool known = std::any_of(leading.begin(), leading.end(),
                                   [&](const Contact& c) { return otgDot(c.normal, it->normal) > kSameDirection; });
    (known ? rest : leading).push_back(*it);
  }
  leading.insert(leading.end(), rest.begin(), rest.end());
  leading.resize(most);
  insertionSort(leading.begin(), leading.end(), isDeeper);
  contacts.resize(first);
  contacts.insert(contacts.end(), leading.begin(), leading.end());
}

}  // namespace otg
