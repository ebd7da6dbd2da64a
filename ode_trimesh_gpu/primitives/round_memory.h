// SPDX-License-Identifier: BSD-3-Clause
// What the pair of a sheet with a sphere or a capsule remembers.
#pragma once

#include <vector>

#include "collide/pair_history.h"

namespace otg {

/// How far the shape was in the sheet at the last query, and how it has moved since. A shape that cannot have come
/// through the sheet's front has come from behind, and is held there. And no contact is deeper than the motion allows
/// (MotionLimit). Pairs with other meshes remember nothing here.
class RoundMemory {
 public:
  /// `pose`: of the shape in the mesh's frame, that of a ball unrotated. `radius`: of the shape's round side, `reach`:
  /// of a ball around it. `content`: a number that changes with the shape. `history` may be null.
  RoundMemory(const CollisionMesh& mesh, const Transformd& pose, double radius, double reach, std::uint64_t content,
              SolidHistory* history);
  /// Nothing is remembered: a shape behind the sheet has come through.
  RoundMemory() = default;

  /// Notes where it is true. Whether a shape whose middle, or a point of its axis, lies `distance` behind the place
  /// `on` of the sheet came from there. `out`: unit, from the middle to the place.
  bool isFromBehind(const Vec3d& on, const Vec3d& out, double distance);
  /// Cuts the contacts, and leaves in the history what is to be remembered.
  void finish(std::vector<Contact>& contacts);

 private:
  int sideAfter(bool hasContacts) const;

  const CollisionMesh* mesh_ = nullptr;
  Transformd pose_{};
  double radius_ = 0;
  std::uint64_t content_ = 0;
  SolidHistory* history_ = nullptr;
  bool isSheet_ = false, isBehind_ = false;
  SolidHistory::State before_;
  MotionLimit limit_;
};

}  // namespace otg
