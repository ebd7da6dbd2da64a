// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/pair_roles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <optional>

namespace otg {
namespace {

/// Greater than zero if the first has the smaller radius, more triangles or the larger hash. Hashes are requested only
/// where nothing else distinguishes the meshes.
std::partial_ordering byContents(const CollisionMesh& first, const CollisionMesh& second) {
  const TriMesh &x = first.mesh(), &y = second.mesh();
  if (&x == &y) return std::partial_ordering::equivalent;
  if (const auto order = y.radius() <=> x.radius(); order != 0) return order;
  if (const auto order = x.triangleCount() <=> y.triangleCount(); order != 0) return order;
  return x.contentHash() <=> y.contentHash();
}

/// Less than zero if the first lies before the second.
std::partial_ordering byPose(const Transformd& first, const Transformd& second) {
  const std::array<double, 3> x{first.t.x, first.t.y, first.t.z}, y{second.t.x, second.t.y, second.t.z};
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (std::fabs(x[k] - y[k]) > std::fabs(x[axis] - y[axis])) axis = k;
  }
  if (x[axis] != y[axis]) return x[axis] <=> y[axis];
  return std::lexicographical_compare_three_way(std::begin(first.r), std::end(first.r), std::begin(second.r),
                                                std::end(second.r));
}

}  // namespace

bool isFirstMeshA(const MeshGeom& side1, const Transformd& pose1, const MeshGeom& side2, const Transformd& pose2,
                  bool remembers) noexcept {
  const bool firstIsOlder = side1.object->serial < side2.object->serial;
  if (remembers) {
    GeomObject& older = firstIsOlder ? *side1.object : *side2.object;
    GeomObject& younger = firstIsOlder ? *side2.object : *side1.object;
    const std::optional<bool> youngerWasA = younger.memory.holderWasA(older.serial, older.clearedAt);
    if (youngerWasA) return *youngerWasA != firstIsOlder;
  }
  if (const auto order = byContents(*side1.mesh, *side2.mesh); order != 0) return order > 0;
  if (const auto order = byPose(pose1, pose2); order != 0) return order < 0;
  return firstIsOlder;
}

}  // namespace otg
