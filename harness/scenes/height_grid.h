// SPDX-License-Identifier: BSD-3-Clause
// Ground given by heights on a grid, z up: what a heightfield of a scene is, as plain data.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "scenes/generated_meshes.h"

namespace otg::scenes {

/// Its middle is the origin. Sample (i, j), i along x and j along y, lies at heights[j * columns + i].
struct HeightGrid {
  double sizeX = 0, sizeY = 0;  ///< from the first sample to the last one
  int columns = 0, rows = 0;    ///< at least 2 each
  std::vector<float> heights;
  double thickness = 1;  ///< solid below the lowest sample
  bool wraps = false;    ///< goes on for ever in all directions

  double x(int i) const { return sizeX * (static_cast<double>(i) / (columns - 1) - 0.5); }
  double y(int j) const { return sizeY * (static_cast<double>(j) / (rows - 1) - 0.5); }
  float at(int i, int j) const { return heights[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + i]; }
};

/// Fills in the heights.
void setHeights(HeightGrid& grid, const std::function<double(double x, double y)>& height);
/// Uneven ground fixed by `seed`: heights within `height` of 0, smooth over `length`, with finer unevenness on it.
void setRoughHeights(HeightGrid& grid, double height, double length, std::uint32_t seed);

/// The surface as an open mesh of the triangles that ODE's collider cuts the field into (see fieldSamples()).
MeshArrays sheetOf(const HeightGrid& grid);

/// The same with walls and a bottom, which is flat and `depth` below z = 0: closed.
MeshArrays solidOf(const HeightGrid& grid, double depth);

/// The samples in ODE's order, whose heights are along y: with its x axis where ours is and its y axis along our z, its
/// z axis points against our y.
std::vector<float> fieldSamples(const HeightGrid& grid);

}  // namespace otg::scenes
