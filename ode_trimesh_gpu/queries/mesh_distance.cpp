// SPDX-License-Identifier: BSD-3-Clause
#include "queries/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vectors.h"
#include "collide/pair_frame.h"
#include "collide/rotation_tolerance.h"
#include "queries/closest_point.h"
#include "queries/mesh_overlap.h"
#include "queries/triangle_distance.h"

namespace otg {
namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

BoxFrame<double> boxFrame(const Query& query) {
  BoxFrame<double> frame{};
  for (int i = 0; i < 9; ++i) {
    frame.r[i] = query.bInA.r[i];
    frame.absR[i] = std::fabs(frame.r[i]);
  }
  const Vec3d b = otgTransform(query.bInA, toDouble(query.b->mesh().origin()));
  frame.t = b - toDouble(query.a->mesh().origin());
  return frame;
}

template <class Boxes>
class Search {
 public:
  Search(const Query& query, const Boxes& boxesA, const Boxes& boxesB, double limit)
      : query_(query),
        frame_(boxFrame(query)),
        a_(query.a->tree().nodes),
        b_(query.b->tree().nodes),
        boxesA_(boxesA),
        boxesB_(boxesB),
        limit_(limit) {
    // A pose is a rotation to within a tolerance only; the gap along B's axes is off by that much at most, and
    // distances of triangles are by OTG_ON_TRIANGLE.
    const double reach = norm(frame_.t) + double{query.a->mesh().radius()} + double{query.b->mesh().radius()};
    slack_ = (2 * rotationDefect(query.bInA) + 1e-12 + 4 * OTG_ON_TRIANGLE) * reach;
  }

  MeshDistance run() {
    stack_.push_back({0, 0, gap(0, 0)});
    while (!stack_.empty()) {
      const Item item = stack_.back();
      stack_.pop_back();
      if (item.gap > limit_) continue;
      const BvhNode &x = a_[item.a], &y = b_[item.b];
      if (x.isLeaf() && y.isLeaf()) {
        visit(x.triangle(), y.triangle());
        continue;
      }
      const bool openA = y.isLeaf() || (!x.isLeaf() && size(boxesA_(x)) >= size(boxesB_(y)));
      Item children[2];
      for (int side = 0; side < 2; ++side) {
        const std::uint32_t i = openA ? static_cast<std::uint32_t>(x.child + side) : item.a;
        const std::uint32_t j = openA ? item.b : static_cast<std::uint32_t>(y.child + side);
        children[side] = {i, j, gap(i, j)};
      }
      if (children[0].gap < children[1].gap) std::swap(children[0], children[1]);
      for (const Item& child : children) {
        if (child.gap <= limit_) stack_.push_back(child);
      }
    }
    return best_;
  }

