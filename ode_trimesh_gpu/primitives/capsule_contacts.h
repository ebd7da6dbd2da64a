// SPDX-License-Identifier: BSD-3-Clause
// A mesh against a capsule whose axis the surface does not reach.
#pragma once

#include <vector>

#include "collide/query.h"
#include "primitives/round_memory.h"

namespace otg {

/// All points within `radius` of a segment, in the frame of the mesh.
struct Capsule {
  Vec3d middle, direction;  ///< the direction a unit vector
  double radius, half;      ///< half the length of the segment
};

/// The contacts of a capsule with a mesh, in the mesh's frame; the normal pushes the mesh. Returns false, and gives no
/// contacts, if the axis meets the surface or lies inside of it: such bodies are too deep in each other for what
/// follows.
///
/// A place of contact is a local minimum of the distance from the axis to the surface that is less than the radius: of
/// a face, an edge or a corner whose neighbours are no nearer (sphere_contacts.h). Its depth is the radius less the
/// distance, which for a convex surface is the least way out. Where a face or an edge runs along the axis, to
/// within 11.5 degrees, the ends of their common part are places as well. A capsule that lies on it is held at both. Of
/// contacts whose normals are within 3 degrees the deepest and the two outermost along the axis are kept; not the
/// deepest if these have its normal to within 0.1 degrees and its depth to within 2 %.
///
/// With a solid that has inner corners, walls that are met on the way out are named, too (round_ahead.h).
///
/// Contacts are appended, deepest first, positions in the middle of the overlap. The capsule has no triangles (kNone).
bool capsuleContacts(const CollisionMesh& mesh, const Capsule& capsule, RoundMemory& before, std::vector<Contact>& out);

}  // namespace otg
