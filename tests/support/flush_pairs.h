// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids that share faces: one inside the other, both the same, or side by side.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"

namespace otg::test {

/// Two bodies in one frame, with coordinates that are floats exactly.
struct FlushPair {
  std::string what;
  scenes::MeshArrays first, second;
  bool nested = true;     ///< else they only touch,
  Vec3d point{};          ///< inside both, if they are nested; else inside the second
  bool onOneFace = true;  ///< in one plane, if they only touch
};

inline scenes::MeshArrays moved(scenes::MeshArrays mesh, const Vec3d& by) {
  for (Vec3f& v : mesh.vertices) {
    v = {static_cast<float>(v.x + by.x), static_cast<float>(v.y + by.y), static_cast<float>(v.z + by.z)};
  }
  return mesh;
}

inline std::vector<FlushPair> flushPairs() {
  using scenes::makeBox;
  const scenes::MeshArrays l = scenes::makeProfile({{0, 0}, {1, 0}, {1, 0.25}, {0.25, 0.25}, {0.25, 1}, {0, 1}}, 0.75);
  std::vector<FlushPair> pairs;
  for (const int n : {1, 3}) {
    const std::string of = n == 1 ? "" : ", subdivided";
    const scenes::MeshArrays outer = makeBox({2, 2, 2}, n);
    for (int faces = 1; faces <= 3; ++faces) {
      const Vec3d at{0.75, faces > 1 ? -0.75 : 0.125, faces > 2 ? 0.75 : -0.25};
      pairs.push_back({std::to_string(faces) + " faces of a box in a box" + of, outer,
                       moved(makeBox({0.5, 0.5, 0.5}), at), true, at});
    }
    pairs.push_back({"two equal boxes" + of, outer, outer, true, {0.1, 0.2, 0.3}});
    pairs.push_back(
        {"a box beside a box" + of, outer, moved(makeBox({1, 1, 1}), {0.25, 0.125, 1.5}), false, {0.25, 0.125, 1.5}});
  }
  pairs.push_back({"an L in a box", makeBox({2, 2, 2}), moved(l, {-1, -0.625, -1}), true, {-0.875, -0.5, -0.5}});
  pairs.push_back({"two equal Ls", l, l, true, {0.125, 0, 0.5}});
  pairs.push_back({"a box beside an L, in its corner",
                   l,
                   moved(makeBox({0.5, 0.5, 0.5}), {0.5, 0, 0.5}),
                   false,
                   {0.5, 0, 0.5},
                   false});
  const scenes::MeshArrays room = scenes::makeRoom({2, 2, 2}, 0.5);
  const Vec3f low = room.vertices[0];
  Vec3d least{low.x, low.y, low.z};
  for (const Vec3f& v : room.vertices) {
    least = {std::min<double>(least.x, v.x), std::min<double>(least.y, v.y), std::min<double>(least.z, v.z)};
  }
  const Vec3d inWall{least.x + 0.25, least.y + 1, least.z + 1};
  pairs.push_back({"a box as thick as a room's wall", room, moved(makeBox({0.5, 0.25, 0.25}), inWall), true, inWall});
  pairs.push_back({"a box in a room's wall, flush with the inner side",
                   room,
                   moved(makeBox({0.25, 0.25, 0.25}), {least.x + 0.375, inWall.y, inWall.z}),
                   true,
                   {least.x + 0.375, inWall.y, inWall.z}});
  // All of its vertices lie on the box.
  pairs.push_back({"a tetrahedron in a corner of a box",
                   makeBox({2, 2, 2}),
                   scenes::makeTetrahedron({-1, -1, -1}, {0, -1, -1}, {-1, 0, -1}, {-1, -1, 0}),
                   true,
                   {-0.875, -0.875, -0.875}});
  return pairs;
}

}  // namespace otg::test
