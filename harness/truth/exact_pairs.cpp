// SPDX-License-Identifier: BSD-3-Clause
// Separating axes: two triangles have no point in common if their projections on one of a few directions are apart. The
// directions are known: normals of both, cross products of edges, and in a common plane the normals of the edges there.
#include "truth/exact_pairs.h"

#include <algorithm>
#include <cmath>

#include "truth/dyadic.h"

namespace otg::truth {
namespace {

struct ExactVector {
  Dyadic x, y, z;
};

ExactVector exact(const Vec3d& v) {
  return {v.x, v.y, v.z};
}
ExactVector operator-(const ExactVector& a, const ExactVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Dyadic dot(const ExactVector& a, const ExactVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
bool isZero(const ExactVector& v) {
  return v.x.sign() == 0 && v.y.sign() == 0 && v.z.sign() == 0;
}

struct Placed {
  ExactVector corner[3], edge[3], normal;
  Vec3d low, high;
  bool hasArea;
  explicit Placed(const ExactTriangle& triangle) : low(triangle.placed[0]), high(low) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = triangle.placed[k];
      corner[k] = exact(p);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    for (int k = 0; k < 3; ++k) edge[k] = corner[(k + 1) % 3] - corner[k];
    normal = cross(edge[0], edge[1]);
    const ExactVector a = exact(triangle.own[0]), b = exact(triangle.own[1]), c = exact(triangle.own[2]);
    hasArea = !isZero(normal) && !isZero(cross(b - a, c - a));
  }
};

bool boxesMeet(const Placed& a, const Placed& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

bool separates(const ExactVector& axis, const Placed& a, const Placed& b) {
  Dyadic low[2], high[2];
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < 3; ++k) {
      const Dyadic at = dot(axis, (side == 0 ? a : b).corner[k]);
      if (k == 0 || at < low[side]) low[side] = at;
      if (k == 0 || high[side] < at) high[side] = at;
    }
  }
  return high[0] < low[1] || high[1] < low[0];
}

bool meet(const Placed& a, const Placed& b) {
  if (!boxesMeet(a, b)) return false;
  if (separates(a.normal, a, b) || separates(b.normal, a, b)) return false;
  for (const ExactVector& e : a.edge) {
    for (const ExactVector& f : b.edge) {
      if (separates(cross(e, f), a, b)) return false;
    }
  }
  if (!isZero(cross(a.normal, b.normal))) return true;
  for (const Placed* side : {&a, &b}) {
    for (const ExactVector& e : side->edge) {
      if (separates(cross(side->normal, e), a, b)) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<ExactTriangle> exactTriangles(const TriMesh& mesh) {
  std::vector<ExactTriangle> out(mesh.triangleCount());
  for (std::size_t t = 0; t < out.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.vertices()[mesh.triangles()[t].v[k]];
      out[t].own[k] = {v.x, v.y, v.z};
    }
    out[t].placed = out[t].own;
  }
  return out;
}

std::vector<ExactTriangle> exactTriangles(const TriMesh& mesh, const Transformd& pose) {
  std::vector<ExactTriangle> out = exactTriangles(mesh);
  for (ExactTriangle& t : out) {
    for (Vec3d& p : t.placed) p = otgTransform(pose, p);
  }
  return out;
}

std::vector<TrianglePair> pairsBySeparation(const std::vector<ExactTriangle>& a, const std::vector<ExactTriangle>& b) {
  const std::vector<Placed> first(a.begin(), a.end()), second(b.begin(), b.end());
  std::vector<TrianglePair> out;
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    if (!first[i].hasArea) continue;
    for (std::uint32_t j = 0; j < second.size(); ++j) {
      if (second[j].hasArea && meet(first[i], second[j])) out.push_back({i, j});
    }
  }
  return out;
}

}  // namespace otg::truth
