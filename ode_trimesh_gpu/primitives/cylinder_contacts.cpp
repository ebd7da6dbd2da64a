// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/cylinder_contacts.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/vectors.h"
#include "collide/convex/convex_pair_contacts.h"
#include "collide/convex/convex_places.h"
#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/solid/solid_contacts.h"
#include "primitives/convex_patch.h"
#include "primitives/cylinder_separation.h"

namespace otg {
namespace {

constexpr double kLeastFacing = 0.05;   ///< cosine from which on a face is one to leave through
constexpr double kOnLine = 1e-6;        ///< sine of the slope below which all points of a side are as deep
constexpr double kTouching = 1e-13;     ///< of the size and the distances
constexpr double kClearlyApart = 1e-9;  ///< of the size: so far apart, a kept direction decides it alone

/// Of the edges' points (Contact::ordinal), by what the edge crosses.
enum Ordinal : std::uint32_t { kEnds = 0, kRimOfEnd = 2, kSideLine = 4 };

class CylinderSolver {
 public:
  CylinderSolver(const Query& query, const ConvexShape& shape, Workspace& workspace)
      : query_(query),
        workspace_(workspace),
        body_(*query.a->convex()),
        places_(workspace.convex.places),
        cylinder_(placedCylinder(query.bInA, shape)),
        size_(double{query.a->mesh().radius()} + std::hypot(shape.radius, shape.length)) {}

  enum class Answer : std::uint8_t { kApart, kTouching, kOther };

  Answer run() {
    const Vec3f& a = query_.a->mesh().center();
    const Vec3d toB = cylinder_.middle - Vec3d{a.x, a.y, a.z};
    if (norm(toB) > size_) return Answer::kApart;
    findAxis(toB);
    const double rounding = kTouching * (size_ + norm(toB) + norm(query_.bInA.t));
    if (axis_.of == CylinderAxis::Of::kNone || axis_.overlap <= rounding) return Answer::kApart;
    const ConvexPolyhedron::Reach reach = body_.reach(axis_.m);
    const double width = std::min(reach.most - reach.least, cylinder_.widthAlong(axis_.m));
    if (axis_.overlap > kMostShallow * width) return Answer::kOther;
    findPlaces();
    choosePlaces(places_, query_.options.solid.contactsPerRegion, axis_.overlap);
    emit();
    return Answer::kTouching;
  }

 private:
  using Of = CylinderAxis::Of;
  using Corner = ConvexPolyhedron::Corner;

  void findAxis(const Vec3d& toB) {
    CylinderSeparation separation(body_, cylinder_, size_);
    SolidHistory::KeptAxis* const kept = query_.history != nullptr ? &query_.history->kept : nullptr;
    const std::uint64_t other = query_.b->mesh().contentHash();
    if (kept != nullptr && kept->a == body_.stamp() && kept->b == other) {
      if (kept->face != kNone && separation.isStillLeast(kept->face, axis_)) return;
      axis_ = {};
      if (separation.overlapAlong(kept->m) < -kClearlyApart * size_) return;
    }
    axis_ = separation.find(toB);
    if (kept == nullptr) return;
    const std::uint32_t face = axis_.of == Of::kFace ? axis_.feature : kNone;
    *kept = {body_.stamp(), other, query_.bInA, separation.last(), axis_.overlap, face, 0};
  }

  void findPlaces() {
    places_.clear();
    m_ = axis_.m;
    along_ = otgDot(cylinder_.axis, m_);
    face_ = faceToTouch();
    normal_ = body_.face(face_).normal;
    facing_ = otgDot(normal_, m_);
    if (facing_ > kLeastFacing) {
      addCorners();
      if (std::fabs(along_) >= PlacedShape::kOnSide) {
        addEnd();
      } else {
        addSide();
      }
    }
    double deepest = 0;
    for (const ConvexPlace& p : places_) deepest = std::max(deepest, p.depth);
    if (!(deepest > kCylinderAsDeep * axis_.overlap)) addDeepest();
  }

