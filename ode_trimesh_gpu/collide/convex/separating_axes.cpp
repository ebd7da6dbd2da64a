// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/separating_axes.h"

#include <array>

namespace otg {
namespace {

constexpr std::size_t kMostAxes = 48;

}  // namespace

bool haveFewAxes(const ConvexPair& pair) {
  const std::size_t a = pair.a().edgeDirections().size(), b = pair.b().edgeDirections().size();
  return a > 0 && b > 0 && pair.a().faceCount() + pair.b().faceCount() + a * b <= kMostAxes;
}

ConvexAxis leastByAxes(const ConvexPair& pair, double size) {
  ConvexAxis best;
  const double slack = kFaceSlack * size;
  // B's faces first: B is the larger body, and what lies on it keeps to its normals.
  for (const int body : {1, 0}) {
    const auto faces = static_cast<std::uint32_t>(pair.body(body).faceCount());
    for (std::uint32_t f = 0; f < faces; ++f) {
      const Vec3d outward = body == 0 ? pair.normal(0, f) : unit(pair.normal(1, f));
      const Vec3d m = body == 0 ? outward : otgScale(outward, -1.0);
      // In A's frame the face itself is where its body is farthest; a pose that is no exact rotation may tilt it.
      const std::uint32_t own = body == 0 ? pair.a().corners(f).front().vertex : pair.farthest(1, outward);
      const std::uint32_t other = pair.farthest(1 - body, otgScale(outward, -1.0));
      const double overlap = otgDot(outward, pair.place(body, own) - pair.place(1 - body, other));
      if (overlap < 0) return {};
      if (best.of != ConvexAxis::Of::kNone && !(overlap < best.overlap)) continue;
      // The first body's faces keep their place where the second one's are not clearly better.
      const bool isOther = best.of == ConvexAxis::Of::kFaceB && body == 0;
      if (isOther && !(overlap < (1 - kFaceShare) * best.overlap - slack)) continue;
      best = {body == 0 ? ConvexAxis::Of::kFaceA : ConvexAxis::Of::kFaceB, m, overlap, f};
    }
  }
  std::array<Vec3d, ConvexPolyhedron::kMostDirections> ofB{};
  const std::span<const Vec3d> edgesB = pair.b().edgeDirections();
  for (std::size_t j = 0; j < edgesB.size(); ++j) ofB[j] = pair.rotated(edgesB[j]);
  constexpr double kParallel = 1e-5;  // closer edges say no more than the faces beside them
  for (const Vec3d& alongA : pair.a().edgeDirections()) {
    for (std::size_t j = 0; j < edgesB.size(); ++j) {
      const Vec3d cross = otgCross(alongA, ofB[j]);
      const double length = norm(cross);
      if (!(length > kParallel)) continue;
      const Vec3d m = cross * (1 / length);
      const ConvexPolyhedron::Reach a = pair.reach(0, m), b = pair.reach(1, m);
      const double ahead = a.most - b.least, behind = b.most - a.least;
      const double overlap = std::min(ahead, behind);
      if (overlap < 0) return {};
      if (!(overlap < (1 - kFaceShare) * best.overlap - slack)) continue;
      best = {ConvexAxis::Of::kEdges, ahead <= behind ? m : otgScale(m, -1.0), overlap, kNone};
    }
  }
  return best;
}

}  // namespace otg
