// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/surface_contacts.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "base/vectors.h"
#include "collide/convex/convex_places.h"
#include "collide/inside_test.h"
#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/shell/shell_roles.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "collide/surface/face_contacts.h"
#include "collide/surface/flat_ground.h"
#include "collide/surface/near_surface.h"
#include "collide/surface/smooth_contacts.h"

namespace otg {
namespace {

constexpr double kLongestWay = 0.05;  ///< of the smaller radius: a longer way out of a mesh is for the model of solids

SurfaceAnswer answerOf(const NearSurface& near, Workspace& workspace) {
  if (addFaceContacts(near, workspace)) return SurfaceAnswer::kTouching;
  return near.query().a->parts() != nullptr ? SurfaceAnswer::kOther : addSmoothContacts(near, workspace);
}

/// Of a body that meets no surface: whether contacts of any kind would be none.
bool isOutside(const NearSurface& near) {
  if (mayBeShells(near.query())) return false;
  const Vec3f &low = near.mesh().boundsMin(), &high = near.mesh().boundsMax();
  const Vec3d& p = near.inside();
  return !isSolid(near.mesh()) || p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y ||
         p.z > high.z || !pointInMesh(*near.query().a, p);
}

/// `near` is of the query with the body as B; `complete` is called with the contacts of that.
template <class Complete>
bool addContacts(const Query& query, NearSurface& near, Workspace& workspace, const Complete& complete) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  requireRigid(query.bInA);
  const SolidHistory::State before = stateBefore(query);
  if (before.side < 0 || before.escapeLeft > 0 || !isUnburdened(before)) return false;
  if (!near.collect()) return false;
  const SurfaceAnswer answer = answerOf(near, workspace);
  if (answer == SurfaceAnswer::kOther || (answer == SurfaceAnswer::kApart && !isOutside(near))) return false;
  complete(workspace.contacts);
  rememberPlain(query, before, answer == SurfaceAnswer::kTouching, {0, 0, 0});
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  const bool isFree = finishContacts(query, workspace);
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  return isFree;
}

const ConvexPolyhedron* polyhedronOf(const CollisionMesh* mesh) {
  const ConvexPolyhedron* const convex = mesh->convex();
  return convex != nullptr && convex->geometry() != nullptr ? convex : nullptr;
}

bool hasSurface(const CollisionMesh* mesh) {
  return mesh->convex() == nullptr && mesh->parts() == nullptr && (isSolid(mesh->mesh()) || isSheet(mesh->mesh()));
}

/// The pair with one of its meshes as A.
Query seenFrom(const CollisionMesh* mesh, const Query& query) {
  Query seen;
  const bool isFirst = mesh == query.a;
  seen.a = mesh;
  seen.b = isFirst ? query.b : query.a;
  seen.options = query.options;
  seen.bInA = isFirst ? query.bInA : inverseOf(query.bInA);
  return seen;
}

double longestWay(const Query& query) {
  return kLongestWay * std::min(double{query.a->mesh().radius()}, double{query.b->mesh().radius()});
}

/// Whether a point lies in one of the parts of a mesh.
bool isInPart(const CollisionMesh& mesh, const Vec3d& p) {
  if (mesh.parts() == nullptr) return false;
  return std::ranges::any_of(mesh.parts()->meshes, [&](const auto& part) {
    const Vec3f &low = part->mesh().boundsMin(), &high = part->mesh().boundsMax();
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z &&
           pointInMesh(*part, p);
  });
}

/// Whether the larger one of two meshes is flat ground to the other one. `seen` is with the ground as B.
bool findGround(const Query& query, FlatGround& ground, Query& seen) {
  const double a = double{query.a->mesh().radius()}, b = double{query.b->mesh().radius()};
  const CollisionMesh *const larger = a > b ? query.a : query.b, *const other = a > b ? query.b : query.a;
  if (a == b || !(hasSurface(larger) || larger->parts() != nullptr) || other->parts() != nullptr ||
      !mayBeFlatGround(*larger) || (!isSolid(other->mesh()) && !isSheet(other->mesh()))) {
    return false;
  }
  seen = seenFrom(other, query);
  // A wall inside a body of blocks is no ground.
  return ground.find(*larger, *other, inverseOf(seen.bInA), longestWay(query)) && !isInPart(*larger, ground.above());
}

ContactFeature ofOther(ContactFeature feature) {
  switch (feature) {
    case ContactFeature::kVertexA:
      return ContactFeature::kVertexB;
    case ContactFeature::kVertexB:
      return ContactFeature::kVertexA;
    case ContactFeature::kCrossingA:
      return ContactFeature::kCrossingB;
    case ContactFeature::kMiddleA:
      return ContactFeature::kMiddleB;
    default:
      return feature;
  }
}

/// Of the face whose plane is nearest to a point on the body.
std::uint32_t cornerAt(const ConvexPolyhedron& body, const Vec3d& p) {
  std::uint32_t nearest = 0;
  const auto height = [&](std::uint32_t f) { return otgDot(body.face(f).normal, p) - body.face(f).offset; };
  double most = height(0);
  for (std::uint32_t f = 1; f < body.faceCount(); ++f) {
    if (const double here = height(f); here > most) {
      most = here;
      nearest = f;
    }
  }
  return body.face(nearest).corner;
}

/// Names the body's vertex and triangle of a contact.
void nameOnBody(const Query& seen, const ConvexPolyhedron& body, Contact& contact) {
  if (contact.feature == ContactFeature::kVertexB) {
    contact.triangleB = body.leastTriangle(contact.element);
    contact.element = body.meshVertex(contact.element);
  } else {
    const Vec3d onBody = contact.position + contact.normal * (0.5 * contact.depth);
    const Vec3d p = otgRotateBack(seen.bInA, onBody - seen.bInA.t);
    contact.triangleB = triangleAt(body, seen.b->mesh(), cornerAt(body, p), p);
  }
}

/// Of the pair the other way round.
void turnRound(const Query& query, Contact& contact) {
  contact.position = otgTransform(query.bInA, contact.position);
  contact.normal = otgRotate(query.bInA, contact.normal) * -1.0;
  std::swap(contact.triangleA, contact.triangleB);
  contact.feature = ofOther(contact.feature);
}

}  // namespace

