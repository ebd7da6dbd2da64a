// SPDX-License-Identifier: BSD-3-Clause
// Calls the program's callbacks for the triangles of one pair of geoms while it is collided.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "ode/pairs/pair_task.h"

namespace otg {

/// Each callback is called for each triangle, or pair of triangles, once in a query. The order of these calls
/// depends on the meshes and poses alone.
class PairCallbacks final : public PairFilter {
 public:
  /// `of1` and `of2`: of the task's sides.
  PairCallbacks(const PairTask& task, const GeomCallbacks& of1, const GeomCallbacks& of2)
      : task_(task), ofA_(task.first ? of1 : of2), ofB_(task.first ? of2 : of1) {}
  bool dropPairs(const Query& query, Workspace& workspace) override;
  void finish(const Query& query, Workspace& workspace) override;

 private:
  /// Whether a geom's own callback lets a triangle (the caller's number) collide.
  bool mayCollide(bool ofA, std::uint32_t triangle);
  bool mayCollide(std::uint32_t triangleA, std::uint32_t triangleB);
  void tellTriangles(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

  const PairTask& task_;
  const GeomCallbacks ofA_, ofB_;
  std::map<std::uint32_t, bool> answerA_, answerB_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> answer_;
};

/// Lets `merge`, of the geom of mesh A or of B, number each kept contact. The number stands for it and for those of
/// `all` that it stands for: the nearest ones, of its own region if there are any there. Triangles are the caller's.
void mergeNumbers(dTriTriMergeCallback* merge, dGeomID geom, bool ofA, const std::vector<Contact>& all,
                  std::vector<Contact>& kept);

}  // namespace otg
