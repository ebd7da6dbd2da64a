// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/vectors.h"

namespace otg {
namespace {

constexpr double kFlat = 1e-9;

struct Face {
  std::array<std::uint32_t, 3> corners;
  Vec3d normal;
  double offset;
};

class Hull {
 public:
  explicit Hull(std::span<const Vec3d> points) : points_(points) {}

  std::vector<std::array<std::uint32_t, 3>> run() {
    std::vector<std::array<std::uint32_t, 3>> out;
    if (points_.size() < 4 || !start()) return out;
    for (std::uint32_t i = 0; i < points_.size(); ++i) add(i);
    for (const Face& face : faces_) out.push_back(face.corners);
    return out;
  }

 private:
  double height(const Face& face, std::uint32_t p) const { return otgDot(face.normal, points_[p]) - face.offset; }

  void addFace(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3d n = unit(otgCross(points_[b] - points_[a], points_[c] - points_[a]));
    faces_.push_back({{a, b, c}, n, otgDot(n, points_[a])});
  }

  /// The point that is farthest by a measure.
  template <class Measure>
  std::uint32_t farthest(const Measure& measure) const {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < points_.size(); ++i) {
      if (measure(points_[i]) > measure(points_[best])) best = i;
    }
    return best;
  }

  /// A tetrahedron of points far from each other.
  bool start() {
    const Vec3d& o = points_[0];
    const auto distance = [&](const Vec3d& from) { return [from](const Vec3d& p) { return norm(p - from); }; };
    const std::uint32_t a = farthest(distance(o)), b = farthest(distance(points_[a]));
    const Vec3d ab = points_[b] - points_[a];
    const double size = norm(ab);
    tolerance_ = kFlat * size;
    if (!(size > 0)) return false;
    const std::uint32_t c = farthest([&](const Vec3d& p) { return norm(otgCross(p - points_[a], ab)); });
    const Vec3d n = unit(otgCross(ab, points_[c] - points_[a]));
    const auto off = [&](const Vec3d& p) { return std::fabs(otgDot(n, p - points_[a])); };
    const std::uint32_t d = farthest(off);
    if (!(off(points_[d]) > tolerance_)) return false;
    const bool below = otgDot(n, points_[d] - points_[a]) < 0;
    const std::uint32_t p = below ? b : c, q = below ? c : b;  // a, p, q seen counter-clockwise from the side without d
    addFace(a, p, q);
    addFace(p, a, d);
    addFace(q, p, d);
    addFace(a, q, d);
    return true;
  }

  void add(std::uint32_t p) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    const auto seen = std::stable_partition(faces_.begin(), faces_.end(),
                                            [&](const Face& face) { return height(face, p) <= tolerance_; });
    for (auto it = seen; it != faces_.end(); ++it) {
      for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(it->corners[k], it->corners[(k + 1) % 3]);
    }
    if (edges.empty()) return;
    faces_.erase(seen, faces_.end());
    const std::set<std::pair<std::uint32_t, std::uint32_t>> all(edges.begin(), edges.end());
    for (const auto& [a, b] : edges) {
      if (all.find({b, a}) == all.end()) addFace(a, b, p);
    }
  }

  std::span<const Vec3d> points_;
  std::vector<Face> faces_;
  double tolerance_ = 0;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> convexHull(std::span<const Vec3d> points) {
  return Hull(points).run();
}

}  // namespace otg
