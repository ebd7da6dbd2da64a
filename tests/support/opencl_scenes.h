// SPDX-License-Identifier: BSD-3-Clause
// Named pairs of meshes that every traversal of the OpenCL backend is held against the host with.
#pragma once

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

}  // namespace otg::test
