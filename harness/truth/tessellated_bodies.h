// SPDX-License-Identifier: BSD-3-Clause
// Convex bodies by formula beside fine meshes of them, and what the contacts of two such meshes should be.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scenes/generated_meshes.h"
#include "truth/contact_errors.h"
#include "truth/contact_families.h"
#include "truth/convex_separation.h"

namespace otg::truth {

ConvexBody ballBody(double radius);
ConvexBody boxBody(const Vec3d& half);
ConvexBody capsuleBody(double radius, double halfLength);
ConvexBody cylinderBody(double radius, double halfHeight);
/// A convex mesh as the polyhedron that it is.
ConvexBody polyhedronBody(const scenes::MeshArrays& mesh);

struct TessellatedBody {
  std::string name;
  ConvexBody body;
  scenes::MeshArrays mesh;
  double sagitta = 0;  ///< how far the mesh is from the body's surface at most
};

/// Sphere, box, capsule, cylinder and a polyhedron of 20 faces, each in two sizes: about 1 across, and about 0.6.
std::vector<TessellatedBody> largeBodies();
std::vector<TessellatedBody> smallBodies();

/// Whether two different directions are nearly as good: some way out at least kApartDegrees from the shortest is no
/// more than kAmbiguous of it longer, but for what the facets may change.
inline constexpr double kApartDegrees = 20, kAmbiguous = 0.1;
bool isAmbiguous(const TessellatedBody& a, const TessellatedBody& b, const WaysApart& ways);

/// One overlap of the two meshes, and what is known of it by formula.
struct TessellatedPose {
  Transformd bInA{};
  WaysApart ways;
  bool ambiguous = false;
};
/// Turned anyhow, the second one from the first in any direction; the shortest way apart is drawn from [least, most],
/// each of its powers of ten as often as the others.
TessellatedPose drawPose(const TessellatedBody& a, TessellatedBody b, Random& random, double least, double most);

/// What the deepest contacts of a pair of meshes say, over many poses.
struct TessellatedErrors {
  int poses = 0, ambiguous = 0;
  int missed = 0;      ///< poses without contacts though the overlap is more than the facets explain
  Errors depth;        ///< |depth - least way out|
  Errors longer;       ///< by how much the way out along the normal is longer than the least
  Errors degrees;      ///< between the normal and the direction of the least, where that is not ambiguous
  Errors depthBeside;  ///< |depth - way out along the normal|
};
struct TessellatedRange {
  double least = 0.001, most = 0.1;
  int poses = 1000;
  std::uint32_t seed = 1;
};
/// Of the contact model `solid`. `look` gets each pose and its deepest contact.
using TessellatedLook = std::function<void(const TessellatedPose&, const Contact& deepest)>;
TessellatedErrors compareMeshes(const TessellatedBody& a, const TessellatedBody& b, const TessellatedRange& range,
                                const TessellatedLook& look = {});

}  // namespace otg::truth
