// SPDX-License-Identifier: BSD-3-Clause
// Named pairs of meshes that every traversal of the OpenCL backend is held against the host with.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/opencl.h"

namespace otg::test {

struct Scene {
  const char* name;
  scenes::MeshArrays a, b;
  Transformd bInA;
};

/// Touching, crossing, coplanar, nested, identical and far.
inline std::vector<Scene> makeScenes() {
  using namespace scenes;
  const Vec3d z = {0, 0, 1}, oblique = {0.48, 0.6, 0.64};
  const MeshArrays box = makeBox({1, 1, 1}, 1), fineBox = makeBox({1, 1, 1}, 8), lump = makeLump(1, 5, 0.2, 3);
  const MeshArrays torus = makeTorus(1, 0.3, 47, 23);
  return {
      {"boxes aligned", box, box, makeMove({0, 0, 0.999})},
      {"boxes touching", box, box, makeMove({0, 0, 1})},
      {"boxes turned", fineBox, fineBox, makePose(z, 0.5, {0, 0, 0.999})},
      {"corner in box", fineBox, fineBox, makePose(oblique, 1, {0.2, 0.1, 1.1})},
      {"box on a fine ground", makeGround(10, 1, 64), box, makeMove({0.3, 0.2, 0.4999})},
      {"sphere on itself", makeSphere(1, 4), makeSphere(1, 4), makeMove({0, 0, 0})},
      {"sphere in sphere", makeSphere(1, 4), makeSphere(0.5, 3), makeMove({0.1, 0, 0})},
      {"tori linked", torus, torus, makePose({1, 0, 0}, 1.5, {1.0, 0.45, 0})},
      {"lumps shallow", lump, makeLump(1, 5, 0.2, 8), makePose(oblique, 0.7, {1.7, 0.4, 0.1})},
      {"lumps deep", lump, makeLump(1, 5, 0.2, 8), makePose(oblique, 0.7, {0.6, 0.4, 0.1})},
      {"peg in hole", makeBlockWithHole({2, 2, 1}, 0.505), makeBox({0.5, 0.5, 2}, 4),
       makePose({0, 1, 0}, 0.02, {0.001, 0, 0.3})},
      {"tetrahedron in lump", lump, makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
       makePose(oblique, 2, {0.4, 0.3, 0.2})},
      {"apart", lump, lump, makeMove({10, 0, 0})},
      {"near miss", makeSphere(1, 5), makeSphere(1, 5), makeMove({2.0001, 0, 0})},
  };
}

/// Poses of boxes B, by quarter turns or turned about z, in which faces, edges or corners of both lie in one place:
/// upon each other on any side, flush or a little along, or by the least that there is not.
inline std::vector<Transformd> touchingPoses(const CollisionMesh& a, const CollisionMesh& b, std::uint32_t seed,
                                             int count) {
  const auto inDouble = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  const Vec3d lowA = inDouble(a.mesh().boundsMin()), highA = inDouble(a.mesh().boundsMax());
  Draw draw(seed);
  std::vector<Transformd> poses;
  for (int i = 0; i < count; ++i) {
    const bool aboutZ = i % 4 == 3;
    Transformd pose =
        aboutZ ? makePose({0, 0, 1}, draw.uniform(0, 3), {0, 0, 0}) : makeQuarterTurn(draw.below(24), {0, 0, 0});
    const Vec3d p = otgTransform(pose, inDouble(b.mesh().boundsMin())),
                q = otgTransform(pose, inDouble(b.mesh().boundsMax()));
    const double ownLow[3] = {std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)};
    const double ownHigh[3] = {std::max(p.x, q.x), std::max(p.y, q.y), std::max(p.z, q.z)};
    const double low[3] = {lowA.x, lowA.y, lowA.z}, high[3] = {highA.x, highA.y, highA.z};
    const std::uint32_t axis = aboutZ ? 2 : draw.below(3);
    double move[3];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t how = k == axis ? draw.below(2) : draw.below(5);
      move[k] = how == 0   ? high[k] - ownLow[k]
                : how == 1 ? low[k] - ownHigh[k]
                : how == 2 ? high[k] - ownHigh[k]
                : how == 3 ? 0.125 * draw.below(7) - 0.375
                           : draw.uniform(-0.3, 0.3);
    }
    if (i % 5 == 4) move[axis] += 0x1p-52;
    pose.t = {move[0], move[1], move[2]};
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace otg::test
