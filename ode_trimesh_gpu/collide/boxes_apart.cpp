// SPDX-License-Identifier: BSD-3-Clause
#include "collide/boxes_apart.h"

#include <algorithm>
#include <cmath>

#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"

namespace otg {
namespace {

/// The bounds about TriMesh::center(), which is not quite in the middle of them.
struct Box {
  double middle[3], half[3];
  explicit Box(const TriMesh& mesh) {
    const Vec3f &low = mesh.boundsMin(), &high = mesh.boundsMax(), &center = mesh.center();
    const float lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    const float centers[3] = {center.x, center.y, center.z};
    for (int i = 0; i < 3; ++i) {
      middle[i] = centers[i];
      half[i] = std::max(highs[i] - middle[i], middle[i] - lows[i]);
    }
  }
};

}  // namespace

/// The axes of the two boxes, without the products of their edges.
/// Source: S. Gottschalk, M. Lin, D. Manocha, "OBBTree", 1996.
bool areBoxesApart(const TriMesh& a, const TriMesh& b, const Transformd& bInA, double defect) {
  const Box ofA(a), ofB(b);
  const double *const halfA = ofA.half, *const halfB = ofB.half, *const middleA = ofA.middle,
                      *const middleB = ofB.middle;
  const double t[3] = {bInA.t.x, bInA.t.y, bInA.t.z};
  const double* const r = bInA.r;
  double apart[3], sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double turned = r[3 * i] * middleB[0] + r[3 * i + 1] * middleB[1] + r[3 * i + 2] * middleB[2];
    apart[i] = turned + t[i] - middleA[i];
    sum += std::fabs(t[i]) + std::fabs(middleA[i]) + std::fabs(middleB[i]) + halfA[i] + halfB[i];
  }
  const double slack = 1e-9 * sum, radiusA = a.radius(), radiusB = b.radius();
  const double reachOfBalls = radiusA + (1 + defect) * radiusB + slack;
  if (apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2] > reachOfBalls * reachOfBalls) return true;
  for (int i = 0; i < 3; ++i) {
    const double reach = halfA[i] + std::fabs(r[3 * i]) * halfB[0] + std::fabs(r[3 * i + 1]) * halfB[1] +
                         std::fabs(r[3 * i + 2]) * halfB[2];
    if (std::fabs(apart[i]) > reach + slack) return true;
  }
  // Along a column of a pose that is no exact rotation B reaches farther than its half by this much at most.
  const double more = slack + defect * (halfB[0] + halfB[1] + halfB[2]);
  for (int j = 0; j < 3; ++j) {
    const double along = apart[0] * r[j] + apart[1] * r[3 + j] + apart[2] * r[6 + j];
    const double reach =
        halfB[j] + std::fabs(r[j]) * halfA[0] + std::fabs(r[3 + j]) * halfA[1] + std::fabs(r[6 + j]) * halfA[2];
    if (std::fabs(along) > reach + more) return true;
  }
  return false;
}

bool meetsNothing(const Query& query) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  if (query.options.contacts == ContactModel::kSolid && !(isSolid(a) && isSolid(b))) return false;
  if (a.triangleCount() == 0 || b.triangleCount() == 0) return false;
  return areBoxesApart(a, b, query.bInA, rotationDefect(query.bInA));
}

}  // namespace otg
