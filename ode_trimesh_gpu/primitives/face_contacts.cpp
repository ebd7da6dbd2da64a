// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/face_contacts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "collide/convex/convex_places.h"
#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/shortest_translation.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "primitives/convex_patch.h"
#include "primitives/cylinder_contacts.h"
#include "primitives/same_direction.h"

namespace otg {
namespace {

constexpr std::size_t kMostFaces = 4, kMostTriangles = 48;
constexpr double kAhead = 0.05;  ///< of the shape's radius: how far around it is looked for what is in the way
constexpr double kSinglePrecision = 4e-7;  ///< of the mesh's reach: single precision, in which its vertices are
constexpr double kTouched = 1e-13;         ///< of the size and the distances

/// A point well inside. The middle of its box may be outside of a convex.
Vec3d insideOf(const ConvexShape& shape) {
  Vec3d sum{0, 0, 0};
  for (const Vec3d& v : shape.vertices) sum = sum + v;
  return shape.vertices.empty() ? sum : sum * (1.0 / static_cast<double>(shape.vertices.size()));
}

class FaceSolver {
 public:
  FaceSolver(const Query& query, const ConvexShape& shape, Workspace& workspace)
      : query_(query),
        shape_(shape),
        workspace_(workspace),
        mesh_(query.a->mesh()),
        links_(query.a->adjacency()),
        placed_(shape, query.bInA, {0, 0, 0}) {
    const Vec3f &low = shape.mesh->mesh().boundsMin(), &high = shape.mesh->mesh().boundsMax();
    const Vec3d middle{0.5 * (double{low.x} + high.x), 0.5 * (double{low.y} + high.y), 0.5 * (double{low.z} + high.z)};
    frame_ = query.bInA;
    frame_.t = otgTransform(frame_, middle);
    inside_ = otgTransform(query.bInA, insideOf(shape));
    half_ = {high.x - middle.x, high.y - middle.y, high.z - middle.z};
    radius_ = norm(half_);
    reach_ =
        double{mesh_.radius()} + norm(frame_.t - Vec3d{mesh_.center().x, mesh_.center().y, mesh_.center().z}) + radius_;
    const Vec3f &a = mesh_.boundsMin(), &b = mesh_.boundsMax();
    flat_ = kSinglePrecision *
            std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z), std::fabs(b.x), std::fabs(b.y), std::fabs(b.z)});
  }

  bool run() {
    ahead_ = isCornered(query_.a) ? kAhead * radius_ : 0;
    if (!collect() || faceCount_ == 0) return false;
    for (std::size_t f = 0; f < faceCount_; ++f) {
      if (!measure(faces_[f])) return false;
    }
    if (!endAtInnerEdges()) return false;
    ShortestTranslation way;
    for (std::size_t f = 0; f < faceCount_; ++f) {
      if (faces_[f].isTouched && !way.add(faces_[f].normal, faces_[f].depth)) return false;
    }
    if (!isFree(way.value())) return false;
    std::uint32_t region = 0;
    for (std::size_t f = 0; f < faceCount_; ++f) {
      if (faces_[f].isTouched) emit(static_cast<std::uint32_t>(f), region++);
    }
    return !workspace_.contacts.empty();
  }

 private:
  /// Triangles that lie in one plane.
  struct Face {
    Vec3d normal;
    double offset, area;  ///< of the largest triangle
    double depth;         ///< of the shape's deepest point
    bool isTouched;
  };
  struct Touched {
    std::uint32_t triangle;
    std::uint32_t face;
  };
  /// Of a triangle beside the shape.
  struct Beside {
    Vec3d normal;
    double offset;
  };

  Vec3d vertex(std::uint32_t triangle, std::size_t k) const {
    const Vec3f& v = mesh_.vertices()[mesh_.triangles()[triangle].v[k]];
    return {v.x, v.y, v.z};
  }

  /// Triangles whose planes cut the shape, by faces, and those that are in front of it. False if they are too many.
  bool collect() {
    bool isFew = true;
    const BoxQuery box(*query_.a, frame_, half_ + Vec3d{ahead_, ahead_, ahead_});
    searchWide(query_.a->wide(), box, [&](std::uint32_t t) { isFew = isFew && add(t); });
    if (!isFew) return false;
    // Ascending, so that no plane and no triangle of a contact depends on the tree.
    Touched *const begin = touched_.data(), *const end = begin + count_;
    std::sort(begin, end, [](const Touched& x, const Touched& y) { return x.triangle < y.triangle; });
    return std::all_of(begin, end, [&](Touched& of) { return findFace(of); });
  }

  bool add(std::uint32_t t) {
    if (mesh_.isDegenerate(t)) return true;
    const Vec3d& n = links_.normal[t];
    const double offset = otgDot(n, vertex(t, 0));
    if (placed_.rearAlong(n) > offset) {
      if (ahead_ > 0) {
        if (besideCount_ == kMostTriangles) return false;
        beside_[besideCount_++] = {n, offset};
      }
      return true;
    }
    if (-placed_.rearAlong(n * -1.0) < offset) return true;  // all of the shape is behind it
    if (count_ == kMostTriangles) return false;
    touched_[count_++] = {t, kNone};
    return true;
  }

  /// False if there are too many.
  bool findFace(Touched& of) {
    const std::uint32_t t = of.triangle;
    const Vec3d& n = links_.normal[t];
    const double offset = otgDot(n, vertex(t, 0)), area = links_.area[t];
    of.face = faceOf(t, n);
    if (of.face == kNone) {
      if (faceCount_ == kMostFaces) return false;
      of.face = static_cast<std::uint32_t>(faceCount_);
      faces_[faceCount_++] = {n, offset, area, 0, false};
    } else if (area > faces_[of.face].area) {
      faces_[of.face] = {n, offset, area, 0, false};
    }
    return true;
  }

  std::uint32_t faceOf(std::uint32_t t, const Vec3d& n) const {
    for (std::size_t f = 0; f < faceCount_; ++f) {
      const Face& face = faces_[f];
      if (otgDot(face.normal, n) < kFlatEdge) continue;
      const auto isIn = [&](std::size_t k) {
        return std::fabs(otgDot(face.normal, vertex(t, k)) - face.offset) <= flat_;
      };
      if (isIn(0) && isIn(1) && isIn(2)) return static_cast<std::uint32_t>(f);
    }
    return kNone;
  }

  /// The depth, and whether the face is at a place where its plane cuts the shape. Elsewhere it may be, too, if it ends
  /// within the shape. False if the shape is as much behind the face as in front of it, or touches it to rounding.
  bool measure(Face& face) {
    const Vec3d deepest = placed_.rear(face.normal);
    face.depth = face.offset - otgDot(face.normal, deepest);
    const double height = otgDot(face.normal, inside_) - face.offset;
    if (!(height > 0) || face.depth <= kTouched * (reach_ + norm(query_.bInA.t))) return false;
    const Vec3d within = deepest + (inside_ - deepest) * (face.depth / (face.depth + height));
    face.isTouched = triangleBelow(face, within, false) != kNone;
    return true;
  }

  /// The triangle of a face below a point; where there is none, the nearest by its middle, or none.
  std::uint32_t triangleBelow(const Face& face, const Vec3d& p, bool orNearest) const {
    std::uint32_t nearest = kNone;
    double least = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      if (&faces_[touched_[i].face] != &face) continue;
      const Vec3d c[3] = {vertex(touched_[i].triangle, 0), vertex(touched_[i].triangle, 1),
                          vertex(touched_[i].triangle, 2)};
      bool isOver = true;
      for (std::size_t k = 0; k < 3; ++k) {
        isOver = isOver && otgDot(otgCross(c[(k + 1) % 3] - c[k], p - c[k]), face.normal) >= 0;
      }
      if (isOver) return touched_[i].triangle;
      const Vec3d apart = p - (c[0] + c[1] + c[2]) * (1.0 / 3);
      if (!orNearest || (nearest != kNone && otgDot(apart, apart) >= least)) continue;
      nearest = touched_[i].triangle;
      least = otgDot(apart, apart);
    }
    return nearest;
  }

  /// Whether faces end within the shape at inner edges only, where another one goes on. Marks those as touched.
  bool endAtInnerEdges() {
    const Touched *const begin = touched_.data(), *const end = begin + count_;
    for (const Touched* of = begin; of != end; ++of) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t twin = mesh_.topology().twin[3 * std::size_t{of->triangle} + k];
        const auto isTwin = [&](const Touched& other) { return other.triangle == twin / 3; };
        const Touched* const other = twin == kNone ? end : std::find_if(begin, end, isTwin);
        if (other != end && other->face == of->face) continue;
        const Vec3d from = placed_.toLocal(vertex(of->triangle, k));
        const Vec3d to = placed_.toLocal(vertex(of->triangle, (k + 1) % 3));
        if (!shape_.isNearSegment(from, to, flat_)) continue;
        Face& face = faces_[of->face];
        if (other == end || !(otgDot(face.normal, vertex(twin / 3, (twin % 3 + 2) % 3)) > face.offset)) return false;
        face.isTouched = true;
      }
    }
    return true;
  }

  /// Whether the shape, moved out of the faces, is in none that it was in front of.
  bool isFree(const Vec3d& way) const {
    if (!(ahead_ > 0)) return true;
    if (norm(way) > ahead_) return false;
    for (std::size_t f = 0; f < faceCount_; ++f) {
      if (!faces_[f].isTouched) return false;
    }
    return std::all_of(beside_.data(), beside_.data() + besideCount_, [&](const Beside& b) {
      return placed_.rearAlong(b.normal) + otgDot(b.normal, way) >= b.offset - flat_;
    });
  }

  /// The points of a cylinder that are below a face: of the end on which it stands, or the ends of a line of its side.
  template <class Offer>
  void offerCylinder(const Face& face, const Offer& offer) const {
    const PlacedCylinder cylinder = placedCylinder(query_.bInA, shape_);
    const double along = otgDot(cylinder.axis, face.normal);
    if (std::fabs(along) < PlacedShape::kOnSide) {
      const Vec3d aside = cylinder.across(face.normal);
      const Vec3d line = cylinder.middle - aside * (cylinder.radius / norm(aside));
      offer(line - cylinder.axis * cylinder.half, kCylinderSideEnd, true);
      offer(line + cylinder.axis * cylinder.half, kCylinderSideEnd + 1, true);
      return;
    }
    const std::uint32_t end = along > 0 ? 0 : 16;
    const CylinderRim rim(query_.bInA, cylinder.middle - cylinder.axis * std::copysign(cylinder.half, along),
                          cylinder.radius);
    double lowest = face.offset;
    for (std::uint32_t k = 0; k < CylinderRim::kPoints; ++k) {
      offer(rim.point(k), kCylinderRim + end + k, false);
      lowest = std::min(lowest, otgDot(face.normal, rim.point(k)));
    }
    if (face.offset - lowest > kCylinderAsDeep * face.depth) return;
    offer(cylinder.rear(face.normal), kCylinderLowest + end, false);
  }

  /// Whether a face that is nearly the same holds the point as well.
  bool isHeld(const ConvexPlace& place, const Vec3d& normal) const {
    return std::ranges::any_of(workspace_.contacts, [&](const Contact& c) {
      return c.element == place.element && c.depth >= place.depth && otgDot(c.normal, normal) < -kSameDirection;
    });
  }

  void emit(std::uint32_t number, std::uint32_t region) {
    const Face& face = faces_[number];
    std::vector<ConvexPlace>& places = workspace_.convex.places;
    places.clear();
    const auto offer = [&](const Vec3d& p, std::uint32_t element, bool isEnd) {
      const double depth = face.offset - otgDot(face.normal, p);
      if (!(depth > 0)) return;
      ConvexPlace& place = places.emplace_back();
      place = {};
      place.at = p + face.normal * (0.5 * depth);
      place.depth = depth;
      place.element = element;
      place.feature = static_cast<std::uint8_t>(ContactFeature::kVertexB);
      place.isEnd = isEnd;
    };
    if (shape_.isCurved()) {
      offerCylinder(face, offer);
    } else {
      for (std::uint32_t i = 0; i < shape_.vertices.size(); ++i) offer(placed_.fromLocal(shape_.vertices[i]), i, false);
    }
    if (places.empty()) return;  // of a cylinder that touches to rounding
    choosePlaces(places, query_.options.solid.contactsPerRegion, face.depth);
    sortPlaces(places);
    for (const ConvexPlace& p : places) {
      if (isHeld(p, face.normal)) continue;
      Contact& contact = addContact(workspace_.contacts, p, face.normal * -1.0);
      contact.triangleA = triangleBelow(face, p.at, true);
      contact.triangleB = kNone;
      contact.region = region;
    }
  }

  const Query& query_;
  const ConvexShape& shape_;
  Workspace& workspace_;
  const TriMesh& mesh_;
  const Adjacency& links_;
  const PlacedShape placed_;
  Transformd frame_;  ///< of the shape's box
  Vec3d half_;        ///< of that box
  Vec3d inside_;      ///< a point of the shape, well inside
  double radius_, reach_, flat_, ahead_ = 0;
  std::array<Face, kMostFaces> faces_;
  std::array<Touched, kMostTriangles> touched_;
  std::array<Beside, kMostTriangles> beside_;
  std::size_t faceCount_ = 0, count_ = 0, besideCount_ = 0;
};

}  // namespace

bool collideFaces(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const TriMesh& mesh = query.a->mesh();
  if (shape.kind == ConvexShape::Kind::kCapsule || query.options.contacts != ContactModel::kSolid ||
      !query.options.solid.convexPath || query.a->convex() != nullptr || (!isSolid(mesh) && !isSheet(mesh))) {
    return false;
  }
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  requireRigid(query.bInA);
  const SolidHistory::State before = stateBefore(query);
  if (before.side < 0 || before.escapeLeft > 0 || !isUnburdened(query)) return false;
  workspace.clear();
  if (!FaceSolver(query, shape, workspace).run()) return false;
  rememberPlain(query, true, {0, 0, 0});
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  finishContacts(query, workspace);
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  return true;
}

}  // namespace otg
