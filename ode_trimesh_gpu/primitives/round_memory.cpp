// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/round_memory.h"

#include <algorithm>

#include "base/vectors.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

// Radii.
constexpr double kSlack = 0.25;  ///< by so much a curved sheet may exceed what the motion allows
constexpr double kFar = 5;       ///< from there on a sheet is of no concern

}  // namespace

RoundMemory::RoundMemory(const CollisionMesh& mesh, const Transformd& pose, double radius, double reach,
                         std::uint64_t content, SolidHistory* history)
    : mesh_(&mesh),
      pose_(pose),
      radius_(radius),
      content_(contentOf(mesh.mesh(), content)),
      history_(history),
      isSheet_(history != nullptr && isSheet(mesh.mesh())) {
  if (!isSheet_) return;
  before_ = stateBefore(*history_, pose_, {0, 0, 0}, 2 * reach);
  limit_ = MotionLimit(before_, pose_, content_);
}

bool RoundMemory::isFromBehind(const Vec3d& on, const Vec3d& out, double distance) {
  if (before_.side > 0) return false;
  Contact through;
  through.position = on;
  through.normal = out * -1.0;
  const bool isIt = radius_ + distance > limit_(through) + kSlack * radius_;
  isBehind_ = isBehind_ || isIt;
  return isIt;
}

/// As of solids (sideBehind()), but that it is -1 only while the shape touches the back.
int RoundMemory::sideAfter(bool hasContacts) const {
  if (hasContacts) return isBehind_ ? -1 : std::max(before_.side, 0);
  const bool wasInFront = before_.side > 0 || (before_.side == 0 && before_.deepest > 0);
  return wasInFront && isInside(*mesh_, pose_.t, closestPoint(*mesh_, pose_.t, kFar * radius_)) ? 1 : 0;
}

void RoundMemory::finish(std::vector<Contact>& contacts) {
  if (history_ == nullptr) return;
  *history_ = {};
  if (!isSheet_) return;
  SolidHistory::State state;
  state.side = sideAfter(!contacts.empty());
  state.pose = pose_;
  state.hasPose = true;
  state.deepest = limit_.deepest(contacts);
  state.content = content_;
  history_->before = before_;
  history_->current = state;
  history_->used = true;
  limit_.cut(contacts);
}

}  // namespace otg
