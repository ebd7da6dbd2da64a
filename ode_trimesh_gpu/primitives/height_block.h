// SPDX-License-Identifier: BSD-3-Clause
// A rectangular block of a field of heights as a closed mesh.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

/// Heights along y over a grid in x and z, as ODE's heightfields have them.
struct HeightBlock {
  int columns = 0, rows = 0;    ///< samples along x and along z, at least two each
  double columnWidth = 0;       ///< from one sample to the next along x
  double rowDepth = 0;          ///< and along z
  std::vector<double> heights;  ///< of sample (i, j) at i + j * columns
  double bottom = 0;            ///< below all heights

  double at(int i, int j) const {
    return heights[static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns)];
  }
};

/// A closed mesh and where its frame's origin lies in the block's, in which sample (0, 0) is at x = z = 0.
struct HeightBlockMesh {
  std::shared_ptr<const CollisionMesh> mesh;  ///< null for heights that single precision cannot hold
  Vec3d origin{0, 0, 0};
};

/// The ground of the block: the surface, walls down from its four edges, and a bottom. Each cell of the grid is cut
/// from (i + 1, j) to (i, j + 1), which is how ODE cuts it. Triangles 0 to 2 (columns - 1) (rows - 1) - 1 are the
/// surface, two to a cell, cells row by row; outward is up. The mesh's own origin is in the middle of the block, at the
/// height of the sample there. So its coordinates are as small as they can be. May throw std::bad_alloc.
HeightBlockMesh meshOfBlock(const HeightBlock& block);

/// The same of other heights in a block of the same size with the same bottom: refitted.
HeightBlockMesh moveBlock(const HeightBlock& block, const CollisionMesh& before);

}  // namespace otg
