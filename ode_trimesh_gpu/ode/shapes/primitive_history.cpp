// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/primitive_history.h"

#include <ode/objects.h>

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "collide/inward_body.h"
#include "collide/pair_history.h"

namespace otg {
namespace {

/// Describes the same motion for another origin of mesh B's frame.
void moveOrigin(SolidHistory& history, const Vec3d& from, const Vec3d& to) {
  const Vec3d d = otgSub(to, from);
  if (!(otgDot(d, d) > 0)) return;
  for (SolidHistory::State* state : {&history.before, &history.current}) {
    if (state->hasPose) state->pose.t = otgAdd(state->pose.t, otgRotate(state->pose, d));
  }
}

}  // namespace

std::uint64_t memoryKey(dGeomID geom) {
  return PairMemory::kOfAddress | reinterpret_cast<std::uintptr_t>(geom);
}

PrimitiveHistory::PrimitiveHistory(const PrimitiveTask& task, const Vec3d& origin)
    : memory_(task.side.object->memory),
      key_(memoryKey(task.o2)),
      origin_(origin),
      remembers_(task.side.object->remembersWith(dGeomGetClass(task.o2))),
      detached_(task.detached) {
  if (!remembers_) return;
  if (detached_ != nullptr) {
    history_ = detached_->history;
    return;
  }
  Vec3d then{0, 0, 0};
  if (memory_.recall(key_, history_, &then) != 0) moveOrigin(history_, then, origin_);
}

void PrimitiveHistory::keep(bool hasContacts) {
  const bool isKept = remembers_ && history_.used && (hasContacts || history_.current.outlastsContacts());
  if (detached_ != nullptr) {
    *detached_ = {isKept ? history_ : SolidHistory{}, true, isKept};
  } else if (isKept) {
    memory_.store(key_, history_, origin_);
  } else {
    memory_.forget(key_);
  }
}

DetachedHistory detachedHistory(const PrimitiveTask& task) {
  DetachedHistory detached;
  GeomObject& object = *task.side.object;
  if (object.remembersWith(dGeomGetClass(task.o2))) object.memory.recall(memoryKey(task.o2), detached.history);
  return detached;
}

std::optional<std::uint64_t> leaveHistory(const PrimitiveTask& task, const DetachedHistory& left) {
  if (!left.isTouched) return std::nullopt;
  PairMemory& memory = task.side.object->memory;
  const std::uint64_t key = memoryKey(task.o2);
  if (left.isKept) return memory.store(key, left.history);
  memory.forget(key);
  return 0;
}

void turnInward(PrimitiveTask& task) {
  if (task.side.object->params.contact_model == dGPUTRIMESH_CONTACTS_PAIRWISE) return;
  if (task.side.join != nullptr || task.side.mesh->turned() == nullptr) return;
  const int classOfOther = dGeomGetClass(task.o2);
  // What has no middle is no visitor of a room, nor is what is larger.
  const CollisionMesh* body = task.side.mesh->turned();
  if (classOfOther != dPlaneClass && classOfOther != dHeightfieldClass) {
    dReal box[6];
    dGeomGetAABB(task.o2, box);
    const double size = norm(Vec3d{box[1] - box[0], box[3] - box[2], box[5] - box[4]});
    const double sizeOfMesh = 2 * static_cast<double>(task.side.mesh->mesh().radius());
    if (size < sizeOfMesh) {
      PrimitiveHistory history(task);
      SolidHistory::State& before = task.sideBefore.emplace();
      if (history.get() != nullptr) {
        before = stateBefore(*history.get(), poseToRemember(task), {0, 0, 0}, kFarFromSide * size);
      }
      body = bodyFromOutside(*task.side.mesh, before, task.other.t);
      task.isOutside = body != nullptr;
    }
  }
  if (body != nullptr) task.side.mesh = body;
}

void rememberSide(const PrimitiveTask& task) {
  PrimitiveHistory history(task);
  if (history.get() == nullptr) return;
  if (task.isOutside) rememberOutside(poseToRemember(task), *history.get());
  rememberSideBefore(*task.sideBefore, *history.get());
  if (history.get()->used) history.keep(true);
}

void forgetPrimitive(const PrimitiveTask& task) {
  if (task.detached != nullptr) {
    *task.detached = {{}, true, false};
    return;
  }
  task.side.object->memory.forget(memoryKey(task.o2));
}

Vec3d relativeVelocity(const PrimitiveTask& task, const Vec3d& at) {
  const auto velocityAt = [&](dGeomID geom) {
    const dBodyID body = dGeomGetBody(geom);
    if (body == nullptr) return Vec3d{0, 0, 0};
    dVector3 v;
    dBodyGetPointVel(body, static_cast<dReal>(at.x), static_cast<dReal>(at.y), static_cast<dReal>(at.z), v);
    return Vec3d{v[0], v[1], v[2]};
  };
  const Vec3d v = otgRotateBack(task.pose, otgSub(velocityAt(task.o1), velocityAt(task.o2)));
  return std::isfinite(v.x + v.y + v.z) ? v : Vec3d{0, 0, 0};
}

}  // namespace otg
