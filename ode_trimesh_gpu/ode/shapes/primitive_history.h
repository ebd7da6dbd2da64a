// SPDX-License-Identifier: BSD-3-Clause
// What a mesh remembers of its pair with a geom of ODE's own.
#pragma once

#include <cstdint>
#include <optional>

#include "ode/shapes/primitive_task.h"

namespace otg {

/// Geoms of ODE have no serial number; addresses are never as large as this bit. A geom that gets the address of one
/// that is gone inherits its memory, unless that is of a place far away.
std::uint64_t memoryKey(dGeomID geom);

/// From before a query to after it.
class PrimitiveHistory {
 public:
  /// Recalls. `origin` is where the frame of the query's mesh B has its origin in the geom's own frame: it may be
  /// another one each time.
  explicit PrimitiveHistory(const PrimitiveTask& task, const Vec3d& origin = {0, 0, 0});
  /// For the query; null if nothing is to be remembered.
  SolidHistory* get() { return remembers_ ? &history_ : nullptr; }
  /// Stores what the query left, or forgets. May throw std::bad_alloc.
  void keep(bool hasContacts);

 private:
  PairMemory& memory_;
  std::uint64_t key_;
  Vec3d origin_;
  bool remembers_;
  DetachedHistory* detached_;
  SolidHistory history_;
};

/// What the mesh remembers, for a query with a history of its own,
DetachedHistory detachedHistory(const PrimitiveTask& task);
/// and what such a query leaves. The stamp of what is remembered now, 0 for nothing; none if the query did not touch
/// it. May throw std::bad_alloc.
std::optional<std::uint64_t> leaveHistory(const PrimitiveTask& task, const DetachedHistory& left);

/// Puts the body that it is in place of a mesh wound inward (collide/inward_body.h), unless the other geom is inside.
/// Of the model `solid` alone. May throw std::bad_alloc.
void turnInward(PrimitiveTask& task);
/// After the query, where task.sideBefore is set. May throw std::bad_alloc.
void rememberSide(const PrimitiveTask& task);

/// Without a query there is nothing to remember.
void forgetPrimitive(const PrimitiveTask& task);

/// Velocity of the mesh's body relative to the other geom's at a point of the world, in the mesh's frame.
Vec3d relativeVelocity(const PrimitiveTask& task, const Vec3d& at);

}  // namespace otg
