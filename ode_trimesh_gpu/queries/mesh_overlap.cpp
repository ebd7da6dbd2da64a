// SPDX-License-Identifier: BSD-3-Clause
#include "queries/mesh_overlap.h"

#include <vector>

#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/pair_frame.h"
#include "collide/rotation_tolerance.h"
#include "collide/solid/contour.h"
#include "collide/stages.h"

namespace otg {
namespace {

double sizeOf(const Vec3f& e) {
  return double{e.x} * e.y + double{e.y} * e.z + double{e.z} * e.x;
}

/// findMeeting() with the boxes of both meshes.
template <class Boxes>
bool findMeetingIn(const Query& query, const Boxes& boxesA, const Boxes& boxesB, TrianglePair& meeting) {
  const Array<BvhNode>&a = query.a->tree().nodes, &b = query.b->tree().nodes;
  if (a.empty() || b.empty()) return false;
  const PairFrame frame = makePairFrame(query);
  if (!frame.finite) return false;
  const auto apart = [&](const auto& x, const auto& y) {
    const Vec3f d = otgBoxCenterInA(frame.boxes, y.center) - x.center;
    return otgBoxGapA(d, x.extent, otgBoxExtentInA(frame.boxes, y.extent)) > frame.boxes.eps ||
           otgBoxGapB(frame.boxes, d, x.extent, y.extent) > frame.boxes.eps;
  };
  CollideStats stats;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const BvhNode &x = a[i], &y = b[j];
    const auto& boxX = boxesA(x);
    const auto& boxY = boxesB(y);
    if (apart(boxX, boxY)) continue;
    if (x.isLeaf() && y.isLeaf()) {
      const TrianglePair pair{x.triangle(), y.triangle()};
      if (query.a->mesh().isDegenerate(pair.a) || query.b->mesh().isDegenerate(pair.b)) continue;
      if (decidePair(query, frame, pair, stats)) {
        meeting = pair;
        return true;
      }
    } else if (y.isLeaf() || (!x.isLeaf() && sizeOf(boxX.extent) >= sizeOf(boxY.extent))) {
      for (const int side : {1, 0}) stack.emplace_back(static_cast<std::uint32_t>(x.child + side), j);
    } else {
      for (const int side : {1, 0}) stack.emplace_back(i, static_cast<std::uint32_t>(y.child + side));
    }
  }
  return false;
}

}  // namespace

bool findMeeting(const Query& query, TrianglePair& meeting) {
  return withBoxes(query.a->boxScale(), query.b->boxScale(), [&](const auto& boxesA, const auto& boxesB) {
    return findMeetingIn(query, boxesA, boxesB, meeting);
  });
}

bool containedVertex(const Query& query, Vec3d& vertex) {
  const PlacedMeshes meshes(query);
  for (const int m : {0, 1}) {
    if (!meshes.isSolid(1 - m)) continue;
    const Vec3f &low = meshes.mesh(1 - m).boundsMin(), &high = meshes.mesh(1 - m).boundsMax();
    const double slack = 1e-9 * double{meshes.mesh(1 - m).radius()};
    for (const std::uint32_t v : meshes.adjacency(m).componentVertex) {
      if (v == kNone) continue;
      const Vec3d placed = meshes.vertex(m, v), p = meshes.toLocal(1 - m, placed);
      const bool inBounds = p.x >= low.x - slack && p.y >= low.y - slack && p.z >= low.z - slack &&
                            p.x <= high.x + slack && p.y <= high.y + slack && p.z <= high.z + slack;
      if (inBounds && vertexInside(meshes, 1 - m, placed)) {
        vertex = placed;
        return true;
      }
    }
  }
  return false;
}

bool overlap(const Query& query) {
  requireRigid(query.bInA);
  TrianglePair meeting{};
  Vec3d vertex{};
  return findMeeting(query, meeting) || containedVertex(query, vertex);
}

}  // namespace otg
