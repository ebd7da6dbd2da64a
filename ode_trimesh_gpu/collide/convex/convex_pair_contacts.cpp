// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/convex_pair_contacts.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "collide/convex/box_axes.h"
#include "collide/convex/clip_faces.h"
#include "collide/convex/convex_places.h"
#include "collide/convex/expanding_polytope.h"
#include "collide/convex/kept_axis.h"
#include "collide/convex/separating_axes.h"
#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/solid/solid_contacts.h"

namespace otg {
namespace {

constexpr double kParallelEdges = 1e-3;        ///< sine of the angle below which edges touch along a stretch
constexpr double kTouchingToRounding = 1e-13;  ///< of the size and the distances

class ConvexSolver {
 public:
  ConvexSolver(const Query& query, Workspace& workspace)
      : query_(query),
        workspace_(workspace),
        scratch_(workspace.convex),
        pair_(*query.a->convex(), *query.b->convex(), query.bInA),
        size_(static_cast<double>(query.a->mesh().radius()) + static_cast<double>(query.b->mesh().radius())) {}

  ConvexAnswer run() {
    const Vec3f &a = query_.a->mesh().center(), &b = query_.b->mesh().center();
    const Vec3d toB = otgTransform(query_.bInA, Vec3d{b.x, b.y, b.z}) - Vec3d{a.x, a.y, a.z};
    // The radius of B grows with the defect of the pose by less than this.
    if (norm(toB) > (1 + 2 * kRelativeRotationTolerance) * size_) return ConvexAnswer::kApart;
    findAxis(toB);
    if (axis_.of == ConvexAxis::Of::kNone) return ConvexAnswer::kApart;
    const double rounding = kTouchingToRounding * (size_ + norm(toB) + norm(query_.bInA.t));
    for (const int body : {0, 1}) farthest_[body] = pair_.farthest(body, out(body));
    if (axis_.overlap <= rounding || axis_.overlap > kMostShallow * std::min(width(0), width(1)))
      return ConvexAnswer::kOther;
    findPlaces();
    choosePlaces(scratch_.places, query_.options.solid.contactsPerRegion, axis_.overlap);
    emit();
    return ConvexAnswer::kTouching;
  }

 private:
  using Corner = ConvexPolyhedron::Corner;

  void findAxis(const Vec3d& toB) {
    SolidHistory::KeptAxis* const kept = query_.history != nullptr ? &query_.history->kept : nullptr;
    if (kept != nullptr && isOfPose(pair_, *kept)) {
      axis_ = {static_cast<ConvexAxis::Of>(kept->of), kept->m, kept->overlap, kept->face};
      return;
    }
    if (pair_.a().box() != nullptr && pair_.b().box() != nullptr) {
      axis_ = leastOfBoxes(pair_, size_);
    } else if (haveFewAxes(pair_)) {
      axis_ = leastByAxes(pair_, size_);
    } else if (kept == nullptr || !isOfPair(pair_, *kept) || !isStillLeast(pair_, *kept, size_, axis_)) {
      axis_ = leastByPolytope(pair_, toB, size_);
    }
    if (kept == nullptr) return;
    *kept = {pair_.a().stamp(),
             pair_.b().stamp(),
             query_.bInA,
             axis_.m,
             axis_.overlap,
             axis_.face,
             static_cast<std::uint8_t>(axis_.of)};
  }

  double width(int body) const {
    const ConvexPolyhedron::Reach reach = pair_.reach(body, axis_.m);
    return reach.most - reach.least;
  }
  Vec3d out(int body) const { return body == 0 ? axis_.m : otgScale(axis_.m, -1.0); }

  void findPlaces() {
    scratch_.places.clear();
    FacingFaces faces{};
    double along[2];
    for (const int body : {0, 1}) faces.face[body] = touchingFaceOf(body, along[body]);
    const bool fromFace = axis_.of != ConvexAxis::Of::kEdges;
    faces.reference = axis_.of == ConvexAxis::Of::kFaceA   ? 0
                      : axis_.of == ConvexAxis::Of::kFaceB ? 1
                      : along[0] > along[1]                ? 0
                                                           : 1;
    if (fromFace || std::min(along[0], along[1]) >= kTouchesAsFace) {
      addFaces(faces);
    } else {
      // Where edges cross deep, corners of the faces beside them are in the other body, too.
      if (std::min(along[0], along[1]) > 0) addFaces(faces);
      bool haveCrossing = false;
      for (ConvexPlace& p : scratch_.places) {
        haveCrossing = haveCrossing || p.depth >= (1 - kFaceShare) * axis_.overlap;
        p.depth = std::min(p.depth, axis_.overlap);
      }
      if (scratch_.places.size() < 2 || !haveCrossing) {
        scratch_.places.clear();
        addEdges();
      }
    }
    if (scratch_.places.empty()) addPoints();
  }

  std::uint32_t touchingFaceOf(int body, double& along) const {
    const Vec3d direction = body == 0 ? axis_.m : otgScale(otgRotateBack(query_.bInA, axis_.m), -1.0);
    return touchingFace(pair_.body(body), farthest_[body], direction, along);
  }

  void addFaces(const FacingFaces& faces) {
    clipFaces(pair_, axis_.m, faces, scratch_);
    for (std::size_t i = 0; i < scratch_.polygon.size(); ++i) {
      const ConvexPlace place = placeOfPoint(pair_, axis_.m, faces, scratch_.polygon, i);
      if (place.depth > 0) scratch_.places.push_back(place);
    }
  }

