// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shell/ground_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "shared/tests/point_test.h"

namespace otg {
namespace {

/// A way counts as past a rim where its cosine with the mean normal is less than the normals' around its end by this:
/// at a flat rim 18 degrees.
constexpr double kBeside = 0.05;

}  // namespace

void GroundSurface::corners(std::uint32_t triangle, Vec3d out[3]) const {
  const Triangle& t = mesh_.triangles()[triangle];
  for (int k = 0; k < 3; ++k) out[k] = asDouble(mesh_.vertices()[t.v[k]]);
}

/// The triangle that a walk down the tree by the nearer child ends at.
std::uint32_t GroundSurface::guess(const Vec3d& point) const {
  const Array<BvhNode>& nodes = ground_.tree().nodes;
  const Vec3d centred = otgSub(point, asDouble(mesh_.origin()));
  return withBoxes(ground_.boxScale(), [&](const auto& boxes) {
    const auto distance2 = [&](const BvhNode& node) {
      const auto& box = boxes(node);
      return otgBoxDistance2(asDouble(box.center), asDouble(box.extent), centred, 0.0);
    };
    const BvhNode* node = &nodes[0];
    while (!node->isLeaf()) {
      const auto child = static_cast<std::size_t>(node->child);
      node = distance2(nodes[child + 1]) < distance2(nodes[child]) ? &nodes[child + 1] : &nodes[child];
    }
    return node->triangle();
  });
}

bool GroundSurface::nearest(const Vec3d& point, double limit, std::uint32_t hint, GroundPlace& place) const {
  place.triangle = kNone;
  place.distance = limit;
  const auto test = [&](std::uint32_t t) {
    if (mesh_.isDegenerate(t) || t == place.triangle) return false;
    Vec3d p[3];
    corners(t, p);
    Vec3d on;
    const int part = otgNearestOnTriangle(p[0], p[1], p[2], point, &on);
    const double distance = otgDistance(point, on);
    if (!(distance < place.distance || (distance == place.distance && t < place.triangle))) return false;
    const bool isNearer = distance < place.distance;
    place = {on, distance, t, part};
    return isNearer;
  };
  test(hint == kNone ? guess(point) : hint);
  const std::vector<WideNode>& nodes = ground_.wide().nodes;
  BallQuery ball(ground_, point, place.distance);
  std::int32_t stack[kWideArity * (kMaxTreeDepth + 1)];
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const WideNode& node = nodes[static_cast<std::size_t>(stack[--top])];
    for (unsigned bits = ball(node); bits != 0; bits &= bits - 1) {
      const std::int32_t child = node.child[__builtin_ctz(bits)];
      if (child >= 0) {
        stack[top++] = child;
      } else if (test(static_cast<std::uint32_t>(~child))) {
        ball = BallQuery(ground_, point, place.distance);
      }
    }
  }
  return place.triangle != kNone;
}

template <class Visit>
void GroundSurface::around(const GroundPlace& place, const Visit& visit) const {
  const Topology& topology = mesh_.topology();
  const Triangle& triangle = mesh_.triangles()[place.triangle];
  const bool isCorner = place.part >= OTG_PART_CORNER;
  const int k = place.part - (isCorner ? OTG_PART_CORNER : OTG_PART_EDGE);
  const std::uint32_t vertex = topology.weld[triangle.v[k]];
  const std::uint32_t edge = isCorner ? kNone : topology.edgeOf[3 * std::size_t{place.triangle} + std::size_t(k)];
  for (std::uint32_t i = adjacency_.first[vertex]; i < adjacency_.first[vertex + 1]; ++i) {
    const std::uint32_t half = adjacency_.halfEdges[i], t = half / 3;
    if (mesh_.isDegenerate(t)) continue;
    if (isCorner) {
      Vec3d p[3];
      corners(t, p);
      const std::size_t at = half % 3;
      const Vec3d u = unit(otgSub(p[(at + 1) % 3], p[at])), v = unit(otgSub(p[(at + 2) % 3], p[at]));
      visit(front(t), std::acos(std::clamp(otgDot(u, v), -1.0, 1.0)));
      continue;
    }
    const std::size_t other = 3 * std::size_t{t} + (half % 3 + 2) % 3;  // the triangle's half-edge to the vertex
    if (topology.edgeOf[half] == edge || topology.edgeOf[other] == edge) visit(front(t), 1.0);
  }
}

void GroundSurface::look(const Vec3d& point, GroundDepth& depth) const {
  const GroundPlace& place = depth.place;
  const Vec3d off = otgSub(place.point, point);
  double least = 1;
  if (place.part == OTG_PART_FACE) {
    depth.out = front(place.triangle);
  } else {
    // The weighted mean determines the side (Baerentzen and Aanaes 2005).
    Vec3d sum{0, 0, 0};
    around(place, [&](const Vec3d& n, double weight) { sum = otgAdd(sum, otgScale(n, weight)); });
    depth.out = norm(sum) > 1e-6 ? unit(sum) : front(place.triangle);
    around(place, [&](const Vec3d& n, double) { least = std::min(least, otgDot(n, depth.out)); });
  }
  depth.height = -otgDot(off, depth.out);
  if (place.distance <= slack_) {
    depth.isBehind = true;  // on the surface
    depth.isBeside = false;
    depth.way = depth.out;
    depth.height = 0;
    return;
  }
  depth.isBehind = depth.height < 0;
  depth.way = place.part == OTG_PART_FACE ? depth.out : otgScale(off, 1 / place.distance);
  // From behind the way out lies among the normals around its end, but for a rim.
  const double cosine = std::fabs(depth.height) / place.distance;
  depth.isBeside = place.part != OTG_PART_FACE && cosine < std::max(least, 0.0) - kBeside;
}

bool GroundSurface::measure(const Vec3d& point, double limit, std::uint32_t hint, GroundDepth& depth) const {
  if (!nearest(point, limit, hint, depth.place)) return false;
  look(point, depth);
  return true;
}

}  // namespace otg
