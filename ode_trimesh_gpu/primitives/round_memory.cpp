// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/round_memory.h"

#include <algorithm>

#include "collide/pair_history.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

constexpr double kFar = 2.5;  ///< radii: from there on a sheet is of no concern

}  // namespace

RoundMemory::RoundMemory(const CollisionMesh& mesh, const Transformd& pose, double radius, std::uint64_t content,
                         SolidHistory* history)
    : mesh_(mesh), pose_(pose), radius_(radius), content_(contentOf(mesh.mesh(), content)), history_(history) {
  if (history_ == nullptr || surfaceKindForShapes(mesh) != SurfaceKind::kSheet) return;
  before_ = stateBefore(*history_, pose_, {0, 0, 0}, 2 * radius);
  if (before_.side < 0) winding_ = -1;
}

void RoundMemory::finish(std::vector<Contact>& contacts) const {
  if (history_ == nullptr) return;
  *history_ = {};
  if (surfaceKindForShapes(mesh_) != SurfaceKind::kSheet) return;
  const MotionLimit limit(before_, pose_, content_);
  SolidHistory::State state;
  state.side = contacts.empty() ? sideOfApart() : std::min(before_.side, 0);
  state.pose = pose_;
  state.hasPose = true;
  state.deepest = limit.deepest(contacts);
  state.content = content_;
  history_->before = before_;
  history_->current = state;
  history_->used = true;
  limit.cut(contacts);
}

int RoundMemory::sideOfApart() const {
  return isInside(mesh_, pose_.t, closestPoint(mesh_, pose_.t, kFar * radius_)) ? -1 : 0;
}

}  // namespace otg
