// SPDX-License-Identifier: BSD-3-Clause
// A pair of a mesh and a geom of ODE's own.
#pragma once

#include <ode/collision.h>

#include <memory>
#include <optional>

#include "collide/query.h"
#include "ode/geom/mesh_side.h"
#include "primitives/convex_shape.h"
#include "primitives/plane_contacts.h"

namespace otg {

/// What is remembered of a pair, apart from the mesh's memory: for a query that is computed ahead, or in steps.
struct DetachedHistory {
  SolidHistory history;
  bool isTouched = false;  ///< after the query: else what the mesh remembers stays as it is
  bool isKept = false;     ///< then: to be remembered, rather than forgotten
};

/// A mesh that is to collide with a geom of ODE's, at one moment.
struct PrimitiveTask {
  dGeomID o1 = nullptr, o2 = nullptr;
  MeshSide side;                                  ///< of o1, with its object and mesh
  Transformd pose{};                              ///< of the mesh in the world
  Transformd other{};                             ///< of o2 in the mesh's frame; unset for planes and rays
  bool isOutside = false;                         ///< of a mesh wound inward, which turnInward() has turned round
  std::optional<SolidHistory::State> sideBefore;  ///< of such a mesh: what that was decided by
  int capacity = 0;                               ///< places for contacts
  std::shared_ptr<const ConvexShape> shape;       ///< of a convex, where it is known already
  DetachedHistory* detached = nullptr;            ///< takes the place of the mesh's memory
};

/// `other` as a query remembers it: a ball may have turned anyhow.
Transformd poseToRemember(const PrimitiveTask& task);

/// The plane geom in the mesh's frame.
PlaneGeom planeInMesh(const PrimitiveTask& task);

}  // namespace otg
