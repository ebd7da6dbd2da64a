// SPDX-License-Identifier: BSD-3-Clause
// A sheet of hills, and meshes as queries take them.
#pragma once

#include <cmath>
#include <memory>

#include "bvh/collision_mesh.h"
#include "scenes/generated_meshes.h"
#include "scenes/height_grid.h"

namespace otg::test {

inline std::shared_ptr<const CollisionMesh> meshOf(const scenes::MeshArrays& arrays) {
  return std::make_shared<const CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
}

/// An open sheet of 8 x 8.
inline scenes::MeshArrays hills(int cells, double height) {
  scenes::HeightGrid grid;
  grid.sizeX = grid.sizeY = 8;
  grid.columns = grid.rows = cells + 1;
  scenes::setHeights(grid, [&](double x, double y) { return height * std::sin(1.7 * x + 1) * std::cos(1.3 * y); });
  return scenes::sheetOf(grid);
}

}  // namespace otg::test
