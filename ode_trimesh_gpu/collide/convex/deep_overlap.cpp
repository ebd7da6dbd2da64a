// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/deep_overlap.h"

#include "base/vectors.h"
#include "collide/solid/escape.h"
#include "collide/solid/solid_contacts.h"

namespace otg {
namespace {

constexpr double kSameWay = 0.9;          ///< cosine from which on a direction is that of the last query
constexpr double kAgainstApproach = 0.5;  ///< cosine from which on it undoes the approach

}  // namespace

bool endsByLeastWay(const Query& query, const Vec3d& normal) {
  const PairMotion motion = motionBefore(query);
  if (otgDot(motion.deepNormal, motion.deepNormal) > 0) return otgDot(motion.deepNormal, normal) >= kSameWay;
  return !(otgDot(motion.back, motion.back) > 0) || otgDot(motion.back, normal) >= kAgainstApproach;
}

}  // namespace otg
