// SPDX-License-Identifier: BSD-3-Clause
// The collider function of a geom of our class with one of ODE's own.
#pragma once

#include <ode/collision.h>

#include "ode/geom/mesh_side.h"
#include "primitives/plane_contacts.h"

namespace otg {

/// dColliderFn: o1 is the mesh, of our class or a dTriMesh, whatever the order of the call (ODE exchanges the sides
/// afterwards).
int collideMeshPrimitive(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept;

/// A mesh that is to collide with a geom of ODE's, at one moment.
struct PrimitiveTask {
  dGeomID o1 = nullptr, o2 = nullptr;
  MeshSide side;                             ///< of o1, with its object and mesh
  Transformd pose{};                         ///< of the mesh in the world
  Transformd other{};                        ///< of o2 in the mesh's frame; unset for planes and rays
  int capacity = 0;                          ///< places for contacts
  std::shared_ptr<const ConvexShape> shape;  ///< of a convex, where it is known already
  DetachedHistory* detached = nullptr;       ///< takes the place of the mesh's memory
};

/// Reads the poses. False if the pair can have no contacts; a status in `failure` if that is because of a bad pose.
bool preparePrimitive(PrimitiveTask& task, int& failure);

/// At most `most` contacts, in the mesh's frame, with the mesh's own triangle numbers. A status in `failure` if there
/// are none because of an error. Callbacks are asked about rays alone. May throw std::bad_alloc.
void primitiveContacts(const PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure);

/// The plane geom in the mesh's frame.
HalfSpace planeInMesh(const PrimitiveTask& task);

/// The contacts of a ray, nearest first (ray_collider.cpp). May throw std::bad_alloc.
void rayContacts(const PrimitiveTask& task, std::vector<Contact>& out);

}  // namespace otg
