// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/triangle_area.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "shared/math/expansion.h"

namespace otg {
namespace {

double largestPart(const Vec3d& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// (p1 - p0) x (p2 - p0) along axis k, rounded once or twice.
double crossExactly(const double (*p)[3], int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  double a[2], b[2], c[2], d[2], terms[16];
  const int na = otgExactDifference(p[1][i], p[0][i], a), nd = otgExactDifference(p[2][j], p[0][j], d);
  const int nb = otgExactDifference(p[1][j], p[0][j], b), nc = otgExactDifference(p[2][i], p[0][i], c);
  const int count = otgExpansionMinor(na, a, nd, d, nb, b, nc, c, terms);
  double sum = 0;
  for (int t = 0; t < count; ++t) sum += terms[t];  // the smallest first
  return sum;
}

}  // namespace

Vec3d areaVector2(const TriMesh& mesh, std::uint32_t triangle) {
  double p[3][3];
  for (int k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices()[mesh.triangles()[triangle].v[k]];
    p[k][0] = v.x;
    p[k][1] = v.y;
    p[k][2] = v.z;
  }
  const Vec3d e{p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]};
  const Vec3d f{p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
  const Vec3d n = otgCross(e, f);
  constexpr double kEnough = 1e-6;  // of the digits are left: products are off by some 1e-16
  if (largestPart(n) > kEnough * largestPart(e) * largestPart(f)) return n;
  return {crossExactly(p, 0), crossExactly(p, 1), crossExactly(p, 2)};
}

}  // namespace otg