bool collideSurface(const Query& query, const ConvexGeometry& body, Workspace& workspace) {
  const TriMesh& mesh = query.a->mesh();
  if (body.kind == ConvexGeometry::Kind::kCapsule || query.options.contacts != ContactModel::kSolid ||
      !query.options.solid.convexPath || query.a->convex() != nullptr || (!isSolid(mesh) && !isSheet(mesh))) {
    return false;
  }
  workspace.clear();
  constexpr double kAnyLength = std::numeric_limits<double>::infinity();
  NearSurface near(query, body, isCornered(query.a), kAnyLength);
  return addContacts(query, near, workspace, [](std::vector<Contact>&) {});
}

namespace {

bool mayBeSurfacePair(const Query& query) {
  return query.options.contacts == ContactModel::kSolid && query.options.solid.convexPath && !query.isOffSurface &&
         query.refiner == nullptr && !areShells(query.a->mesh(), query.b->mesh());
}

/// The mesh on whose surface the other one is a convex body, or null.
const CollisionMesh* meshUnderBody(const Query& query) {
  if (polyhedronOf(query.b) != nullptr && hasSurface(query.a)) return query.a;
  return polyhedronOf(query.a) != nullptr && hasSurface(query.b) ? query.b : nullptr;
}

/// Contacts of a body, which is B of `seen`.
bool bodyContacts(const Query& query, const Query& seen, Workspace& workspace) {
  const ConvexPolyhedron& body = *seen.b->convex();
  // Whatever the mesh is elsewhere: a ground that is cut out around the body has the contacts of the whole.
  NearSurface near(seen, *body.geometry(), true, longestWay(query));
  return addContacts(query, near, workspace, [&](std::vector<Contact>& contacts) {
    for (Contact& contact : contacts) {
      nameOnBody(seen, body, contact);
      if (seen.a != query.a) turnRound(query, contact);
    }
  });
}

/// Contacts with flat ground, which is B of `seen`.
bool groundContacts(const Query& query, const Query& seen, const FlatGround& ground, Workspace& workspace) {
  const SolidParts* const parts = seen.b->parts();
  ConvexGeometry& box = aheadOf(workspace).floor;
  Query asBox = seen;
  asBox.bInA = composed(seen.bInA, ground.makeBox(box));
  NearSurface near(asBox, box, true, longestWay(query));
  return addContacts(query, near, workspace, [&](std::vector<Contact>& contacts) {
    for (Contact& contact : contacts) {
      contact.triangleB = ground.triangleBelow(otgRotateBack(seen.bInA, contact.position - seen.bInA.t));
      if (parts != nullptr && contact.element != kNone) {
        contact.ordinal += parts->partOf[contact.triangleB] % 256 * kOrdinalOfPart;
      }
      if (seen.a != query.a) turnRound(query, contact);
    }
  });
}

}  // namespace

bool mayBeFlatGround(const CollisionMesh& mesh) {
  return mesh.adjacency().flatEdges > 0;
}

bool isSurfacePair(const Query& query) {
  FlatGround ground;
  Query seen;
  return mayBeSurfacePair(query) && (meshUnderBody(query) != nullptr || findGround(query, ground, seen));
}

bool surfacePairContacts(const Query& query, Workspace& workspace) {
  if (!mayBeSurfacePair(query)) return false;
  const CollisionMesh* const mesh = meshUnderBody(query);
  FlatGround ground;
  Query seen;
  if (mesh != nullptr) {
    seen = seenFrom(mesh, query);
  } else if (!findGround(query, ground, seen)) {
    return false;
  }
  workspace.contacts.clear();
  workspace.reduced.clear();
  return mesh != nullptr ? bodyContacts(query, seen, workspace) : groundContacts(query, seen, ground, workspace);
}

bool collideSurfacePair(const Query& query, Workspace& workspace) {
  if (!mayBeSurfacePair(query)) return false;
  workspace.clear();
  return surfacePairContacts(query, workspace);
}

}  // namespace otg
