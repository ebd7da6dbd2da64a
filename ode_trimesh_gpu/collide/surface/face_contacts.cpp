// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/face_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vectors.h"
#include "collide/convex/convex_places.h"
#include "collide/shortest_translation.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/surface/cylinder_points.h"
#include "collide/surface/same_direction.h"

namespace otg {
namespace {

constexpr std::size_t kMostFaces = 4, kMostTriangles = 48;

class FaceSolver {
 public:
  FaceSolver(const NearSurface& near, Workspace& workspace)
      : near_(near),
        shape_(near.shape()),
        workspace_(workspace),
        mesh_(near.mesh()),
        links_(near.query().a->adjacency()),
        placed_(near.placed()),
        inside_(near.inside()),
        flat_(near.rounding()) {}

  bool run() {
    if (!collect() || faceCount_ == 0) return false;
    for (std::size_t f = 0; f < faceCount_; ++f) {
      if (!measure(faces_[f])) return false;
    }
    if (!endAtInnerEdges()) return false;
    ShortestTranslation way(emptyMemory(workspace_));
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
    double offset, area;  ///< of the largest triangle; in the end the offset of the highest vertex
    double depth;         ///< of the shape's deepest point
    bool isTouched;
  };
  struct Touched {
    std::uint32_t triangle;
    std::uint32_t face;
  };
  Vec3d vertex(std::uint32_t triangle, std::size_t k) const { return near_.corner(triangle, k); }

  /// The triangles by faces. False if they are too many.
  bool collect() {
    if (near_.touched().size() > kMostTriangles) return false;
    for (const std::uint32_t t : near_.touched()) touched_[count_++] = {t, kNone};
    if (!std::all_of(touched_.data(), touched_.data() + count_, [&](Touched& of) { return findFace(of); }))
      return false;
    raise();
    return true;
  }

  /// To the highest vertices, which rounding has put above the plane: a shape that is above them is free.
  void raise() {
    for (std::size_t i = 0; i < count_; ++i) {
      Face& face = faces_[touched_[i].face];
      for (std::size_t k = 0; k < 3; ++k) {
        face.offset = std::max(face.offset, otgDot(face.normal, vertex(touched_[i].triangle, k)));
      }
    }
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
    if (!(height > 0) || face.depth <= near_.leastDepth()) return false;
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
    return near_.isFree(way, [&](std::uint32_t t) {
      const Touched *const end = touched_.data() + count_, *const of = std::find_if(
                                                               touched_.data(), end,
                                                               [&](const Touched&o) { return o.triangle == t; });
      return of != end && faces_[of->face].isTouched;
    });
  }

  /// The points of a cylinder that are below a face: of the end on which it stands, or the ends of a line of its side.
  template <class Offer>
  void offerCylinder(const Face& face, const Offer& offer) const {
    const PlacedCylinder cylinder = placedCylinder(near_.query().bInA, shape_);
    const double along = otgDot(cylinder.axis, face.normal);
    if (std::fabs(along) < PlacedBody::kOnSide) {
      const Vec3d aside = cylinder.across(face.normal);
      const Vec3d line = cylinder.middle - aside * (cylinder.radius / norm(aside));
      offer(line - cylinder.axis * cylinder.half, kCylinderSideEnd, true);
      offer(line + cylinder.axis * cylinder.half, kCylinderSideEnd + 1, true);
      return;
    }
    const std::uint32_t end = along > 0 ? 0 : 16;
    const CylinderRim rim(near_.query().bInA, cylinder.middle - cylinder.axis * std::copysign(cylinder.half, along),
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
    choosePlaces(places, near_.query().options.solid.contactsPerRegion, face.depth);
    sortPlaces(places);
    for (const ConvexPlace& p : places) {
      if (isHeld(p, face.normal)) continue;
      Contact& contact = addContact(workspace_.contacts, p, face.normal * -1.0);
      contact.triangleA = triangleBelow(face, p.at, true);
      contact.triangleB = kNone;
      contact.region = region;
    }
  }

  const NearSurface& near_;
  const ConvexGeometry& shape_;
  Workspace& workspace_;
  const TriMesh& mesh_;
  const Adjacency& links_;
  const PlacedBody& placed_;
  const Vec3d inside_;  ///< a point of the shape, well inside
  const double flat_;
  std::array<Face, kMostFaces> faces_;
  std::array<Touched, kMostTriangles> touched_;
  std::size_t faceCount_ = 0, count_ = 0;
};

}  // namespace

bool addFaceContacts(const NearSurface& near, Workspace& workspace) {
  return FaceSolver(near, workspace).run();
}

}  // namespace otg
