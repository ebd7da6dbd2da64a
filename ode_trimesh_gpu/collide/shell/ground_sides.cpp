// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shell/ground_sides.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "collide/mesh_ray.h"

namespace otg {

bool crossesOddly(const CollisionMesh& ground, const Vec3d& from, const Vec3d& to, double skip,
                  std::vector<double>& scratch) {
  const Vec3d along = otgSub(to, from);
  if (!(otgDot(along, along) > 0)) return false;
  scratch.clear();
  double limit = 1;
  forEachRayHit(ground, {from, along}, limit, [&](std::uint32_t, double distance, bool) {
    if (distance > skip) scratch.push_back(distance);
  });
  std::sort(scratch.begin(), scratch.end());
  constexpr double kSame = 1e-7;  // doubled faces, and the triangles of an edge
  std::size_t count = 0;
  for (std::size_t i = 0; i < scratch.size(); ++i) {
    if (i == 0 || scratch[i] - scratch[i - 1] > kSame) ++count;
  }
  return count % 2 == 1;
}

void GroundSides::setFront(const CollisionMesh& ground, const Vec3d& front, const Vec3d& middle, double slack) {
  isKnown_ = false;
  ground_ = &ground;
  front_ = front;
  middle_ = middle;
  slack_ = slack;
  known_.reset(ground.mesh().triangleCount());
}

int GroundSides::look(std::uint32_t triangle) {
  std::uint32_t known = known_.find(triangle);
  if (known == EpochArray::kMissing) {
    known = sideOf(triangle) > 0 ? 1 : 0;
    known_.set(triangle, known);
  }
  return known != 0 ? 1 : -1;
}

int GroundSides::sideOf(std::uint32_t triangle) {
  const TriMesh& mesh = ground_->mesh();
  const Topology& topology = mesh.topology();
  const std::vector<Vec3d>& normals = ground_->adjacency().normal;
  const Vec3d& n = normals[triangle];
  // Neighbours in a surface that is hardly bent have one front: this saves most rays.
  constexpr double kHardlyBent = 0.5;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t twin = topology.twin[3 * std::size_t{triangle} + k];
    if (twin == kNone || otgDot(normals[twin / 3], n) < kHardlyBent) continue;
    const std::uint32_t known = known_.find(twin / 3);
    if (known != EpochArray::kMissing) return known != 0 ? 1 : -1;
  }
  Vec3d p[3];
  for (int k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices()[mesh.triangles()[triangle].v[k]];
    p[k] = {v.x, v.y, v.z};
  }
  Vec3d from;
  const Vec3d middle = otgScale(otgAdd(otgAdd(p[0], p[1]), p[2]), 1.0 / 3);
  // Near the front point little comes in between; but off the edges, where neighbours are met as well.
  if (otgNearestOnTriangle(p[0], p[1], p[2], front_, &from) != OTG_PART_FACE) {
    from = otgAdd(from, otgScale(otgSub(middle, from), 0.25));
  }
  Vec3d along = otgSub(front_, from);
  const auto lies = [&] { return otgDot(along, n) / std::max(norm(along), slack_); };
  if (std::fabs(lies()) < 0.01) {  // seen from the edge
    from = middle;
    along = otgSub(front_, from);
  }
  const int facing = lies() < 0 ? -1 : 1;
  const double skip = std::min(1.0, slack_ / std::max(norm(along), slack_));
  const bool isOdd = crossesOddly(*ground_, from, front_, skip, scratch_);
  if (!scratch_.empty() && ground_->mesh().report().boundaryEdges > 0) {
    return otgDot(otgSub(middle_, from), n) < 0 ? -1 : 1;
  }
  return isOdd ? -facing : facing;
}

}  // namespace otg
