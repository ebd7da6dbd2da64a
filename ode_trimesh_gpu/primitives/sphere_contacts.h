// SPDX-License-Identifier: BSD-3-Clause
// A mesh against a sphere.
#pragma once

#include <vector>

#include "collide/query.h"
#include "primitives/round_memory.h"

namespace otg {

/// The contacts of a sphere with a mesh, in the mesh's frame; the normal pushes the mesh. A place of contact is a local
/// minimum of the distance from the sphere's centre to the surface that is less than the radius: a point in a face, on
/// an edge or at a corner whose other triangles are no nearer. So an edge inside a flat or convex surface gives no
/// normal of its own, and a groove gives one for each of its sides. Minima whose normals are within 3 degrees of a
/// deeper one are the same place. The depth is the radius less the distance.
///
/// With the centre inside a solid, or behind a sheet, there is one contact: out through the nearest point of the
/// surface, with the distance added to the radius. Faces that show their back to the centre count for a shell alone,
/// which has no inside, and where the sphere came from behind a sheet.
///
/// With a solid that has inner corners, walls that are met on the way out are named, too (round_ahead.h).
///
/// Contacts are appended, deepest first. The sphere has no triangles (kNone).
void sphereContacts(const CollisionMesh& mesh, const Vec3d& center, double radius, RoundMemory& before,
                    std::vector<Contact>& out);

}  // namespace otg
