// SPDX-License-Identifier: BSD-3-Clause
#include "collide/inward_body.h"

#include <utility>

#include "base/same_bits.h"
#include "collide/inside_test.h"

namespace otg {

const CollisionMesh* bodyFromOutside(const CollisionMesh& mesh, const SolidHistory::State& before,
                                     const Vec3d& middle) {
  const CollisionMesh* const body = mesh.turned();
  if (body == nullptr) return nullptr;
  // A room is a sheet, whose pairs are remembered.
  const bool isInside = before.hasPose ? before.side >= 0 : pointInMesh(*body, middle);
  return isInside ? nullptr : body;
}

void rememberOutside(const Transformd& bInA, SolidHistory& history) {
  if (!history.used || !sameBits(history.current.pose, bInA)) {
    history.before = std::exchange(history.current, {});
    history.current.pose = bInA;
    history.current.hasPose = true;
    history.used = true;
  }
  history.current.side = -1;
}

void rememberSideBefore(const SolidHistory::State& before, SolidHistory& history) {
  if (!history.used || history.before.hasPose || !before.hasPose) return;
  history.before.pose = before.pose;
  history.before.hasPose = true;
  history.before.side = before.side;
}

}  // namespace otg
