// SPDX-License-Identifier: BSD-3-Clause
// The pairs of `otg bench batch`.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "collide/query.h"

namespace otg::cli {

/// A generator whose values are the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform(0, static_cast<double>(n))); }
  Vec3d direction() {
    for (;;) {
      const Vec3d v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const double squared = otgDot(v, v);
      if (squared > 0.01 && squared < 1) return otgScale(v, 1 / std::sqrt(squared));
    }
  }

 private:
  std::uint64_t state_;
};

using BodyList = std::vector<std::shared_ptr<const CollisionMesh>>;

/// Contacts that are requested of each pair.
inline constexpr int kBatchContacts = 16;

/// Bodies of radius about 1 and 200 to 6,000 triangles,
BodyList batchBodies();
/// and `pairs` of them: three quarters are at `nearer` times the distance at which they touch, one quarter is 0.4%
/// apart.
std::vector<Query> batchQueries(const BodyList& bodies, int pairs, double nearer = 0.98);

/// Bodies of 5,120 triangles, whose overlaps at 0.8 of that distance have regions that are described by cells.
BodyList overlapBodies();

/// Bodies of 200 to 20,000 triangles: for pairs that overlap deeply.
BodyList denseBodies();

/// A bolt M16 x 2 and its nut: 31,872 and 11,000 triangles,
BodyList nutAndBolt();
/// and the nut screwed on, turned anyhow and pressed against one flank of the thread.
std::vector<Query> nutBoltQueries(const BodyList& bodies, int pairs);

/// Boxes of 12 to 48 triangles,
BodyList stackBodies();
/// and such upon each other, ten to a stack, as simulations begin and as solvers leave them: most of them aligned, some
/// beside the middle, some turned, sunk in by a hundredth of a millimetre, a third of them trembling.
std::vector<Query> stackQueries(const BodyList& boxes, int pairs);

/// An uneven terrain of 20,000 triangles (an open mesh, 40 m wide), and after it those bodies,
BodyList terrainBodies();
/// each lowered on the terrain somewhere: three quarters overlap by 2% of their size, one quarter is 0.4% above. Some
/// two in a hundred lie over the rim.
std::vector<Query> terrainQueries(const BodyList& bodies, int pairs);

}  // namespace otg::cli
