// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/expanding_polytope.h"

#include <limits>

#include "collide/convex/polytope.h"

namespace otg {
namespace {

constexpr double kEnough = 1e-5;  ///< of the overlap: the bounds are so near to each other

/// Two polyhedra, and the direction of the least overlap seen so far.
class Polyhedra {
 public:
  using Difference = ConvexPair::Difference;
  explicit Polyhedra(const ConvexPair& pair) : pair_(pair) {}
  Difference difference(const Vec3d& m) const { return pair_.difference(m); }
  bool look(const Vec3d& m, const Difference& difference) {
    const double overlap = otgDot(m, difference.at);
    if (overlap < least_) {
      least_ = overlap;
      m_ = m;
    }
    return !(overlap < 0);
  }
  bool isEnough(double overlap, double distance, double rounding) const {
    return overlap - distance <= std::max(kEnough * least_, rounding);
  }
  ConvexAxis best() const { return {ConvexAxis::Of::kEdges, m_, least_, kNone}; }

 private:
  const ConvexPair& pair_;
  Vec3d m_{0, 0, 0};
  double least_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::uint32_t facingFace(const ConvexPair& pair, int body, const Vec3d& direction) {
  const ConvexPolyhedron& shape = pair.body(body);
  std::uint32_t best = kNone;
  double most = -2;
  for (const std::uint32_t c : shape.cornersAt(pair.farthest(body, direction))) {
    const std::uint32_t face = shape.corner(c).face;
    const double along = otgDot(pair.normal(body, face), direction);
    if (!(along > most)) continue;
    most = along;
    best = face;
  }
  return best;
}

ConvexAxis leastByPolytope(const ConvexPair& pair, const Vec3d& toB, double size) {
  Polyhedra polyhedra(pair);
  if (!Polytope<Polyhedra>(polyhedra, toB, size).run()) return {};
  const ConvexAxis found = polyhedra.best();
  const double most = (1 + kFaceShare) * found.overlap + kFaceSlack * size;
  const Vec3d backward = otgScale(found.m, -1.0);
  const std::uint32_t faceB = facingFace(pair, 1, backward), faceA = facingFace(pair, 0, found.m);
  const Vec3d ofB = otgScale(unit(pair.normal(1, faceB)), -1.0);
  const double overlapOfB = pair.overlapAlong(ofB);
  if (overlapOfB < 0) return {};
  const Vec3d ofA = pair.normal(0, faceA);
  const double overlapOfA = pair.overlapAlong(ofA);
  if (overlapOfA < 0) return {};
  // As in leastByAxes: B's face, unless A's is clearly better.
  if (overlapOfB <= most && !(overlapOfA < (1 - kFaceShare) * overlapOfB - kFaceSlack * size)) {
    return {ConvexAxis::Of::kFaceB, ofB, overlapOfB, faceB};
  }
  if (overlapOfA <= most) return {ConvexAxis::Of::kFaceA, ofA, overlapOfA, faceA};
  return found;
}

}  // namespace otg
