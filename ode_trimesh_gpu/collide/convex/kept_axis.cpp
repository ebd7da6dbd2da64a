// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/kept_axis.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "collide/convex/expanding_polytope.h"

namespace otg {
namespace {

constexpr double kTilt = 1 - 5e-7;  ///< cosine of 1e-3: what is tilted less may be taken for the same face
constexpr double kOverlapSlack = 1.01, kSizeSlack = 1e-7;

/// The squared distance within the plane of a face from a point above it to its nearest side; negative outside.
double squareWithin(const ConvexPair& pair, int body, std::uint32_t face, const Vec3d& normal, const Vec3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const ConvexPolyhedron::Corner& corner : pair.body(body).corners(face)) {
    const Vec3d from = pair.place(body, corner.vertex);
    const Vec3d outward = otgCross(pair.place(body, corner.next) - from, normal);
    const double beyond = otgDot(outward, point - from);
    if (!(beyond < 0)) return -1;
    least = std::min(least, beyond * beyond / otgDot(outward, outward));
  }
  return least;
}

}  // namespace

bool isAlone(const ConvexPolyhedron& shape, std::uint32_t face) {
  const Vec3d& normal = shape.face(face).normal;
  for (const ConvexPolyhedron::Corner& corner : shape.corners(face)) {
    if (otgDot(normal, shape.face(corner.across).normal) > kTilt) return false;
  }
  return true;
}

// In a direction that makes an angle t with m the overlap is at least o cos t + r sin t. That is more than o up to the
// right angle. Beyond that the disc and the body's farthest point against m say the same.
bool isLeastAround(const Vec3d& m, double overlap, double radius, const Vec3d& far) {
  constexpr double kLarger = 3;
  if (!(radius > kLarger * overlap)) return false;
  const double behind = -otgDot(m, far), beside = norm(far + m * behind);
  // The disc alone may fail where the angle is beyond 132 degrees: sin < 2 most / radius, and -cos > 0.74.
  return 0.74 * behind > overlap + 2 * overlap / radius * beside;
}

bool isOfPair(const ConvexPair& pair, const SolidHistory::KeptAxis& kept) {
  return kept.a == pair.a().stamp() && kept.b == pair.b().stamp();
}

bool isOfPose(const ConvexPair& pair, const SolidHistory::KeptAxis& kept) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  return isOfPair(pair, kept) && std::memcmp(&kept.pose, &pair.pose(), sizeof kept.pose) == 0;
}

bool isStillLeast(const ConvexPair& pair, const SolidHistory::KeptAxis& kept, double size, ConvexAxis& axis) {
  const auto of = static_cast<ConvexAxis::Of>(kept.of);
  if (of != ConvexAxis::Of::kFaceA && of != ConvexAxis::Of::kFaceB) return false;
  const int body = of == ConvexAxis::Of::kFaceA ? 0 : 1;
  if (!isAlone(pair.body(body), kept.face)) return false;
  const Vec3d outward = body == 0 ? pair.normal(0, kept.face) : unit(pair.normal(1, kept.face));
  const Vec3d m = body == 0 ? outward : otgScale(outward, -1.0);
  const ConvexPair::Difference near = pair.difference(m);
  const double overlap = otgDot(m, near.at);
  if (!(overlap > 0)) return false;
  const double most = kOverlapSlack * overlap + kSizeSlack * size;
  const double square = squareWithin(pair, body, kept.face, outward, pair.place(1 - body, body == 0 ? near.b : near.a));
  if (!(square > 0)) return false;
  if (!isLeastAround(m, most, std::sqrt(square), pair.difference(otgScale(m, -1.0)).at)) return false;
  if (body == 0) {
    // B's face is preferred where it is as good.
    const std::uint32_t other = facingFace(pair, 1, otgScale(m, -1.0));
    constexpr double kClearly = 2;
    const double ofB = pair.overlapAlong(otgScale(unit(pair.normal(1, other)), -1.0));
    if (!isAlone(pair.b(), other) || !(ofB > (1 + kClearly * kFaceShare) * overlap + kClearly * kFaceSlack * size)) {
      return false;
    }
  }
  axis = {of, m, overlap, kept.face};
  return true;
}

}  // namespace otg
