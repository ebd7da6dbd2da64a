// SPDX-License-Identifier: BSD-3-Clause
// What the contacts of two meshes are a function of.
#pragma once

#include <cstdint>
#include <memory>

#include "collide/query.h"

namespace otg {

struct PairTask;

/// Whether a mesh is the very one, with its vertices where they were. By CollisionMesh::lifetime(): addresses alone
/// would not show it, because another mesh may lie at the same one by now.
bool isSameMesh(const std::weak_ptr<const void>& x, const std::weak_ptr<const void>& y);

/// What the contacts of a pair depend on.
struct PairQuery {
  static constexpr bool kIsWhole = true;  ///< see KeptContacts
  std::weak_ptr<const void> a, b;         ///< CollisionMesh::lifetime(): a mesh that has moved is another
  Transformd pose{};                      ///< of B in A
  Vec3d velocity{0, 0, 0};                ///< relative
  CollideOptions options;                 ///< with as many contacts as the geoms allow
  std::uint64_t stamp = 0;                ///< of what is remembered of the pair
  bool remembers = false;
};

/// The query of a prepared task, with the stamp of what is remembered of the pair.
PairQuery pairQuery(const PairTask& task, std::uint64_t stamp);
/// Whether two queries have the same result, to the last bit.
bool sameQuery(const PairQuery& x, const PairQuery& y);

}  // namespace otg
