// SPDX-License-Identifier: BSD-3-Clause
// The exact answers, computed by CGAL.
#include "oracle/cgal_oracle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>

namespace otg::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Rational = CGAL::Exact_rational;

struct Side {
  std::vector<Kernel::Triangle_3> triangles;
  std::vector<std::uint32_t> numbers;
};

template <class Place>
Side sideOf(const TriMesh& mesh, const Place& place) {
  Side side;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    std::array<Kernel::Point_3, 3> corner, own;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.vertices()[mesh.triangles()[t].v[k]];
      const Vec3d p = place(Vec3d{v.x, v.y, v.z});
      corner[k] = Kernel::Point_3(p.x, p.y, p.z);
      own[k] = Kernel::Point_3(v.x, v.y, v.z);
    }
    if (CGAL::collinear(own[0], own[1], own[2]) || CGAL::collinear(corner[0], corner[1], corner[2])) continue;
    side.triangles.emplace_back(corner[0], corner[1], corner[2]);
    side.numbers.push_back(t);
  }
  return side;
}

using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

std::vector<Box> boxesOf(const Side& side) {
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < side.triangles.size(); ++i) {
    // Not bbox(): it may be wider than the corners, which would only cost time.
    const Kernel::Triangle_3& t = side.triangles[i];
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min({t[0][k], t[1][k], t[2][k]});
      high[k] = std::max({t[0][k], t[1][k], t[2][k]});
    }
    boxes.emplace_back(low, high, i);
  }
  return boxes;
}

struct Vec3q {
  Rational x, y, z;
};
Vec3q rational(const Vec3d& v) {
  return {v.x, v.y, v.z};
}
Rational dot(const Vec3q& a, const Vec3q& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3q cross(const Vec3q& a, const Vec3q& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3q scaled(const Vec3q& a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}

}  // namespace

std::vector<TrianglePair> cgalPairs(const TriMesh& a, const TriMesh& b, const Transformd& bInA) {
  const Side sideA = sideOf(a, [](const Vec3d& v) { return v; });
  const Side sideB = sideOf(b, [&](const Vec3d& v) { return otgTransform(bInA, v); });
  std::vector<Box> boxesA = boxesOf(sideA), boxesB = boxesOf(sideB);
  std::vector<TrianglePair> pairs;
  CGAL::box_intersection_d(boxesA.begin(), boxesA.end(), boxesB.begin(), boxesB.end(), [&](const Box& x, const Box& y) {
    if (CGAL::do_intersect(sideA.triangles[x.info()], sideB.triangles[y.info()])) {
      pairs.push_back({sideA.numbers[x.info()], sideB.numbers[y.info()]});
    }
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

bool exactBoxesMeet(const PlacedBoxes& boxes) {
  const double* r = boxes.bInA.r;
  const double extentA[3] = {boxes.extentA.x, boxes.extentA.y, boxes.extentA.z};
  const double extentB[3] = {boxes.extentB.x, boxes.extentB.y, boxes.extentB.z};
  const Vec3q unitA[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3q edgeA[3], edgeB[3], unitB[3];
  for (int k = 0; k < 3; ++k) {
    unitB[k] = {r[k], r[3 + k], r[6 + k]};
    edgeA[k] = scaled(unitA[k], extentA[k]);
    edgeB[k] = scaled(unitB[k], extentB[k]);
  }
  const Vec3q cb = rational(boxes.centerB), ca = rational(boxes.centerA), t = rational(boxes.bInA.t);
  const Vec3q d = {unitB[0].x * cb.x + unitB[1].x * cb.y + unitB[2].x * cb.z + t.x - ca.x,
                   unitB[0].y * cb.x + unitB[1].y * cb.y + unitB[2].y * cb.z + t.y - ca.y,
                   unitB[0].z * cb.x + unitB[1].z * cb.y + unitB[2].z * cb.z + t.z - ca.z};
  const auto separates = [&](const Vec3q& axis) {
    Rational reach = 0;
    for (int k = 0; k < 3; ++k) reach += CGAL::abs(dot(axis, edgeA[k])) + CGAL::abs(dot(axis, edgeB[k]));
    return CGAL::abs(dot(axis, d)) > reach;
  };
  // The faces' normals, not the columns of R: they differ where R is not orthonormal. Flat boxes keep their directions,
  // because the unit vectors and not the edges enter here.
  for (int k = 0; k < 3; ++k) {
    if (separates(unitA[k])) return false;
    if (separates(cross(unitB[(k + 1) % 3], unitB[(k + 2) % 3]))) return false;
    for (int j = 0; j < 3; ++j) {
      if (separates(cross(unitA[k], unitB[j]))) return false;
    }
  }
  return true;
}

}  // namespace otg::test
