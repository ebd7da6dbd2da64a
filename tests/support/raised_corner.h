// SPDX-License-Identifier: BSD-3-Clause
// A block whose top is two triangles, of which one rises to a corner, and boxes upon it.
#pragma once

#include <algorithm>
#include <cmath>

#include "scenes/generated_meshes.h"
#include "support/draw.h"

namespace otg::test {

/// 2 wide and 1 high, about the z axis; the top is at z = 0 but for one corner.
inline scenes::MeshArrays makeRaisedCorner(float height) {
  scenes::MeshArrays block;
  block.vertices = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                    {-1, -1, 0},  {1, -1, 0},  {1, 1, 0},  {-1, 1, height}};
  block.triangles = {{{4, 5, 6}}, {{4, 6, 7}}, {{0, 2, 1}}, {{0, 3, 2}}, {{0, 1, 5}}, {{0, 5, 4}},
                     {{1, 2, 6}}, {{1, 6, 5}}, {{2, 3, 7}}, {{2, 7, 6}}, {{3, 0, 4}}, {{3, 4, 7}}};
  return block;
}
/// How high its top is.
inline double heightOfTop(double x, double y, double height) {
  return std::max(0.0, 0.5 * height * (y - x));
}

/// An upright box of these half sides that is `depth` below the flat part of the top, and within the top.
inline Transformd drawBoxPose(Draw& draw, const Vec3d& half, double depth) {
  const double reach = std::hypot(half.x, half.y), room = std::max(0.0, 0.99 - reach);
  const Vec3d at{draw.uniform(-room, room), draw.uniform(-room, room), half.z - depth};
  return makePose({0, 0, 1}, draw.uniform(0, 6.28), at);
}

}  // namespace otg::test
