// SPDX-License-Identifier: BSD-3-Clause
#include "collide/pair_history.h"

#include <algorithm>
#include <cstring>

#include "base/vectors.h"

namespace otg {
namespace {

bool samePose(const Transformd& a, const Transformd& b) {
  // By their bits, -0 and 0 apart: the same bytes are promised for the same bytes.
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

/// By more than 60 degrees.
bool hasTurnedFar(const Transformd& from, const Transformd& to) {
  double trace = 0;  // of the rotation between the two: 1 + 2 cos
  for (int i = 0; i < 9; ++i) trace += from.r[i] * to.r[i];
  return trace < 2;
}

}  // namespace

bool isSolid(const TriMesh& mesh) {
  return mesh.meshClass() == MeshClass::kSolid;
}

Vec3d middleOfB(const Query& query, const Transformd& bInA) {
  const Vec3f& c = query.b->mesh().center();
  return otgTransform(bInA, Vec3d{c.x, c.y, c.z});
}

double smallerSize(const Query& query) {
  return 2 * static_cast<double>(std::min(query.a->mesh().radius(), query.b->mesh().radius()));
}

SolidHistory::State stateBefore(const Query& query) {
  SolidHistory::State state;
  if (query.history && query.history->used) {
    const bool again = samePose(query.history->current.pose, query.bInA);
    state = again ? query.history->before : query.history->current;
  }
  if (state.hasPose) {
    // A pair that jumped was put there, it did not move: what it did before says nothing. The direction of a deep
    // overlap is worth keeping only while the overlap is nearly the same.
    const double size = smallerSize(query);
    const Vec3d d = otgSub(middleOfB(query, state.pose), middleOfB(query, query.bInA));
    const double moved = norm(d);
    if (moved > 0.05 * size) state.deepNormal = {0, 0, 0};
    if (moved > 0.25 * size || hasTurnedFar(state.pose, query.bInA)) state = {};
  }
  return state;
}

void keepState(const Query& query, const SolidHistory::State& before, SolidHistory::State state) {
  if (!query.history) return;
  state.pose = query.bInA;
  state.hasPose = true;
  query.history->before = before;
  query.history->current = state;
  query.history->used = true;
}

bool isSheet(const TriMesh& mesh) {
  return !isSolid(mesh) && mesh.triangleCount() > 0 && mesh.report().inconsistentEdges == 0 &&
         mesh.report().nonManifoldEdges == 0;
}

bool haveSolidContacts(const TriMesh& a, const TriMesh& b) {
  return (isSolid(a) && (isSolid(b) || isSheet(b))) || (isSheet(a) && isSolid(b));
}

}  // namespace otg