 private:
  struct Item {
    std::uint32_t a, b;
    double gap;
  };
  template <class Box>
  static double size(const Box& box) {
    return std::max({box.extent.x, box.extent.y, box.extent.z});
  }
  /// Not more than the distance of what is in the boxes. Of boxes that overlap it is less where they do so more.
  double gap(std::uint32_t i, std::uint32_t j) const {
    const auto& a = boxesA_(a_[i]);
    const auto& b = boxesB_(b_[j]);
    const Vec3d centerA = toDouble(a.center), extentA = toDouble(a.extent), extentB = toDouble(b.extent);
    const Vec3d d = otgBoxCenterInA(frame_, toDouble(b.center)) - centerA;
    const double along = otgDot(way_, d) - (otgDot(wayA_, extentA) + otgDot(wayB_, extentB)) - slack_;
    if (along > limit_) return along;
    const double distance2 = otgBoxDistance2Below(frame_, d, extentA, extentB);
    if (distance2 > 0) return std::sqrt(distance2) - slack_;
    const double gapA = otgBoxGapA(d, extentA, otgBoxExtentInA(frame_, extentB));
    return std::max(gapA, otgBoxGapB(frame_, d, extentA, extentB)) - slack_;
  }
  /// Whether two triangles are so far apart along the way that they cannot be nearer than the limit.
  bool areApart(const Vec3d a[3], const Vec3d b[3]) const {
    const double most = std::max({otgDot(way_, a[0]), otgDot(way_, a[1]), otgDot(way_, a[2])});
    const double least = std::min({otgDot(way_, b[0]), otgDot(way_, b[1]), otgDot(way_, b[2])});
    return least - most - slack_ > limit_;
  }
  void visit(std::uint32_t s, std::uint32_t t) {
    if (query_.a->mesh().isDegenerate(s) || query_.b->mesh().isDegenerate(t)) return;
    Vec3d a[3], b[3];
    cornersOfA(query_.a->mesh(), s, a);
    cornersOfB(query_.b->mesh(), query_.bInA, t, b);
    if (areApart(a, b)) return;
    const PointPair found = closestOnTriangles(a, b);
    const double distance = std::sqrt(found.distance2);
    if (!(distance <= limit_)) return;
    const bool earlier = s != best_.triangleA ? s < best_.triangleA : t < best_.triangleB;
    if (best_.found && distance == best_.distance && !earlier) return;
    best_ = {true, distance, found.a, found.b, s, t};
    limit_ = distance;
    if (!(distance > 0)) return;
    way_ = (found.b - found.a) * (1 / distance);
    const Vec3d inB = otgRotateBack(query_.bInA, way_);
    wayA_ = {std::fabs(way_.x), std::fabs(way_.y), std::fabs(way_.z)};
    wayB_ = {std::fabs(inB.x), std::fabs(inB.y), std::fabs(inB.z)};
  }

  const Query& query_;
  BoxFrame<double> frame_;
  const Array<BvhNode>&a_, &b_;
  const Boxes boxesA_, boxesB_;
  double limit_, slack_ = 0;
  /// From the nearest points so far, a unit vector: the direction along which what is not nearer is soonest seen to be
  /// apart. Sizes of its parts in either frame.
  Vec3d way_{}, wayA_{}, wayB_{};
  std::vector<Item> stack_;
  MeshDistance best_;
};

}  // namespace

MeshDistance meshDistance(const Query& query, double limit) {
  requireRigid(query.bInA);
  if (query.a->tree().nodes.empty() || query.b->tree().nodes.empty()) return {};
  TrianglePair meeting{};
  if (findMeeting(query, meeting)) {
    Vec3d a[3], b[3];
    cornersOfA(query.a->mesh(), meeting.a, a);
    cornersOfB(query.b->mesh(), query.bInA, meeting.b, b);
    const Vec3d point = commonPoint(a, b);
    return {true, 0, point, point, meeting.a, meeting.b};
  }
  MeshDistance inside;
  return contains(query, inside) ? inside : distanceApart(query, limit);
}

bool contains(const Query& query, MeshDistance& answer) {
  Vec3d vertex{};
  if (!containedVertex(query, vertex)) return false;
  answer = {true, 0, vertex, vertex, kNone, kNone};
  return true;
}

MeshDistance distanceApart(const Query& query, double limit) {
  return withBoxes(query.a->boxScale(), query.b->boxScale(),
                   [&](const auto& boxesA, const auto& boxesB) { return Search(query, boxesA, boxesB, limit).run(); });
}

MeshDistance distanceOfTriangles(const Query& query, const TrianglePair& nearest) {
  if (nearest.a == kNone) return {};
  Vec3d a[3], b[3];
  cornersOfA(query.a->mesh(), nearest.a, a);
  cornersOfB(query.b->mesh(), query.bInA, nearest.b, b);
  const PointPair found = closestOnTriangles(a, b);
  return {true, std::sqrt(found.distance2), found.a, found.b, nearest.a, nearest.b};
}

}  // namespace otg
