// SPDX-License-Identifier: BSD-3-Clause
// Whether a mesh is the surface of a convex body.
#pragma once

#include <cstdint>

#include "mesh/tri_mesh.h"

namespace otg {

enum class Convexity : std::uint8_t {
  kNone,        ///< no convex body, or the mesh says too little
  kToRounding,  ///< some edges are concave, by no more than the vertices' rounding
  kExact
};

/// How far a vertex may be above the plane of a face, in the mesh's units: four units in the last place of the mesh's
/// largest coordinate. Vertices of a polyhedron that were rounded to float are not farther than that.
double roundingOfVertices(const TriMesh& mesh);

/// kExact is decided in exact arithmetic on the mesh's vertices: no edge is concave, and a point inside sees every
/// triangle once. A mesh of several components, one that is no solid, and one with a triangle without area are kNone.
///
/// kToRounding is a promise about edges alone: across each concave one the next vertex is above the triangle's plane by
/// at most roundingOfVertices(). Linear time; a mesh that is not convex is mostly found out after a few triangles.
///
/// Source: K. Mehlhorn et al., "Checking geometric programs or verification of geometric structures", 1996.
Convexity convexityOf(const TriMesh& mesh);

}  // namespace otg
