// SPDX-License-Identifier: BSD-3-Clause
// A query of two meshes.
#pragma once

#include "collide/query.h"

namespace otg::test {

inline Query makeQuery(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = bInA;
  return query;
}

}  // namespace otg::test
