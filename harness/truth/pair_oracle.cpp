// SPDX-License-Identifier: BSD-3-Clause
#include "truth/pair_oracle.h"

#include <algorithm>
#include <cmath>

#include "bvh/collision_mesh.h"
#include "collide/query.h"
#include "truth/overlap_volume.h"
#include "truth/shape_oracle.h"

namespace otg::truth {
namespace {

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

/// Two meshes: our exact set of intersecting triangles; where that cannot distinguish overlap from touch, the volume.
class MeshOracle : public PairOracle {
 public:
  MeshOracle(const PairBody& a, const PairBody& b, double grain)
      : a_(scenes::build(a.mesh), BuildStrategy::kSah),
        b_(scenes::build(b.mesh), BuildStrategy::kSah),
        poseA_(a.pose),
        bInA_(relativePose(a.pose, b.pose)),
        grain_(grain) {
    query_.a = &a_;
    query_.b = &b_;
    whole_ = overlapOf(a_.mesh(), b_.mesh(), bInA_).volume;
    // What rounding of the sums may leave, by the bodies' size.
    const double size = static_cast<double>(std::min(a_.mesh().radius(), b_.mesh().radius()));
    noise_ = 1e-17 * size * size * size;
  }

  bool overlapped(const Vec3d& translation) override {
    const Transformd pose = posed(translation);
    query_.bInA = pose;
    findIntersectingPairs(query_, workspace_);
    for (const TrianglePair& pair : workspace_.intersecting) {
      if (crosses(cornersOfA(pair.a), cornersOfB(pair.b, pose))) return true;
    }
    if (workspace_.intersecting.empty() && !nested(pose)) return false;
    return overlapOf(a_.mesh(), b_.mesh(), pose).volume > std::max(1e-3 * whole_, noise_);
  }

  std::optional<double> volume(const Vec3d& translation) override {
    if (whole_ < 100 * noise_) return {};
    return overlapOf(a_.mesh(), b_.mesh(), posed(translation)).volume;
  }

  std::vector<Vec3d> faceDirections() override {
    std::vector<Vec3d> all;
    const auto offer = [&](const Corners& t, double sign) {
      const Vec3d n = otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0]));
      if (!(norm(n) > 0)) return;
      const Vec3d world = otgRotate(poseA_, otgScale(n, sign / norm(n)));
      const bool known = std::any_of(all.begin(), all.end(), [&](const Vec3d& d) { return otgDot(d, world) > 0.9998; });
      if (!known && all.size() < 40) all.push_back(world);
    };
    query_.bInA = bInA_;
    findIntersectingPairs(query_, workspace_);
    for (const TrianglePair& pair : workspace_.intersecting) {
      offer(cornersOfB(pair.b, bInA_), 1);
      offer(cornersOfA(pair.a), -1);
    }
    return all;
  }

 private:
  Transformd posed(const Vec3d& translation) const {
    Transformd pose = bInA_;
    pose.t = otgSub(pose.t, otgRotateBack(poseA_, translation));
    return pose;
  }
  Corners cornersOfA(std::uint32_t t) const {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = a_.mesh().vertices()[a_.mesh().triangles()[t].v[k]];
      corners[k] = {v.x, v.y, v.z};
    }
    return corners;
  }
  Corners cornersOfB(std::uint32_t t, const Transformd& pose) const {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = b_.mesh().vertices()[b_.mesh().triangles()[t].v[k]];
      corners[k] = otgTransform(pose, Vec3d{v.x, v.y, v.z});
    }
    return corners;
  }
  /// Heights of the corners of t above the plane of s, and whether they reach to both sides by more than the grain.
  bool reachesThrough(const Corners& t, const Corners& s, std::array<double, 3>& heights) const {
    const Vec3d n = otgCross(otgSub(s[1], s[0]), otgSub(s[2], s[0]));
    const double length = norm(n);
    if (!(length > 0)) return false;
    for (std::size_t k = 0; k < 3; ++k) heights[k] = otgDot(n, otgSub(t[k], s[0])) / length;
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    return *low<-grain_&& * high> grain_;
  }
  /// Where a triangle meets the plane in which the heights vanish, along an axis.
  static std::pair<double, double> stretch(const Corners& t, const std::array<double, 3>& heights, const Vec3d& axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t m = (k + 1) % 3;
      if ((heights[k] > 0) == (heights[m] > 0)) continue;
      const double s = heights[k] / (heights[k] - heights[m]);
      const double x = otgDot(axis, otgAdd(t[k], otgScale(otgSub(t[m], t[k]), s)));
      low = std::min(low, x);
      high = std::max(high, x);
    }
    return {low, high};
  }
  /// Two triangles that go through each other along a line longer than the grain: then the solids overlap.
  bool crosses(const Corners& s, const Corners& t) const {
    std::array<double, 3> ofT{}, ofS{};
    if (!reachesThrough(t, s, ofT) || !reachesThrough(s, t, ofS)) return false;
    const Vec3d axis =
        otgCross(otgCross(otgSub(s[1], s[0]), otgSub(s[2], s[0])), otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0])));
    if (!(norm(axis) > 0)) return false;
    const Vec3d unit = otgScale(axis, 1 / norm(axis));
    const auto [s0, s1] = stretch(s, ofS, unit);
    const auto [t0, t1] = stretch(t, ofT, unit);
    return std::min(s1, t1) - std::max(s0, t0) > grain_;
  }
  /// Whether one box is inside the other: without it, surfaces that don't meet are apart.
  bool nested(const Transformd& pose) const {
    const auto box = [](const auto& mesh, const Transformd* by) {
      const double inf = std::numeric_limits<double>::infinity();
      std::array<double, 6> b{inf, inf, inf, -inf, -inf, -inf};
      for (const Vec3f& f : mesh.vertices()) {
        Vec3d v{f.x, f.y, f.z};
        if (by) v = otgTransform(*by, v);
        const double x[3] = {v.x, v.y, v.z};
        for (std::size_t k = 0; k < 3; ++k) {
          b[k] = std::min(b[k], x[k]);
          b[3 + k] = std::max(b[3 + k], x[k]);
        }
      }
      return b;
    };
    const auto a = box(a_.mesh(), nullptr), b = box(b_.mesh(), &pose);
    bool aInB = true, bInA = true;
    for (std::size_t k = 0; k < 3; ++k) {
      aInB = aInB && a[k] > b[k] && a[3 + k] < b[3 + k];
      bInA = bInA && b[k] > a[k] && b[3 + k] < a[3 + k];
    }
    return aInB || bInA;
  }

  CollisionMesh a_, b_;
  Transformd poseA_, bInA_;
  double grain_, whole_ = 0, noise_ = 0;
  Query query_;
  Workspace workspace_;
};

}  // namespace

std::unique_ptr<PairOracle> makeOracle(const PairBody& a, const PairBody& b, double grain) {
  if (a.shape) return std::make_unique<ShapeOracle>(b, a, -1, grain);
  if (b.shape) return std::make_unique<ShapeOracle>(a, b, 1, grain);
  return std::make_unique<MeshOracle>(a, b, grain);
}

}  // namespace otg::truth
