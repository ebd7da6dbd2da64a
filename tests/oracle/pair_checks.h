// SPDX-License-Identifier: BSD-3-Clause
// Comparing the library's pairs of intersecting triangles with CGAL's.
#pragma once

#include <memory>

#include "collide/query.h"
#include "oracle/cgal_oracle.h"
#include "support/catch.h"

namespace otg::test {

/// A mesh with the trees of both build strategies.
struct BothTrees {
  std::shared_ptr<const CollisionMesh> sah, mean;
  explicit BothTrees(const std::shared_ptr<const TriMesh>& mesh)
      : sah(std::make_shared<const CollisionMesh>(mesh, BuildStrategy::kSah)),
        mean(std::make_shared<const CollisionMesh>(mesh, BuildStrategy::kMeanSplit)) {}
  const TriMesh& mesh() const { return sah->mesh(); }
};

/// Traversals x descent rules x axes x build strategies.
inline constexpr unsigned kVariants = 4 * 4 * 2 * 2;

inline std::vector<TrianglePair> pairsOf(const BothTrees& a, const BothTrees& b, const Transformd& pose,
                                         unsigned variant) {
  Query query;
  query.options.middle.traversal = static_cast<Traversal>(variant % 4);
  query.options.middle.descent = static_cast<DescentRule>(variant / 4 % 4);
  query.options.middle.axes = variant / 16 % 2 ? 15 : 6;
  query.a = variant / 32 % 2 ? a.mean.get() : a.sah.get();
  query.b = variant / 32 % 2 ? b.mean.get() : b.sah.get();
  query.bInA = pose;
  Workspace workspace;
  findIntersectingPairs(query, workspace);
  return workspace.intersecting;
}

/// All pairs as candidates: what the narrow phase says without a mid phase before it.
inline std::vector<TrianglePair> pairsWithoutTrees(const BothTrees& a, const BothTrees& b, const Transformd& pose) {
  Query query;
  query.a = a.sah.get();
  query.b = b.sah.get();
  query.bInA = pose;
  Workspace workspace;
  for (std::uint32_t i = 0; i < a.mesh().triangleCount(); ++i) {
    for (std::uint32_t j = 0; j < b.mesh().triangleCount(); ++j) workspace.candidates.push_back({i, j});
  }
  nearPhase(query, workspace);
  return workspace.intersecting;
}

/// Compares one pose in one variant; returns how many pairs there are.
inline std::size_t checkPose(const BothTrees& a, const BothTrees& b, const Transformd& pose, unsigned variant) {
  const std::vector<TrianglePair> expected = cgalPairs(a.mesh(), b.mesh(), pose);
  const std::vector<TrianglePair> found = pairsOf(a, b, pose, variant);
  INFO("variant " << variant << ", " << expected.size() << " pairs expected, " << found.size() << " found");
  CHECK((found == expected));
  return expected.size();
}

/// The same in all variants.
inline std::size_t checkPoseInAllVariants(const BothTrees& a, const BothTrees& b, const Transformd& pose) {
  const std::vector<TrianglePair> expected = cgalPairs(a.mesh(), b.mesh(), pose);
  for (unsigned variant = 0; variant < kVariants; ++variant) {
    const std::vector<TrianglePair> found = pairsOf(a, b, pose, variant);
    INFO("variant " << variant << ", " << expected.size() << " pairs expected, " << found.size() << " found");
    CHECK((found == expected));
  }
  return expected.size();
}

}  // namespace otg::test
