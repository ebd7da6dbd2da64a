// SPDX-License-Identifier: BSD-3-Clause
// A plate on four posts: the corners of its lower face lie in one post each, and all between them is outside.
#pragma once

#include <algorithm>
#include <vector>

#include "scenes/generated_meshes.h"
#include "support/draw.h"

namespace otg::test {

/// Posts 1 wide and 1 apart, about the z axis on a floor, in one component. Their tops are at z = 0. `finer` cuts the
/// middle of each triangle of the tops into 3 to that power.
inline scenes::MeshArrays makePosts(int finer) {
  const auto isFull = [](int x, int y, int z) { return z == 0 || (x != 1 && y != 1); };
  scenes::MeshArrays posts =
      scenes::transformed(scenes::makeCubes(3, isFull), makePose({0, 0, 1}, 0, {-1.5, -1.5, -3}));
  const auto at = [&](std::uint32_t v) { return posts.vertices[v]; };
  const auto addVertex = [&](float x, float y) {
    posts.vertices.push_back({x, y, 0});
    return static_cast<std::uint32_t>(posts.vertices.size() - 1);
  };
  std::vector<std::size_t> middles;
  const std::size_t count = finer > 0 ? posts.triangles.size() : 0;
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle outer = posts.triangles[t];
    if (std::any_of(outer.v, outer.v + 3, [&](std::uint32_t v) { return at(v).z != 0; })) continue;
    const float x = (at(outer.v[0]).x + at(outer.v[1]).x + at(outer.v[2]).x) / 3;
    const float y = (at(outer.v[0]).y + at(outer.v[1]).y + at(outer.v[2]).y) / 3;
    Triangle inner{};
    for (int k = 0; k < 3; ++k) inner.v[k] = addVertex((at(outer.v[k]).x + x) / 2, (at(outer.v[k]).y + y) / 2);
    posts.triangles[t] = inner;
    middles.push_back(t);
    for (int k = 0, next = 1; k < 3; ++k, next = (k + 1) % 3) {
      posts.triangles.push_back({{outer.v[k], outer.v[next], inner.v[next]}});
      posts.triangles.push_back({{outer.v[k], inner.v[next], inner.v[k]}});
    }
  }
  for (int k = 0; k < finer; ++k) {
    for (std::size_t i = 0, end = middles.size(); i < end; ++i) {
      const Triangle old = posts.triangles[middles[i]];
      const float x = (at(old.v[0]).x + at(old.v[1]).x + at(old.v[2]).x) / 3;
      const float y = (at(old.v[0]).y + at(old.v[1]).y + at(old.v[2]).y) / 3;
      const std::uint32_t middle = addVertex(x, y);
      posts.triangles[middles[i]].v[2] = middle;
      for (int side = 1; side < 3; ++side) {
        middles.push_back(posts.triangles.size());
        posts.triangles.push_back({{old.v[side], old.v[(side + 1) % 3], middle}});
      }
    }
  }
  return posts;
}

/// Two triangles a face; its corners are on the posts. The lower face is at z = 0.
inline scenes::MeshArrays makePlate() {
  return scenes::transformed(scenes::makeBox({2.8, 2.8, 0.2}, 1), makePose({0, 0, 1}, 0, {0, 0, 0.1}));
}

/// Of the plate, some of whose corners are in posts.
inline Transformd drawPlatePose(Draw& draw) {
  const Vec3d place{draw.uniform(-0.05, 0.05), draw.uniform(-0.05, 0.05), draw.uniform(-0.02, 0)};
  const double angle = draw.uniform(0, 0.02);
  return makePose(draw.direction(), angle, place);
}

}  // namespace otg::test
