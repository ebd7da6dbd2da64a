// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/box_axes.h"

#include <cmath>

namespace otg {

ConvexAxis leastOfBoxes(const ConvexPair& pair, double size) {
  using Of = ConvexAxis::Of;
  const ConvexPolyhedron::Box &boxA = *pair.a().box(), &boxB = *pair.b().box();
  const double* const r = pair.pose().r;
  const Vec3d between = otgTransform(pair.pose(), boxB.middle) - boxA.middle;
  const double d[3] = {between.x, between.y, between.z};
  const double a[3] = {boxA.half.x, boxA.half.y, boxA.half.z}, b[3] = {boxB.half.x, boxB.half.y, boxB.half.z};
  const double slack = kFaceSlack * size;

  // B's faces first: B is the larger body, and what lies on it keeps to its normals.
  double least = 0, ofFaces = 0;
  int axis = -1;
  bool up = false, isOfB = true;
  for (int j = 0; j < 3; ++j) {
    const double column[3] = {r[j], r[3 + j], r[6 + j]};
    // A pose that is no exact rotation tilts the other sides of B.
    double reach = a[0] * std::fabs(column[0]) + a[1] * std::fabs(column[1]) + a[2] * std::fabs(column[2]);
    double square = 0;
    for (int k = 0; k < 3; ++k) {
      const double product = column[0] * r[k] + column[1] * r[3 + k] + column[2] * r[6 + k];
      reach += b[k] * std::fabs(product);
      if (k == j) square = product;
    }
    const double along = d[0] * column[0] + d[1] * column[1] + d[2] * column[2];
    const double overlap = (reach - std::fabs(along)) / std::sqrt(square);
    if (overlap < 0) return {};
    if (axis >= 0 && !(overlap < least)) continue;
    least = overlap;
    axis = j;
    up = along < 0;  // the face that looks at A's middle
  }
  ofFaces = (1 - kFaceShare) * least - slack;
  for (int i = 0; i < 3; ++i) {
    const double* const row = r + 3 * i;
    const double reach = a[i] + b[0] * std::fabs(row[0]) + b[1] * std::fabs(row[1]) + b[2] * std::fabs(row[2]);
    const double overlap = reach - std::fabs(d[i]);
    if (overlap < 0) return {};
    // B's faces keep their place where A's are not clearly better.
    if (!(overlap < (isOfB ? ofFaces : least))) continue;
    least = overlap;
    axis = i;
    up = d[i] > 0;
    isOfB = false;
  }

  constexpr double kParallel2 = 1e-10;  // closer edges say no more than the faces beside them
  double best = least, product[3] = {0, 0, 0};
  bool isEdges = false, isAhead = false;
  for (int i = 0; i < 3; ++i) {
    const int y = (i + 1) % 3, z = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      // The product of A's axis i and B's axis j, of this length.
      const double alongY = -r[3 * z + j], alongZ = r[3 * y + j];
      const double square = alongY * alongY + alongZ * alongZ;
      if (!(square > kParallel2)) continue;
      double reach = a[y] * std::fabs(alongY) + a[z] * std::fabs(alongZ);
      for (int k = 0; k < 3; ++k) {
        if (k != j) reach += b[k] * std::fabs(alongY * r[3 * y + k] + alongZ * r[3 * z + k]);
      }
      const double along = d[y] * alongY + d[z] * alongZ, overlap = reach - std::fabs(along);
      if (overlap < 0) return {};
      const double most = (1 - kFaceShare) * best - slack;
      if (!(most > 0) || !(overlap * overlap < most * most * square)) continue;
      const double scale = 1 / std::sqrt(square);
      best = overlap * scale;
      isEdges = true;
      isAhead = along >= 0;
      product[i] = 0;
      product[y] = alongY * scale;
      product[z] = alongZ * scale;
    }
  }
  if (isEdges) {
    const Vec3d m{product[0], product[1], product[2]};
    return {Of::kEdges, isAhead ? m : otgScale(m, -1.0), best, kNone};
  }
  const std::uint32_t face = (isOfB ? boxB : boxA).face[axis][up];
  const Vec3d outward = isOfB ? unit(pair.normal(1, face)) : pair.normal(0, face);
  return {isOfB ? Of::kFaceB : Of::kFaceA, isOfB ? otgScale(outward, -1.0) : outward, least, face};
}

}  // namespace otg
