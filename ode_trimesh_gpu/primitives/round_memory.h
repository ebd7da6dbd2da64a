// SPDX-License-Identifier: BSD-3-Clause
// What the pair of a sheet with a sphere or a capsule remembers.
#pragma once

#include <vector>

#include "collide/query.h"

namespace otg {

/// A shape that was behind a sheet while the two were apart is held there. Without that its first contact would draw it
/// through to the front. And no contact is deeper than the motion since the last query allows: past a rim it may show
/// all at once. Both are rules of solids (collide/shell/shell_approach.h, MotionLimit). Pairs with other meshes
/// remember nothing here.
class RoundMemory {
 public:
  /// `pose`: of the shape in the mesh's frame, that of a ball unrotated. `radius`: of a ball around the shape.
  /// `content`: a number that changes with the shape. `history` may be null.
  RoundMemory(const CollisionMesh& mesh, const Transformd& pose, double radius, std::uint64_t content,
              SolidHistory* history);
  /// 1 if the shape belongs to the side that the triangles' normals lead to, else -1.
  int winding() const { return winding_; }
  /// Cuts the contacts, and leaves in the history what is to be remembered.
  void finish(std::vector<Contact>& contacts) const;

 private:
  int sideOfApart() const;

  const CollisionMesh& mesh_;
  Transformd pose_;
  double radius_;
  std::uint64_t content_;
  SolidHistory* history_;
  SolidHistory::State before_;
  int winding_ = 1;
};

}  // namespace otg
