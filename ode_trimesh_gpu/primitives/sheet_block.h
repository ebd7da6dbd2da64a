// SPDX-License-Identifier: BSD-3-Clause
// A part of an open mesh as a closed one, with what lies behind it filled.
#pragma once

#include <memory>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

struct SheetBlock {
  std::shared_ptr<const CollisionMesh> mesh;  ///< in the sheet's frame; null if there is none
  std::vector<std::uint32_t> triangleOf;      ///< of each of its triangles the sheet's one that it comes from
};

/// The triangles of a sheet near a box, and a copy moved back along their mean normal by `depth`. Walls join both along
/// edges that only one triangle has. `frame` takes the box's own frame, in which it is centred, to the sheet's. So a
/// rim is an edge with a wall below it, as a box has. None where a triangle leans by more than 84 degrees from the
/// mean. May throw std::bad_alloc.
SheetBlock sheetBlock(const CollisionMesh& sheet, const Transformd& frame, const Vec3d& half, double depth);

}  // namespace otg
