// SPDX-License-Identifier: BSD-3-Clause
// Pairs of meshes for tests of distances.
#pragma once

#include <cmath>
#include <vector>

#include "support/contact_samples.h"
#include "support/draw.h"
#include "support/mesh_samples.h"

namespace otg::samples {

/// Few triangles each: bodies, an open mesh, slivers, many of the same, one, and such far from their origin.
inline std::vector<NamedMesh> meshesForDistances() {
  std::vector<NamedMesh> meshes;
  meshes.push_back({"lump", scenes::build(scenes::makeLump(1, 2, 0.3, 7))});
  meshes.push_back({"box", scenes::build(scenes::makeBox({1, 1.5, 0.5}, 3))});
  scenes::MeshArrays open = scenes::makeTorus(0.8, 0.3, 14, 8);
  open.triangles.resize(open.triangles.size() / 2);
  meshes.push_back({"half a torus", scenes::build(open)});
  meshes.push_back({"soup", randomSoup(3, 150, 1, 0.3f)});
  Soup slivers, copies, one;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 150; ++i) {
    const Vec3f p{unit(random), unit(random), unit(random)}, q{unit(random), unit(random), unit(random)};
    const float t = 0.5f + 0.5f * unit(random), hair = std::ldexp(1.0f, -4 - i % 20);
    slivers.add(p, q,
                {p.x + t * (q.x - p.x) + hair * unit(random), p.y + t * (q.y - p.y) + hair * unit(random),
                 p.z + t * (q.z - p.z) + hair * unit(random)});
  }
  for (int i = 0; i < 60; ++i) copies.addAt({0.1f, 0.2f, 0.3f}, 0.5f);
  one.addAt({0.2f, -0.1f, 0}, 0.7f);
  meshes.push_back({"slivers", slivers.build()});
  meshes.push_back({"copies of one triangle", copies.build()});
  meshes.push_back({"one triangle", one.build()});
  scenes::MeshArrays away = scenes::makeLump(1, 2, 0.3, 5);
  for (Vec3f& v : away.vertices) v = {v.x + 3e3f, v.y - 1e3f, v.z + 2e2f};
  meshes.push_back({"a solid far from its origin", scenes::build(away)});
  return meshes;
}

/// B somewhere about A: near, apart, far; turned, along A's axes, and upright above it, where faces are parallel.
inline Transformd poseForDistance(const TriMesh& a, const TriMesh& b, test::Draw& draw, int i) {
  const auto toDouble = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  const double size = double{a.radius()} + double{b.radius()};
  const Vec3d way = i % 3 == 2 ? Vec3d{0, 0, 1} : draw.direction();
  const double distance = (i % 4 == 0 ? 0.5 : i % 4 == 1 ? 0.9 : i % 4 == 2 ? 1.3 : 20.0) * size;
  Transformd pose = i % 3 == 0 ? Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}}
                               : test::makePose(draw.direction(), i % 3 == 2 ? 0 : draw.uniform(-3, 3), {0, 0, 0});
  pose.t = {0, 0, 0};
  const Vec3d at = otgTransform(pose, toDouble(b.origin()));
  pose.t = otgAdd(toDouble(a.origin()), otgSub(otgScale(way, distance), at));
  return pose;
}

}  // namespace otg::samples