  std::uint32_t faceToTouch() const {
    if (axis_.of == Of::kFace) return axis_.feature;
    if (axis_.of == Of::kEdge) {
      const Corner& edge = body_.corner(axis_.feature);
      const bool isLeft = otgDot(body_.face(edge.face).normal - body_.face(edge.across).normal, m_) >= 0;
      return isLeft ? edge.face : edge.across;
    }
    double cosine = 0;
    return touchingFace(body_, axis_.of == Of::kOther ? body_.support(m_) : axis_.feature, m_, cosine);
  }

  ConvexPlace& add(ContactFeature feature, std::uint32_t element, std::uint32_t ordinal, std::uint32_t corner) {
    ConvexPlace& place = places_.emplace_back();
    place = {};
    place.feature = static_cast<std::uint8_t>(feature);
    place.element = element;
    place.ordinal = ordinal;
    place.cornerA = corner;
    return place;
  }
  /// From a point of the cylinder along m to the face. False where that is in front of it.
  bool measure(ConvexPlace& place, const Vec3d& onCylinder) {
    place.depth = (body_.face(face_).offset - otgDot(normal_, onCylinder)) / facing_;
    place.at = onCylinder + m_ * (0.5 * place.depth);
    if (place.depth > 0) return true;
    places_.pop_back();
    return false;
  }

  /// How far a point inside the cylinder is from its surface against m; negative outside.
  double behind(const Vec3d& p) const {
    const Vec3d from = p - cylinder_.middle;
    const double z = otgDot(cylinder_.axis, from);
    const Vec3d x = from - cylinder_.axis * z, d = cylinder_.across(m_) * -1.0;
    const double room = cylinder_.radius * cylinder_.radius - otgDot(x, x);
    if (std::fabs(z) > cylinder_.half || room < 0) return -1;
    double least = std::numeric_limits<double>::infinity();
    if (along_ != 0) least = (cylinder_.half + std::copysign(z, along_ * z)) / std::fabs(along_);
    const double a = otgDot(d, d), b = otgDot(x, d);
    if (a > 0) least = std::min(least, (std::sqrt(std::max(0.0, b * b + a * room)) - b) / a);
    return least;
  }

  /// Of the face, inside the cylinder.
  void addCorners() {
    std::uint32_t number = body_.face(face_).corner;
    for (const Corner& corner : body_.corners(face_)) {
      const Vec3d at = body_.vertices()[corner.vertex];
      if (const double depth = behind(at); depth > 0) {
        ConvexPlace& place = add(ContactFeature::kVertexA, body_.meshVertex(corner.vertex), 0, number);
        place.depth = depth;
        place.at = at - m_ * (0.5 * depth);
      }
      ++number;
    }
  }

  /// Whether a point is over the face, seen along m.
  bool isOverFace(const Vec3d& p) const {
    for (const Corner& corner : body_.corners(face_)) {
      const Vec3d from = body_.vertices()[corner.vertex];
      if (otgDot(otgCross(body_.vertices()[corner.next] - from, m_), p - from) > 0) return false;
    }
    return true;
  }

  /// The rim of the end that goes ahead, over the face: points of its own, and where it crosses the face's sides.
  void addEnd() {
    const std::uint32_t first = body_.face(face_).corner, which = along_ > 0 ? 0 : 1;
    const Vec3d centre = cylinder_.middle - cylinder_.axis * std::copysign(cylinder_.half, along_);
    const CylinderRim rim(query_.bInA, centre, cylinder_.radius);
    double deepest = 0;
    for (std::uint32_t k = 0; k < CylinderRim::kPoints; ++k) {
      const Vec3d p = rim.point(k);
      if (!isOverFace(p)) continue;
      ConvexPlace& place = add(ContactFeature::kVertexB, kCylinderRim + 16 * which + k, 0, first);
      if (measure(place, p)) deepest = std::max(deepest, place.depth);
    }
    const Vec3d lowest = cylinder_.rear(m_);
    if (!(deepest > kCylinderAsDeep * axis_.overlap) && isOverFace(lowest)) {
      measure(add(ContactFeature::kVertexB, kCylinderLowest + 16 * which, 0, first), lowest);
    }
    std::uint32_t number = first;
    for (const Corner& corner : body_.corners(face_)) addRimOnSide(corner, number++, centre, rim.u, rim.v);
  }

