// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/convex_collider.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "collide/pair_history.h"
#include "collide/pairwise/reduction.h"
#include "ode/pairs/pair_task.h"
#include "ode/shapes/primitive_history.h"
#include "primitives/capsule_contacts.h"
#include "primitives/convex_contacts.h"
#include "primitives/round_memory.h"

namespace otg {
namespace {

/// Room for a convex's contacts, on the stack and as it comes where few are enough.
class ContactRoom {
 public:
  /// With a half space; all corners below it if there are corners above it, too.
  std::span<const dContactGeom> cornersBelow(dGeomID convex, dGeomID plane) {
    for (std::span<dContactGeom> room = few_;; room = many_) {
      const int count = dCollide(convex, plane, static_cast<int>(room.size()), room.data(), sizeof(dContactGeom));
      if (count < static_cast<int>(room.size()) || room.size() >= 0xffff)
        return room.first(static_cast<std::size_t>(count));
      many_.resize(std::min<std::size_t>(4 * room.size(), 0xffff));
    }
  }

 private:
  dContactGeom few_[256];
  std::vector<dContactGeom> many_;
};

/// To single precision, as the vertices of meshes are, and what is small to 2^-30 of the largest coordinate. So they
/// are the same numbers whatever the pose that they were read in, which leaves 1e-17 of what is zero.
void roundCorners(std::vector<Vec3d>& corners) {
  double most = 0;
  for (const Vec3d& p : corners) most = std::max({most, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  if (!(most > 0) || !std::isfinite(most)) return;
  // What is added and taken off again leaves multiples of 2^-30.
  const double rounder = std::ldexp(1.5, std::ilogb(static_cast<float>(most)) + 52 - 30);
  const auto rounded = [&](double x) { return (double{static_cast<float>(x)} + rounder) - rounder; };
  for (Vec3d& p : corners) p = {rounded(p.x), rounded(p.y), rounded(p.z)};
}

/// The corners of a dConvex in its own frame, in order. No function of ODE reports them. But its collider of a convex
/// with a plane gives a contact at each corner below the plane if there are corners above it, too: the half spaces on
/// either side of a plane through the convex determine all.
std::vector<Vec3d> cornersOfConvex(dGeomID convex) {
  const Transformd pose = readPose(convex).transform;
  dReal box[6];
  dGeomGetAABB(convex, box);
  ContactRoom room;
  std::vector<Vec3d> corners;
  const auto take = [&](std::span<const dContactGeom> contacts) {
    corners.reserve(corners.size() + contacts.size());
    for (const dContactGeom& contact : contacts) {
      const dReal* const p = contact.pos;
      corners.push_back(otgRotateBack(pose, otgSub(Vec3d{p[0], p[1], p[2]}, pose.t)));
    }
  };
  // Inside a dGeomTransform the box may be that of another pose; the origin is a second guess.
  const dReal guesses[2] = {(box[0] + box[1]) / 2, static_cast<dReal>(pose.t.x)};
  for (const dReal middle : guesses) {
    const dGeomID plane = dCreatePlane(nullptr, 1, 0, 0, middle);
    take(room.cornersBelow(convex, plane));
    dGeomPlaneSetParams(plane, -1, 0, 0, -middle);
    take(room.cornersBelow(convex, plane));
    dGeomDestroy(plane);
    if (!corners.empty()) break;
  }
  roundCorners(corners);
  const auto less = [](const Vec3d& a, const Vec3d& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  };
  std::sort(corners.begin(), corners.end(), less);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace

std::shared_ptr<const ConvexShape> shapeOfGeom(dGeomID geom) {
  switch (dGeomGetClass(geom)) {
    case dBoxClass: {
      dVector3 sides;
      dGeomBoxGetLengths(geom, sides);
      return boxShape({0.5 * sides[0], 0.5 * sides[1], 0.5 * sides[2]});
    }
    case dCapsuleClass: {
      dReal radius, length;
      dGeomCapsuleGetParams(geom, &radius, &length);
      return capsuleShape(radius, 0.5 * length);
    }
    case dCylinderClass: {
      dReal radius, length;
      dGeomCylinderGetParams(geom, &radius, &length);
      return cylinderShape(radius, 0.5 * length);
    }
    default:
      return polyhedronShape(cornersOfConvex(geom));
  }
}

namespace {

Capsule capsuleInMesh(const PrimitiveTask& task) {
  dReal radius, length;
  dGeomCapsuleGetParams(task.o2, &radius, &length);
  return {task.other.t, otgRotate(task.other, Vec3d{0, 0, 1}), static_cast<double>(radius), 0.5 * length};
}

/// capsuleContacts() by what the pair with a sheet remembers.
bool heldCapsule(const PrimitiveTask& task, const ConvexShape& shape, PrimitiveHistory& history,
                 std::vector<Contact>& contacts) {
  const Capsule capsule = capsuleInMesh(task);
  RoundMemory memory(*task.side.mesh, task.other, capsule.radius, capsule.half + capsule.radius,
                     shape.mesh->mesh().contentHash(), history.get());
  if (!capsuleContacts(*task.side.mesh, capsule, memory, contacts)) return false;
  memory.finish(contacts);
  history.keep(!contacts.empty());
  return true;
}

/// capsuleContacts() with a mesh that is no sheet: most pairs need no mesh of the capsule, and remember nothing.
bool plainCapsule(const PrimitiveTask& task, std::vector<Contact>& contacts) {
  RoundMemory none;
  if (!capsuleContacts(*task.side.mesh, capsuleInMesh(task), none, contacts)) return false;
  forgetPrimitive(task);
  return true;
}

void limitTo(int most, std::vector<Contact>& contacts) {
  if (contacts.size() > static_cast<std::size_t>(most)) contacts = limitContacts(contacts, most);
}

}  // namespace

std::span<const Contact> convexGeomContacts(const PrimitiveTask& task, int most, Workspace& workspace) {
  workspace.reduced.clear();
  const bool isCapsule = dGeomGetClass(task.o2) == dCapsuleClass, remembers = isSheet(task.side.mesh->mesh());
  if (isCapsule && !remembers && plainCapsule(task, workspace.reduced)) {
    limitTo(most, workspace.reduced);
    return workspace.reduced;
  }
  const std::shared_ptr<const ConvexShape> shape = task.shape != nullptr ? task.shape : shapeOfGeom(task.o2);
  if (shape == nullptr) return {};
  PrimitiveHistory history(task);
  if (isCapsule && remembers && heldCapsule(task, *shape, history, workspace.reduced)) {
    limitTo(most, workspace.reduced);
    return workspace.reduced;
  }
  Query query;
  query.a = task.side.mesh;
  query.b = shape->mesh.get();
  query.bInA = task.other;
  query.options = pairOptions(task.side.object->params, task.side.object->params);
  query.options.maxContacts = most;
  const dReal* const at = dGeomGetPosition(task.o2);
  query.relativeVelocity = relativeVelocity(task, Vec3d{at[0], at[1], at[2]});
  query.history = history.get();
  convexContacts(query, *shape, workspace);
  history.keep(!workspace.reduced.empty());
  return workspace.reduced;
}

}  // namespace otg
