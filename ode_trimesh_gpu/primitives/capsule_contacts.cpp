// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/capsule_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory_resource>

#include "base/insertion_sort.h"
#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "collide/inside_test.h"
#include "collide/surface/same_direction.h"
#include "primitives/round_ahead.h"
#include "queries/local_minimum.h"
#include "queries/surface_side.h"
#include "queries/triangle_distance.h"

namespace otg {
namespace {

constexpr double kAlong = 0.2;     // sine of the angle up to which a face or edge runs along the axis
constexpr double kSameEnd = 0.01;  // of the capsule's length
constexpr double kDeeper = 1.02;
constexpr double kFlatFan = 0.9999985;     // cosine of 0.1 degrees
constexpr std::size_t kPlacesAtHand = 96;  // on the stack; more are rare

/// A point of the surface below a point of the axis.
struct TouchingPlace {
  double distance, at;  ///< `at`: along the axis, from its start
  Vec3d away;           ///< unit, from the axis to the surface
  std::uint32_t triangle;
};

class Finder {
 public:
  Finder(const CollisionMesh& tree, const Capsule& capsule, RoundMemory& before,
         std::pmr::vector<TouchingPlace>& places)
      : tree_(tree),
        mesh_(tree.mesh()),
        kind_(surfaceKind(mesh_)),
        capsule_(capsule),
        before_(before),
        start_(axisPoint(0)),
        length_(2 * capsule.half),
        rounding_(1e-12 * (double{mesh_.radius()} + norm(capsule.middle) + capsule.radius + capsule.half)),
        places_(places) {}

  /// False if the axis meets the surface or lies inside.
  bool run() {
    searchWide(tree_.wide(), BoxQuery(tree_, boxFrame(), boxHalf()), [&](std::uint32_t t) {
      if (!mesh_.isDegenerate(t)) triangle(t);
    });
    if (crosses_ || nearest_.distance <= rounding_) return false;
    if (nearest_.triangle == kNone) {
      // No surface in reach: the capsule is outside or deep within.
      const Vec3f &low = mesh_.boundsMin(), &high = mesh_.boundsMax();
      const Vec3d& c = capsule_.middle;
      return kind_ != SurfaceKind::kSolid || c.x < low.x || c.y < low.y || c.z < low.z || c.x > high.x ||
             c.y > high.y || c.z > high.z || !pointInMesh(tree_, c);
    }
    const Vec3d middle = axisPoint(nearestAt_);
    return !isInside(tree_, middle, nearest_) ||
           isFromBehind(nearest_.point, unit(nearest_.point - middle), nearest_.distance);
  }

 private:
  Vec3d axisPoint(double at) const { return capsule_.middle + capsule_.direction * (at - capsule_.half); }
  /// Any frame whose third axis is the capsule's.
  Transformd boxFrame() const {
    const Vec3d& w = capsule_.direction;
    const Vec3d other = std::fabs(w.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d u = unit(otgCross(other, w)), v = otgCross(w, u);
    return {{u.x, v.x, w.x, u.y, v.y, w.y, u.z, v.z, w.z}, capsule_.middle};
  }
  Vec3d boxHalf() const { return {capsule_.radius, capsule_.radius, capsule_.radius + capsule_.half}; }

  void note(double distance, double at, const Vec3d& on, std::uint32_t triangle, TrianglePart part) {
    if (distance < nearest_.distance || (distance == nearest_.distance && triangle < nearest_.triangle)) {
      nearest_ = {on, distance, triangle, part};
      nearestAt_ = at;
    }
  }

  void triangle(std::uint32_t t) {
    Vec3d p[3];
    cornersOf(mesh_, t, p);
    const Adjacency& adjacency = tree_.adjacency();
    face(t, p, adjacency.normal[t]);
    const Topology& topology = mesh_.topology();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t half = 3 * t + k, edge = topology.edgeOf[half], twin = topology.twin[half];
      if (edge != kNone && (twin == kNone || half < twin))
        alongEdge(half, p[k], p[(k + 1) % 3], adjacency.isFlatEdge(edge));
      const std::uint32_t v = topology.weld[mesh_.triangles()[t].v[k]];
      if (adjacency.first[v] != adjacency.first[v + 1] && adjacency.halfEdges[adjacency.first[v]] == half) {
        corner(half, v, p[k]);
      }
    }
  }

  /// Whether a contact along `away` at an inner point of the axis, or at an end of it, is one of the capsule: there its
  /// surface faces that way.
  bool faces(double at, double alongAxis) const {
    if (std::fabs(alongAxis) <= kAlong) return true;
    const double rounding = 1e-9 * (length_ + capsule_.radius);
    return alongAxis > 0 ? at >= length_ - rounding : at <= rounding;
  }

