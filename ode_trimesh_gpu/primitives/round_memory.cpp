// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/round_memory.h"

#include "base/vectors.h"

namespace otg {
namespace {

constexpr double kSlack = 0.25;  ///< radii: by so much a curved sheet may exceed what the motion allows

}  // namespace

RoundMemory::RoundMemory(const CollisionMesh& mesh, const Transformd& pose, double radius, double reach,
                         std::uint64_t content, SolidHistory* history)
    : pose_(pose),
      radius_(radius),
      content_(contentOf(mesh.mesh(), content)),
      history_(history),
      isSheet_(history != nullptr && isSheet(mesh.mesh())) {
  if (!isSheet_) return;
  before_ = stateBefore(*history_, pose_, {0, 0, 0}, 2 * reach);
  limit_ = MotionLimit(before_, pose_, content_);
}

bool RoundMemory::isFromBehind(const Vec3d& on, const Vec3d& out, double distance) const {
  Contact through;
  through.position = on;
  through.normal = out * -1.0;
  return radius_ + distance > limit_(through) + kSlack * radius_;
}

void RoundMemory::finish(std::vector<Contact>& contacts) const {
  if (history_ == nullptr) return;
  *history_ = {};
  if (!isSheet_) return;
  SolidHistory::State state;
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
