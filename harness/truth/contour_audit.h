// SPDX-License-Identifier: BSD-3-Clause
// Whether the contact model `solid` finds on an overlap what must be there: closed contours, votes that agree, regions
// whose surfaces close.
#pragma once

#include "bvh/collision_mesh.h"
#include "mesh/tri_mesh.h"

namespace otg::truth {

struct ContourAudit {
  std::size_t crossings = 0;
  std::size_t openEnds = 0;    ///< crossings at which the contour begins or ends, or branches
  std::size_t openOnRims = 0;  ///< those of them that lie on an edge of one triangle only
  std::size_t anomalies = 0;   ///< pairs, edges and votes that contradict each other, of all steps
  std::size_t regions = 0;     ///< connected overlaps
  std::size_t badRegions = 0;  ///< of these: surface does not close, or volume is negative
  bool fallsBack = false;      ///< `solid` refuses the pair, which gets contacts of shells
  std::size_t contacts = 0;    ///< of `solid`
};

/// One overlap of a solid with a solid or a sheet. Crossings are counted here and not by the library's own check.
ContourAudit auditContour(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA);

}  // namespace otg::truth
