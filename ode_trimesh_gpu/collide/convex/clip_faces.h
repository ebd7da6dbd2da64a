// SPDX-License-Identifier: BSD-3-Clause
// Where two faces that face each other overlap.
#pragma once

#include "collide/convex/clip_scratch.h"
#include "collide/convex/convex_pair.h"

namespace otg {

/// A face of each body, and whose is the one that the other is cut by.
struct FacingFaces {
  std::uint32_t face[2];
  int reference;
};

/// Seen along m: the part of the incident face within the sides of the reference -> scratch.polygon, in the order of
/// the incident face. Empty if there is none.
void clipFaces(const ConvexPair& pair, const Vec3d& m, const FacingFaces& faces, ConvexScratch& scratch);

/// The corner of scratch.polygon as a place between the two faces: its feature, and how deep the bodies overlap there
/// along m.
ConvexPlace placeOfPoint(const ConvexPair& pair, const Vec3d& m, const FacingFaces& faces,
                         const std::vector<ClippedPoint>& polygon, std::size_t i);

}  // namespace otg