  /// Where the rim crosses one side of the face.
  void addRimOnSide(const Corner& corner, std::uint32_t number, const Vec3d& centre, const Vec3d& u, const Vec3d& v) {
    const Vec3d from = body_.vertices()[corner.vertex], edge = body_.vertices()[corner.next] - from;
    const Vec3d outward = otgCross(edge, m_);
    const double a = otgDot(outward, u), b = otgDot(outward, v), k = otgDot(outward, from - centre);
    const double square = a * a + b * b, rest = square - k * k;
    if (!(rest > 0)) return;
    const double cosine = k / square, sine = std::sqrt(rest) / square;
    const Vec3d flat = edge - m_ * otgDot(edge, m_);
    const double length = otgDot(flat, flat);
    for (const double sign : {-1.0, 1.0}) {
      const Vec3d p = centre + u * (a * cosine - sign * b * sine) + v * (b * cosine + sign * a * sine);
      const double t = otgDot(p - from, flat);
      if (t < 0 || t > length) continue;
      const bool isFirst = (sign < 0) == corner.isForward;
      measure(add(ContactFeature::kCrossingA, corner.edge, kRimOfEnd + (isFirst ? 0 : 1), number), p);
    }
  }

  /// The line of the round side that goes ahead, over the face; and the edges of the face between the two ends.
  void addSide() {
    const std::uint32_t first = body_.face(face_).corner;
    const Vec3d aside = cylinder_.across(m_), line = cylinder_.middle - aside * (cylinder_.radius / norm(aside));
    double low = -cylinder_.half, high = cylinder_.half;
    const Corner *atLow = nullptr, *atHigh = nullptr;
    for (const Corner& corner : body_.corners(face_)) {
      const Vec3d from = body_.vertices()[corner.vertex];
      const Vec3d outward = otgCross(body_.vertices()[corner.next] - from, m_);
      const double speed = otgDot(outward, cylinder_.axis), room = otgDot(outward, from - line);
      if (speed == 0) {
        if (room < 0) high = low - 1;
        continue;
      }
      const double t = room / speed;
      if (speed > 0 && t < high) {
        high = t;
        atHigh = &corner;
      } else if (speed < 0 && t > low) {
        low = t;
        atLow = &corner;
      }
    }
    if (low <= high) {
      for (const bool isHigh : {false, true}) {
        const Corner* const at = isHigh ? atHigh : atLow;
        ConvexPlace& place = at == nullptr
                                 ? add(ContactFeature::kVertexB, kCylinderSideEnd + (isHigh ? 1 : 0), 0, first)
                                 : add(ContactFeature::kCrossingA, at->edge, kSideLine,
                                       first + static_cast<std::uint32_t>(at - &body_.corner(first)));
        place.isEnd = true;
        measure(place, line + cylinder_.axis * (isHigh ? high : low));
      }
    }
    std::uint32_t number = first;
    for (const Corner& corner : body_.corners(face_)) addEdgeInEnds(corner, number++);
  }

  /// Where an edge of the face goes through the planes of the cylinder's ends.
  void addEdgeInEnds(const Corner& corner, std::uint32_t number) {
    const Vec3d from = body_.vertices()[corner.vertex], edge = body_.vertices()[corner.next] - from;
    const double z = otgDot(cylinder_.axis, from - cylinder_.middle), speed = otgDot(cylinder_.axis, edge);
    if (speed == 0) return;
    for (const double end : {-cylinder_.half, cylinder_.half}) {
      const double t = (end - z) / speed;
      if (!(t > 0 && t < 1)) continue;
      Vec3d p = from + edge * t;
      // On the end to the last bit, which counts as inside.
      const double depth = behind(p - cylinder_.axis * std::copysign(kTouching * size_, end));
      if (!(depth > 0)) continue;
      const bool isFirst = (end < 0) == ((speed > 0) == corner.isForward);
      ConvexPlace& place = add(ContactFeature::kCrossingA, corner.edge, kEnds + (isFirst ? 0 : 1), number);
      place.depth = depth;
      place.at = p - m_ * (0.5 * depth);
    }
  }

