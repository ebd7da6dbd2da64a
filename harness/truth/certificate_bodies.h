// SPDX-License-Identifier: BSD-3-Clause
// Closed bodies with inner corners, for families of random pairs.
#pragma once

#include <array>
#include <vector>

#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"

namespace otg::truth {

struct Point2 {
  double x, y;
};

/// A simple polygon, counter-clockwise, as a prism along z from -depth / 2 to depth / 2.
scenes::MeshArrays extruded(const std::vector<Point2>& outline, double depth);

/// Cells of a grid with the given lines; `filled(i, j, k)` says which of them are solid. Faces between solid and empty
/// cells are two triangles each, none of them merged. Throws std::logic_error where cells meet in an edge or corner
/// only, which no manifold has.
using Lines = std::array<std::vector<double>, 3>;
scenes::MeshArrays cellUnion(const Lines& lines, const std::function<bool(int, int, int)>& filled);

/// A connected union of cells that grows at random until a part `share` of all is solid. Closed and manifold.
scenes::MeshArrays randomCells(Random& random, int cellsPerSide, double size, double share);

/// A box of n x n cells a side whose inner vertices are moved in or out by up to `amplitude`.
scenes::MeshArrays dentedBox(Random& random, const Vec3d& size, int n, double amplitude);

scenes::MeshArrays scaled(const scenes::MeshArrays& mesh, double factor);

/// Full side lengths of the bounding box.
Vec3d extentOf(const scenes::MeshArrays& mesh);

}  // namespace otg::truth
