// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/deep_overlap.h"

#include "base/vectors.h"
#include "collide/solid/escape.h"
#include "collide/solid/solid_contacts.h"

namespace otg {
namespace {

constexpr double kSameWay = 0.9;          ///< cosine from which on a direction is that of the last query
constexpr double kAgainstApproach = 0.5;  ///< cosine from which on it undoes the approach

constexpr double kOnFace = 1e-9;  ///< sine of the angle by which a place on a face may lie outside for rounding

}  // namespace

bool endsByLeastWay(const Query& query, const Vec3d& normal) {
  const PairMotion motion = motionBefore(query);
  if (otgDot(motion.escape, motion.escape) > 0) return otgDot(motion.escape, normal) >= kSameWay;
  if (otgDot(motion.deepNormal, motion.deepNormal) > 0) return otgDot(motion.deepNormal, normal) >= kSameWay;
  return !(otgDot(motion.back, motion.back) > 0) || otgDot(motion.back, normal) >= kAgainstApproach;
}

bool isContained(const ConvexPair& pair) {
  for (const int body : {0, 1}) {
    const ConvexPolyhedron& around = pair.body(1 - body);
    bool isInside = true;
    for (std::uint32_t f = 0; isInside && f < around.faceCount(); ++f) {
      const Vec3d normal = pair.normal(1 - body, f);
      const Vec3d onFace = pair.place(1 - body, around.corner(around.face(f).corner).vertex);
      const Vec3d outermost = pair.place(body, pair.farthest(body, normal)) - onFace;
      isInside = otgDot(normal, outermost) <= kOnFace * norm(outermost);
    }
    if (isInside) return true;
  }
  return false;
}

}  // namespace otg