  bool isFromBehind(const Vec3d& on, const Vec3d& out, double distance) const {
    return kind_ == SurfaceKind::kSheet && before_.isFromBehind(on, out, distance);
  }
  /// Whether the back of the surface counts there.
  bool hasTwoSides(const Vec3d& on, const Vec3d& out, double distance) const {
    return kind_ == SurfaceKind::kShell || isFromBehind(on, out, distance);
  }

  /// Where the axis is above the triangle.
  void face(std::uint32_t t, const Vec3d* p, const Vec3d& n) {
    const double rise = otgDot(n, capsule_.direction), base = otgDot(n, start_ - p[0]);
    const double end = base + rise * length_;
    if (std::min(base, end) > capsule_.radius || std::max(base, end) < -capsule_.radius) return;
    double low = 0, high = length_;
    for (int k = 0; k < 3; ++k) {
      const Vec3d inward = otgCross(n, p[(k + 1) % 3] - p[k]);
      const double from = otgDot(inward, start_ - p[k]), speed = otgDot(inward, capsule_.direction);
      if (speed > 0) {
        low = std::max(low, -from / speed);
      } else if (speed < 0) {
        high = std::min(high, -from / speed);
      } else if (from < 0) {
        return;
      }
    }
    if (!(low <= high)) return;
    const double first = base + rise * low, last = base + rise * high;
    if (first * last <= 0) {
      crosses_ = true;
      return;
    }
    const double side = first > 0 ? 1 : -1;
    for (const double at : {low, high}) {
      const double height = side * (base + rise * at);
      if (height >= capsule_.radius) continue;
      note(height, at, axisPoint(at) - n * (side * height), t, TrianglePart::kFace);
      const Vec3d away = n * -side;
      if (side < 0 && !hasTwoSides(axisPoint(at) + away * height, away, height)) continue;
      if (faces(at, otgDot(away, capsule_.direction))) places_.push_back({height, at, away, t});
    }
  }

  void alongEdge(std::uint32_t half, const Vec3d& a, const Vec3d& b, bool isFlat) {
    const PointPair nearest = closestOnSegments(start_, axisPoint(length_), a, b);
    if (nearest.distance2 >= capsule_.radius * capsule_.radius) return;
    const double at = otgDot(nearest.a - start_, capsule_.direction);
    const TrianglePart part = nearest.b == a   ? partOf(TrianglePart::kCorner0, half)
                              : nearest.b == b ? partOf(TrianglePart::kCorner0, half + 1)
                                               : partOf(TrianglePart::kEdge0, half);
    note(std::sqrt(nearest.distance2), at, nearest.b, half / 3, part);
    // Of nearly flat edges, too: between the two faces' own ranges is a gap.
    if (nearest.b != a && nearest.b != b) offerEdge(half, at, nearest.b);
    if (isFlat) return;
    const Vec3d d = b - a;
    const double dd = otgDot(d, d), speed = otgDot(d, capsule_.direction);
    if (speed * speed < dd * (1 - kAlong * kAlong)) return;
    // It runs along the axis: the ends of what they have in common.
    const double atA = otgDot(a - start_, capsule_.direction), atB = atA + speed;
    for (const double end : {std::clamp(atA, 0.0, length_), std::clamp(atB, 0.0, length_)}) {
      const double s = std::clamp(otgDot(axisPoint(end) - a, d) / dd, 0.0, 1.0);
      const Vec3d on = a + d * s, toAxis = axisPoint(end) - on;
      // Square to the axis it leans along the edge as the edge does along the axis; more is past the edge's own end,
      // where the corner is what counts.
      const double along = otgDot(toAxis, d), lean = std::max(0.0, dd - speed * speed) + 1e-9 * dd;
      if (along * along > lean * otgDot(toAxis, toAxis)) continue;
      const Vec3d across = toAxis - d * (along / dd);
      if (isMinimumOfEdge(tree_, half, on, across, rounding_)) offer(half, TrianglePart::kEdge0, end, toAxis);
    }
  }

  void offerEdge(std::uint32_t half, double at, const Vec3d& on) {
    const Vec3d toAxis = axisPoint(at) - on;
    if (isMinimumOfEdge(tree_, half, on, toAxis, rounding_)) offer(half, TrianglePart::kEdge0, at, toAxis);
  }

  void corner(std::uint32_t half, std::uint32_t vertex, const Vec3d& on) {
    const double at = std::clamp(otgDot(on - start_, capsule_.direction), 0.0, length_);
    const Vec3d toAxis = axisPoint(at) - on;
    if (otgDot(toAxis, toAxis) >= capsule_.radius * capsule_.radius) return;
    if (isMinimumOfVertex(tree_, vertex, toAxis, rounding_)) offer(half, TrianglePart::kCorner0, at, toAxis);
  }

