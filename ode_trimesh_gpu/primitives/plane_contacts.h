// SPDX-License-Identifier: BSD-3-Clause
// A mesh against a half space.
#pragma once

#include <vector>

#include "collide/query.h"

namespace otg {

/// All points with normal . x <= offset are solid. In the frame of the mesh; the normal has length 1.
struct PlaneGeom {
  Vec3d normal;
  double offset;
};

/// One contact for each vertex below the plane, at the vertex, with the plane's normal and the vertex's depth: exact,
/// since a mesh leaves a half space when its vertices do. The vertices of one connected part below the plane are a
/// region; those in the middle of flat faces and straight edges are left out, since they hold nothing that the corners
/// don't. Of the others `perRegion` are chosen: the deepest, then again and again the farthest from the chosen ones.
/// Contacts are appended, deepest first; the plane has no triangles (kNone). Of a convex mesh (Convexity::kExact) the
/// corners of its polyhedron are searched from one to the next, and no triangles.
void planeContacts(const CollisionMesh& mesh, const PlaneGeom& plane, int perRegion, std::vector<Contact>& out);

}  // namespace otg