  /// The edge at a body's farthest vertex that lies best across the normal.
  std::uint32_t touchingEdge(int body) const {
    const ConvexPolyhedron& shape = pair_.body(body);
    std::uint32_t best = shape.cornersAt(farthest_[body]).front();
    double least = 2;
    for (const std::uint32_t c : shape.cornersAt(farthest_[body])) {
      const Corner& corner = shape.corner(c);
      const Vec3d edge = pair_.place(body, corner.next) - pair_.place(body, corner.vertex);
      const double slope = std::fabs(otgDot(edge, axis_.m)) / norm(edge);
      if (!(slope < least)) continue;
      least = slope;
      best = c;
    }
    return best;
  }

  void addEdges() {
    const std::uint32_t a = touchingEdge(0), b = touchingEdge(1);
    const Corner &edgeA = pair_.a().corner(a), &edgeB = pair_.b().corner(b);
    const Vec3d fromA = pair_.place(0, edgeA.vertex), fromB = pair_.place(1, edgeB.vertex);
    const Vec3d alongA = pair_.place(0, edgeA.next) - fromA, alongB = pair_.place(1, edgeB.next) - fromB;
    const Vec3d cross = otgCross(alongA, alongB), apart = fromB - fromA;
    const double square = otgDot(cross, cross), squareA = otgDot(alongA, alongA), squareB = otgDot(alongB, alongB);
    ConvexPlace place{};
    place.cornerA = a;
    place.cornerB = b;
    place.element = edgeA.edge;
    place.depth = axis_.overlap;
    const auto add = [&](double s, double t, ContactFeature feature, std::uint32_t ordinal) {
      place.at = (fromA + alongA * s + fromB + alongB * t) * 0.5;
      place.feature = static_cast<std::uint8_t>(feature);
      place.ordinal = ordinal;
      scratch_.places.push_back(place);
    };
    if (square > kParallelEdges * kParallelEdges * squareA * squareB) {
      const double s = otgDot(otgCross(apart, alongB), cross) / square;
      const double t = otgDot(otgCross(apart, alongA), cross) / square;
      add(std::clamp(s, 0.0, 1.0), std::clamp(t, 0.0, 1.0), ContactFeature::kMiddleA, 0);
      return;
    }
    // The ends of the stretch that they share.
    const double at0 = otgDot(apart, alongA) / squareA, at1 = at0 + otgDot(alongB, alongA) / squareA;
    const double begin = std::max(0.0, std::min(at0, at1)), end = std::min(1.0, std::max(at0, at1));
    if (!(begin < end)) return;
    for (const double s : {begin, end}) {
      const bool isFirst = (s == begin) == edgeA.isForward;
      add(s, std::clamp((s - at0) / (at1 - at0), 0.0, 1.0), ContactFeature::kCrossingA, isFirst ? 0 : 1);
    }
  }

  void addPoints() {
    ConvexPlace place{};
    place.at = (pair_.place(0, farthest_[0]) + pair_.place(1, farthest_[1])) * 0.5;
    place.depth = axis_.overlap;
    place.cornerA = pair_.a().cornersAt(farthest_[0]).front();
    place.cornerB = pair_.b().cornersAt(farthest_[1]).front();
    place.feature = static_cast<std::uint8_t>(ContactFeature::kVertexA);
    place.element = pair_.a().meshVertex(farthest_[0]);
    scratch_.places.push_back(place);
  }

  void emit() {
    sortPlaces(scratch_.places);
    for (const ConvexPlace& p : scratch_.places) {
      Contact& contact = addContact(workspace_.contacts, p, out(1));
      contact.triangleA = triangleAt(pair_.a(), query_.a->mesh(), p.cornerA, p.at);
      contact.triangleB =
          triangleAt(pair_.b(), query_.b->mesh(), p.cornerB, otgRotateBack(query_.bInA, p.at - query_.bInA.t));
    }
  }

  const Query& query_;
  Workspace& workspace_;
  ConvexScratch& scratch_;
  const ConvexPair pair_;
  const double size_;
  ConvexAxis axis_;
  std::uint32_t farthest_[2] = {0, 0};
};

}  // namespace

ConvexAnswer addConvexContacts(const Query& query, Workspace& workspace) {
  return ConvexSolver(query, workspace).run();
}

bool isConvexPair(const Query& query) {
  return query.options.contacts == ContactModel::kSolid && query.options.solid.convexPath && query.refiner == nullptr &&
         query.a->convex() != nullptr && query.b->convex() != nullptr;
}

bool convexPairContacts(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  workspace.contacts.clear();
  workspace.reduced.clear();
  requireRigid(query.bInA);
  const SolidHistory::State before = stateBefore(query);
  if (!isUnburdened(before)) return false;
  const ConvexAnswer answer = ConvexSolver(query, workspace).run();
  if (answer == ConvexAnswer::kOther) return false;
  rememberPlain(query, before, answer == ConvexAnswer::kTouching, {0, 0, 0});
  reduceConvexContacts(query, workspace);
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  return true;
}

bool collideConvexPair(const Query& query, Workspace& workspace) {
  if (!isConvexPair(query)) return false;
  workspace.candidates.clear();
  workspace.intersecting.clear();
  workspace.stats = {};
  return convexPairContacts(query, workspace);
}

}  // namespace otg