  /// A half-edge, or the corner that it leaves.
  void offer(std::uint32_t half, TrianglePart first, double at, const Vec3d& toAxis) {
    const double distance = norm(toAxis);
    if (!(distance > 0) || distance >= capsule_.radius) return;
    const Vec3d away = toAxis * (-1 / distance);
    if (!faces(at, otgDot(away, capsule_.direction))) return;
    // Seen from behind: through a thin wall, or past a rim.
    const SurfacePoint on{axisPoint(at) - toAxis, distance, half / 3, partOf(first, half)};
    if (otgDot(away, outwardNormal(tree_, on)) > 0 && !hasTwoSides(on.point, away, distance)) return;
    places_.push_back({distance, at, away, half / 3});
  }

  static TrianglePart partOf(TrianglePart first, std::uint32_t half) {
    return static_cast<TrianglePart>(static_cast<std::uint32_t>(first) + half % 3);
  }

  const CollisionMesh& tree_;
  const TriMesh& mesh_;
  const SurfaceKind kind_;
  const Capsule& capsule_;
  RoundMemory& before_;
  const Vec3d start_;
  const double length_, rounding_;
  std::pmr::vector<TouchingPlace>& places_;
  bool crosses_ = false;
  SurfacePoint nearest_;
  double nearestAt_ = 0;
};

/// Of places with nearly the same normal the deepest and the two outermost.
void keepOutermost(const Capsule& capsule, std::pmr::vector<TouchingPlace>& places, std::vector<Contact>& out) {
  std::sort(places.begin(), places.end(), [](const TouchingPlace& x, const TouchingPlace& y) {
    if (x.distance != y.distance) return x.distance < y.distance;
    return x.at != y.at ? x.at < y.at : x.triangle < y.triangle;
  });
  const double apart = kSameEnd * 2 * (capsule.half + capsule.radius);
  const std::size_t first = out.size();
  std::uint32_t number = 0;
  for (auto begin = places.begin(); begin != places.end(); ++number) {
    // The deepest's own normal, which takes no other place.
    const Vec3d away = begin->away;
    const auto end = partitionInOrder(begin, places.end(),
                                      [&](const TouchingPlace& p) { return otgDot(p.away, away) > kSameDirection; });
    const auto [low, high] =
        std::minmax_element(begin, end, [](const TouchingPlace& x, const TouchingPlace& y) { return x.at < y.at; });
    const auto add = [&](const TouchingPlace& p) {
      const double depth = capsule.radius - p.distance;
      const Vec3d on = capsule.middle + capsule.direction * (p.at - capsule.half);
      Contact contact{
          on + p.away * (p.distance + 0.5 * depth), p.away, depth, p.triangle, kNone, number, ContactFeature::kFaceA};
      contact.coherence = 1;
      out.push_back(contact);
    };
    const bool isLowApart = begin->at - low->at > apart, isHighApart = high->at - begin->at > apart;
    // Between ends that are as deep and have its normal the deepest holds nothing.
    const double outer = capsule.radius - std::min(low->distance, high->distance);
    const bool isBetween = isLowApart && isHighApart && capsule.radius - begin->distance <= kDeeper * outer &&
                           otgDot(begin->away, low->away) > kFlatFan && otgDot(begin->away, high->away) > kFlatFan;
    if (!isBetween) add(*begin);
    if (isLowApart) add(*low);
    if (isHighApart) add(*high);
    begin = end;
  }
  insertionSort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                [](const Contact& x, const Contact& y) { return x.depth > y.depth; });
}

bool addTouched(const CollisionMesh& tree, const Capsule& capsule, RoundMemory& before, std::vector<Contact>& out) {
  std::byte buffer[kPlacesAtHand * sizeof(TouchingPlace)];
  std::pmr::monotonic_buffer_resource memory(buffer, sizeof buffer);
  std::pmr::vector<TouchingPlace> places(&memory);
  places.reserve(kPlacesAtHand - 1);
  if (!Finder(tree, capsule, before, places).run()) return false;
  keepOutermost(capsule, places, out);
  return true;
}

}  // namespace

bool capsuleContacts(const CollisionMesh& tree, const Capsule& capsule, RoundMemory& before,
                     std::vector<Contact>& out) {
  const std::size_t first = out.size();
  if (!addTouched(tree, capsule, before, out)) return false;
  addWallsAhead(tree, 0.5, out, first, [&](const Vec3d& way) {
    Capsule moved = capsule;
    moved.middle = moved.middle - way;
    addTouched(tree, moved, before, out);
  });
  return true;
}

}  // namespace otg
