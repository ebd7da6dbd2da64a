// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/primitive_contacts.h"

#include <bit>

#include "collide/pair_history.h"
#include "collide/pairwise/reduction.h"
#include "dispatch/threads/workspace_lease.h"
#include "ode/shapes/convex_collider.h"
#include "ode/shapes/heightfield_collider.h"
#include "ode/shapes/primitive_history.h"
#include "ode/shapes/ray_collider.h"
#include "primitives/round_memory.h"
#include "primitives/sphere_contacts.h"

namespace otg {
namespace {

/// sphereContacts() by what the pair with a sheet remembers.
void heldSphere(const PrimitiveTask& task, std::vector<Contact>& out) {
  const double radius = dGeomSphereGetRadius(task.o2);
  if (!isSheet(task.side.mesh->mesh())) {
    RoundMemory none;
    sphereContacts(*task.side.mesh, task.other.t, radius, none, out);
    return;
  }
  PrimitiveHistory history(task);
  RoundMemory memory(*task.side.mesh, poseToRemember(task), radius, radius, std::bit_cast<std::uint64_t>(radius),
                     history.get());
  sphereContacts(*task.side.mesh, task.other.t, radius, memory, out);
  memory.finish(out);
  history.keep(!out.empty());
}

void contactsOf(const PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure) {
  const int perRegion = task.side.object->params.contacts_per_region;
  switch (dGeomGetClass(task.o2)) {
    case dRayClass:
      rayContacts(task, out);  // nearest first: the depth is the way along the ray
      if (out.size() > static_cast<std::size_t>(most)) out.resize(static_cast<std::size_t>(most));
      return;
    case dPlaneClass:
      planeContacts(*task.side.mesh, planeInMesh(task), perRegion, out);
      break;
    case dSphereClass:
      heldSphere(task, out);
      break;
    case dBoxClass:
    case dCapsuleClass:
    case dCylinderClass:
    case dConvexClass: {
      const WorkspaceLease lease;
      const std::span<const Contact> found = convexGeomContacts(task, most, *lease);
      out.assign(found.begin(), found.end());
      return;
    }
    case dHeightfieldClass: {
      const WorkspaceLease lease;
      const std::span<const Contact> found = heightfieldContacts(task, most, *lease, failure);
      out.assign(found.begin(), found.end());
      return;
    }
    default:
      return;
  }
  if (out.size() > static_cast<std::size_t>(most)) out = limitContacts(out, most);
}

}  // namespace

void primitiveContacts(const PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure) {
  if (!task.sideBefore) {
    contactsOf(task, most, out, failure);
    return;
  }
  if (task.detached != nullptr) {
    contactsOf(task, most, out, failure);
    rememberSide(task);
    return;
  }
  // Two steps remember something. Other threads see what both have left.
  DetachedHistory left = detachedHistory(task);
  PrimitiveTask own = task;
  own.detached = &left;
  contactsOf(own, most, out, failure);
  rememberSide(own);
  leaveHistory(task, left);
}

}  // namespace otg
