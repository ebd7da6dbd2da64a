// SPDX-License-Identifier: BSD-3-Clause
// Pairs of triangles of meshes in which triangles lie on one another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/query.h"

namespace otg {

/// TriMesh::firstCopies() of both meshes of a query. The constructor may throw std::bad_alloc.
class FirstCopies {
 public:
  explicit FirstCopies(const Query& query) : a_(query.a->mesh().firstCopies()), b_(query.b->mesh().firstCopies()) {}
  /// Whether no triangle lies on another one.
  bool areAll() const { return a_.empty() && b_.empty(); }
  /// The pair of the first triangles that lie where these do.
  TrianglePair of(const TrianglePair& p) const { return {a_.empty() ? p.a : a_[p.a], b_.empty() ? p.b : b_[p.b]}; }
  bool has(const TrianglePair& p) const { return of(p) == p; }
  void dropOthers(std::vector<TrianglePair>& pairs) const {
    if (!areAll()) std::erase_if(pairs, [&](const TrianglePair& p) { return !has(p); });
  }

 private:
  std::span<const std::uint32_t> a_, b_;
};

}  // namespace otg
