// SPDX-License-Identifier: BSD-3-Clause
#include "truth/certificate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truth/separation_search.h"
#include "truth/triangle_distance.h"

namespace otg::truth {
namespace {

constexpr double kTooDeep = 3;   ///< times the distance to the surface to leave
constexpr double kFacing = 0.5;  ///< cosine between the way out and normals of the surface to leave

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

/// Distance of a point from the triangles that face a direction, of a mesh; all in the world.
double distanceToFacing(const PairBody& body, const Vec3d& point, const Vec3d& way) {
  // In the body's frame: far from the origin the world's coordinates have fewer digits.
  const Vec3d p = otgRotateBack(body.pose, otgSub(point, body.pose.t)), d = otgRotateBack(body.pose, way);
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : body.mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = body.mesh.vertices[t.v[k]];
      corners[k] = {v.x, v.y, v.z};
    }
    const Vec3d n = otgCross(otgSub(corners[1], corners[0]), otgSub(corners[2], corners[0]));
    if (otgDot(n, d) < kFacing * norm(n)) continue;
    least = std::min(least, distanceToTriangle(p, corners));
  }
  return least;
}

/// The pair after a first translation.
class MovedOracle : public PairOracle {
 public:
  MovedOracle(PairOracle& whole, const Vec3d& by) : whole_(whole), by_(by) {}
  bool overlapped(const Vec3d& translation) override { return whole_.overlapped(otgAdd(by_, translation)); }
  std::optional<double> volume(const Vec3d& translation) override { return whole_.volume(otgAdd(by_, translation)); }
  std::vector<Vec3d> faceDirections() override { return whole_.faceDirections(); }

 private:
  PairOracle& whole_;
  Vec3d by_;
};

bool same(const JudgedContact& x, const JudgedContact& y, double tolerance, double ofNormals) {
  return norm(otgSub(x.position, y.position)) <= tolerance && std::fabs(x.depth - y.depth) <= tolerance &&
         norm(otgSub(x.normal, y.normal)) <= ofNormals;
}

}  // namespace

Certificate certify(PairOracle& oracle, double shortest, const std::vector<JudgedContact>& contacts) {
  Certificate result;
  result.none = contacts.empty();
  if (result.none) return result;
  std::vector<HalfSpace> halfSpaces;
  halfSpaces.reserve(contacts.size());
  for (const JudgedContact& c : contacts) halfSpaces.push_back({c.normal, c.depth});
  const std::optional<Vec3d> t = shortestTranslation(halfSpaces);
  result.infeasible = !t;
  if (!t) return result;
  result.asked = *t;
  result.length = norm(*t);
  if (!oracle.overlapped(*t)) {
    result.left = result.leftWay = 0;
    return result;
  }
  MovedOracle rest(oracle, *t);
  const std::optional<Vec3d> way = shortestSeparation(rest, 0.005 * shortest, shortest, {*t});
  result.leftWay = way ? std::min(norm(*way) / shortest, 1.0) : 1.0;
  const std::optional<double> before = oracle.volume({0, 0, 0});
  result.left = before ? *oracle.volume(*t) / *before : result.leftWay;
  return result;
}

std::vector<std::size_t> tooDeep(const PairBody& a, const PairBody& b, const std::vector<JudgedContact>& contacts,
                                 double grain) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const JudgedContact& c = contacts[i];
    if (c.exempt || c.depth <= grain) continue;
    const Vec3d half = otgScale(c.normal, c.depth / 2);
    double distance = std::numeric_limits<double>::infinity();
    // A shape's surface has no triangles of its own; its partner's says enough.
    if (!b.shape) distance = std::min(distance, distanceToFacing(b, otgSub(c.position, half), c.normal));
    if (!a.shape) {
      distance = std::min(distance, distanceToFacing(a, otgAdd(c.position, half), otgScale(c.normal, -1.0)));
    }
    if (c.depth > kTooDeep * (distance + grain)) found.push_back(i);
  }
  return found;
}

int unmatched(const std::vector<JudgedContact>& x, const std::vector<JudgedContact>& y, double tolerance,
              double ofNormals) {
  int count = 0;
  std::vector<bool> taken(y.size(), false);
  for (const JudgedContact& c : x) {
    std::size_t k = 0;
    while (k < y.size() && (taken[k] || !same(c, y[k], tolerance, ofNormals))) ++k;
    if (k < y.size()) {
      taken[k] = true;
    } else {
      ++count;
    }
  }
  return count + static_cast<int>(std::count(taken.begin(), taken.end(), false));
}

}  // namespace otg::truth
