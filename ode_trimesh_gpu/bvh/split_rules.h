// SPDX-License-Identifier: BSD-3-Clause
// How a set of triangles is parted in two: the steps that the build strategies are made of.
#pragma once

#include "bvh/mesh_box.h"

namespace otg {

/// The triangles of one subtree during the build: a window on two parallel arrays that splitting permutes, with room of
/// the same size to do it in. What ends up on which side depends on the boxes and triangle numbers alone, never on how
/// a standard library orders equal elements. So the tree is the same everywhere.
struct TriangleSet {
  MeshBox* boxes;
  std::uint32_t* triangles;
  MeshBox* roomForBoxes;
  std::uint32_t* roomForTriangles;
  std::uint32_t size;

  /// Moves those for which isLeft(box, triangle) holds to the front, keeps the order on both sides, and says how many
  /// went left. Every element is written to both sides and only the right place is kept: which side comes next is a
  /// coin toss, and a branch mispredicted every other time would be half the cost of a build.
  template <class Predicate>
  std::uint32_t partition(Predicate isLeft) {
    std::uint32_t left = 0, right = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      const MeshBox box = boxes[i];
      const std::uint32_t triangle = triangles[i];
      const std::uint32_t goesLeft = isLeft(box, triangle) ? 1 : 0;
      boxes[left] = roomForBoxes[right] = box;
      triangles[left] = roomForTriangles[right] = triangle;
      left += goesLeft;
      right += 1 - goesLeft;
    }
    std::copy(roomForBoxes, roomForBoxes + right, boxes + left);
    std::copy(roomForTriangles, roomForTriangles + right, triangles + left);
    return left;
  }
};

/// Each rule permutes `set` and returns how many triangles go left: 1 to size - 1, or 0 where the rule finds no split
/// (splitInHalves always does). Sets have at least two triangles; `centers` bounds the middles of their boxes.

/// The published rule: axis of greatest variance of the box centres, split at their mean.
std::uint32_t splitAtMean(TriangleSet set);
/// Surface-area heuristic: all splits of small sets, binned ones of large sets, over all three axes.
std::uint32_t splitBySah(TriangleSet set, const MeshBox& centers);
/// The lower half by order along the widest axis of the centres, ties by triangle number: linear time, and equal
/// centres part too.
std::uint32_t splitInHalves(TriangleSet set, const MeshBox& centers);

}  // namespace otg