  /// Where the least overlap is decided.
  void addDeepest() {
    Vec3d at = cylinder_.rear(m_) + m_ * axis_.overlap;  // on the mesh
    const std::uint32_t first = body_.face(face_).corner;
    if (axis_.of == Of::kEdge) {
      const Corner& edge = body_.corner(axis_.feature);
      const Vec3d from = body_.vertices()[edge.vertex], along = body_.vertices()[edge.next] - from;
      // The point of the edge next to the rim's point, or where the side's line crosses it.
      double t = otgDot(at - from, along) / otgDot(along, along);
      const Vec3d normal = otgCross(along, cylinder_.axis);
      const double square = otgDot(normal, normal);
      if (std::fabs(along_) < kOnLine && square > 0) t = otgDot(otgCross(at - from, cylinder_.axis), normal) / square;
      at = from + along * std::clamp(t, 0.0, 1.0);
      ConvexPlace& place = add(ContactFeature::kMiddleA, edge.edge, 0, axis_.feature);
      place.at = at;
    } else if (axis_.of == Of::kEnd || axis_.of == Of::kCorner) {
      at = body_.vertices()[axis_.feature];
      add(ContactFeature::kVertexA, body_.meshVertex(axis_.feature), 0, body_.cornersAt(axis_.feature).front());
    } else {
      add(ContactFeature::kVertexB, kCylinderSide, 0, first);
    }
    ConvexPlace& place = places_.back();
    place.depth = axis_.overlap;
    place.at = at - m_ * (0.5 * axis_.overlap);
    const Vec3f &low = query_.a->mesh().boundsMin(), &high = query_.a->mesh().boundsMax();
    place.at = minimum(maximum(place.at, Vec3d{low.x, low.y, low.z}), Vec3d{high.x, high.y, high.z});
  }

  void emit() {
    sortPlaces(places_);
    for (const ConvexPlace& p : places_) {
      Contact& contact = addContact(workspace_.contacts, p, m_ * -1.0);
      contact.triangleA = triangleAt(body_, query_.a->mesh(), p.cornerA, p.at);
      contact.triangleB = kNone;
    }
  }

  const Query& query_;
  Workspace& workspace_;
  const ConvexPolyhedron& body_;
  std::vector<ConvexPlace>& places_;
  const PlacedCylinder cylinder_;
  const double size_;
  CylinderAxis axis_;
  Vec3d m_{0, 0, 0}, normal_{0, 0, 0};  ///< of the contacts, out of the mesh; of the face
  double along_ = 0, facing_ = 0;       ///< of m: the parts along the axis, and along the face's normal
  std::uint32_t face_ = kNone;
};

}  // namespace

bool collideCylinder(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  if (shape.kind != ConvexShape::Kind::kCylinder || query.options.contacts != ContactModel::kSolid ||
      !query.options.solid.convexPath || query.a->convex() == nullptr) {
    return false;
  }
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  workspace.clear();
  requireRigid(query.bInA);
  const SolidHistory::State before = stateBefore(query);
  if (!isUnburdened(before)) return false;
  const CylinderSolver::Answer answer = CylinderSolver(query, shape, workspace).run();
  if (answer == CylinderSolver::Answer::kOther) return false;
  rememberPlain(query, before, answer == CylinderSolver::Answer::kTouching, {0, 0, 0});
  reduceConvexContacts(query, workspace);
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  return true;
}

}  // namespace otg
