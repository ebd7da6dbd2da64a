// SPDX-License-Identifier: BSD-3-Clause
// Bodies with limbs, and where two of them begin to touch.
#include "physics/lumps.h"

#include <array>
#include <cmath>
#include <random>

#include "bvh/collision_mesh.h"
#include "collide/query.h"

namespace otg::physics {
namespace {

constexpr int kLimbs = 6;

struct Limb {
  Vec direction;
  double length;  ///< share of the trunk's radius by which it sticks out
};

/// Six limbs in roughly the directions of the axes, so that they never merge.
std::array<Limb, kLimbs> limbsOf(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  std::array<Limb, kLimbs> limbs;
  for (std::size_t i = 0; i < kLimbs; ++i) {
    Vec axis = Vec::Zero();
    axis[static_cast<Eigen::Index>(i / 2)] = i % 2 ? -1 : 1;
    const double x = uniform(), y = uniform(), z = uniform();
    limbs[i] = {(axis + 0.45 * Vec(x, y, z)).normalized(), 1.1 + 0.4 * uniform()};
  }
  return limbs;
}

constexpr double kTrunk = 0.25;  ///< m

}  // namespace

ShapePointer limbedShape(std::uint32_t seed, int level) {
  const std::array<Limb, kLimbs> limbs = limbsOf(seed);
  scenes::MeshArrays mesh = scenes::makeSphere(1, level);
  for (Vec3f& vertex : mesh.vertices) {
    const Vec d = Vec(vertex.x, vertex.y, vertex.z).normalized();
    double radius = 1;
    for (const Limb& limb : limbs) {
      const double angle = std::atan2(d.cross(limb.direction).norm(), d.dot(limb.direction));
      radius += limb.length * std::exp(-(angle / 0.3) * (angle / 0.3));
    }
    const Vec p = kTrunk * radius * d;
    vertex = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  }
  return makeShape(std::move(mesh));
}

ShapePointer patchedShape(std::uint32_t seed) {
  std::vector<scenes::MeshArrays> parts{scenes::makeSphere(kTrunk, 3)};
  for (const Limb& limb : limbsOf(seed)) {
    const double length = kTrunk * (1 + limb.length);
    const Eigen::Matrix3d turn = Rotation::FromTwoVectors(Vec::UnitZ(), limb.direction).toRotationMatrix();
    const Vec center = 0.5 * length * limb.direction;
    Transformd pose{};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) pose.r[3 * r + c] = turn(r, c);
    pose.t = {center.x(), center.y(), center.z()};
    parts.push_back(scenes::transformed(scenes::makeCylinder(0.08, length, 16, 6), pose));
  }
  return makeShape(scenes::merge(parts));
}

double touchingDistance(const Shape& a, const Shape& b, const Vec& direction) {
  const CollisionMesh meshA(scenes::build(a.mesh), BuildStrategy::kSah);
  const CollisionMesh meshB(scenes::build(b.mesh), BuildStrategy::kSah);
  Workspace workspace;
  const auto touch = [&](double distance) {
    Query query;
    query.a = &meshA;
    query.b = &meshB;
    const Vec t = distance * direction;
    query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {t.x(), t.y(), t.z()}};
    findIntersectingPairs(query, workspace);
    return !workspace.intersecting.empty();
  };
  // From outside inwards, then halving: the first touch is what is wanted, not just any.
  const double step = 0.005 * (a.extent + b.extent);
  double clear = a.extent + b.extent;
  while (clear > 0 && !touch(clear - step)) clear -= step;
  double touching = clear - step;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (clear + touching);
    (touch(middle) ? touching : clear) = middle;
  }
  return touching;
}

}  // namespace otg::physics
