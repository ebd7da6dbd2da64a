// SPDX-License-Identifier: BSD-3-Clause
// What the contacts of convex pairs are made in: memory that is kept from query to query.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/math/vec3.h"

namespace otg {

/// A corner of one face cut by the sides of the other. Each edge of the polygon is one of the first face (the incident
/// one) or one of the second (the reference).
struct ClippedPoint {
  Vec3d at;            ///< in the incident face
  std::uint32_t edge;  ///< from here to the next point: ConvexPolyhedron::corner
  bool ofReference;    ///< of the reference
};

/// A place that may become a contact.
struct ConvexPlace {
  Vec3d at;
  double depth;
  double spread;                   ///< squared distance to the chosen ones
  double rank;                     ///< of places as deep and of one kind the smallest goes first
  std::uint32_t cornerA, cornerB;  ///< where the search for the triangles begins
  std::uint32_t element, ordinal;
  std::uint8_t feature;  ///< ContactFeature
  std::uint8_t step;     ///< of depth below the deepest
  bool isEnd;            ///< of a line along which a body lies: kept however shallow it is
};

struct ConvexScratch {
  std::vector<ClippedPoint> polygon, next;
  std::vector<ConvexPlace> places;
};

}  // namespace otg
