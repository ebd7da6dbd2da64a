// SPDX-License-Identifier: BSD-3-Clause
// From the places where two convex bodies may touch to contacts.
#pragma once

#include "collide/convex/clip_scratch.h"
#include "collide/query.h"
#include "mesh/convex_polyhedron.h"

namespace otg {

/// Of a body's width: an overlap that is deeper may end by other ways than the least one as well.
inline constexpr double kMostShallow = 0.5;

/// Cosine of 4 degrees: a face so near to the normal touches as a face.
inline constexpr double kTouchesAsFace = 0.9976;
/// The face with which a body touches what is ahead along a unit direction: the one at its farthest vertex that faces
/// most along it, or beside the flattest edge there, if the body lies on that. `along`: the cosine.
std::uint32_t touchingFace(const ConvexPolyhedron& shape, std::uint32_t vertex, const Vec3d& direction, double& along);

/// Leaves the deepest place and those that are well spread, without those that are shallow for their kind: at most
/// `most`, and at most eight. The deepest gets the depth `overlap`. There is at least one place.
void choosePlaces(std::vector<ConvexPlace>& places, int most, double overlap);

/// The deepest first. Ties follow the features.
void sortPlaces(std::vector<ConvexPlace>& places);

/// A contact of region 0 at a place, without triangles.
Contact& addContact(std::vector<Contact>& contacts, const ConvexPlace& place, const Vec3d& normal);

/// The triangle of a face below a point, seen along the face's normal: on over the edges that it is beyond, from the
/// triangle of a corner of the face. The point is in the mesh's frame.
std::uint32_t triangleAt(const ConvexPolyhedron& shape, const TriMesh& mesh, std::uint32_t corner, const Vec3d& point);

/// workspace.contacts -> workspace.reduced: at most as many as the query asks for.
void reduceConvexContacts(const Query& query, Workspace& workspace);

}  // namespace otg
