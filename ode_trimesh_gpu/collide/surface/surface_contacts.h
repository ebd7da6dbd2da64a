// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a convex body with what is near it of a mesh's surface, without pairs of triangles.
#pragma once

#include "collide/query.h"
#include "mesh/convex_geometry.h"

namespace otg {

/// Where the body is on faces (face_contacts.h) or on a smooth surface (smooth_contacts.h) of query.a: their contacts
/// -> workspace.contacts and workspace.reduced, with kNone for triangles of B. False, with nothing remembered, for
/// other places, bodies and pairs, and where the pair remembers being behind the surface or entangled: there the stages
/// for any solids have more to say. Query.b is not looked at, but for what the pair remembers.
bool collideSurface(const Query& query, const ConvexGeometry& body, Workspace& workspace);

/// Whether one mesh is a convex body of no more than ConvexPolyhedron::kMostPlanes faces, and the other a solid or a
/// sheet that is no such body; or the larger one is flat ground to the other (flat_ground.h). SolidOptions::convexPath
/// is set, and Query::isOffSurface is not. May throw std::bad_alloc.
bool isSurfacePair(const Query& query);

/// Whether the mesh may be flat ground to another one: some of its neighbouring triangles lie in one plane.
bool mayBeFlatGround(const CollisionMesh& mesh);

/// Of such a pair the same contacts, in the meshes' own numbers of triangles. They do not depend on the order of the
/// meshes, but for rounding. False for other pairs as well. Candidates and intersecting pairs stay as they are.
bool surfacePairContacts(const Query& query, Workspace& workspace);

/// The same with no candidates and no intersecting pairs.
bool collideSurfacePair(const Query& query, Workspace& workspace);

}  // namespace otg
