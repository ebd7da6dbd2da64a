// SPDX-License-Identifier: BSD-3-Clause
// A pair with solids whose components overlap (bvh/solid_parts.h), as pairs of their parts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/query.h"

namespace otg {

/// A whole mesh, or a part of one.
struct MeshPart {
  const CollisionMesh* whole;
  const CollisionMesh* mesh;
  const SolidParts::Part* part = nullptr;  ///< null for a whole mesh
  std::uint32_t number = 0;                ///< of the part

  /// The whole mesh's numbers for the part's.
  std::uint32_t triangle(std::uint32_t t) const;
  std::uint32_t vertex(std::uint32_t welded) const;
  std::uint32_t edge(std::uint32_t e) const;
};

struct PartPair {
  MeshPart a, b;
  Query query;  ///< of the parts, in the frame of the whole
  std::vector<TrianglePair> meeting{};
  std::size_t begin = 0, end = 0;  ///< into the contacts: those that the parts have with each other
  double volume = 0;               ///< of their overlap
  std::vector<Vec3d> middles{};    ///< of the bounds of its regions, in A's frame
};

/// All parts of A with all parts of B, in this order. `meeting`: the pairs of triangles that intersect, of the whole
/// meshes.
std::vector<PartPair> pairsOfParts(const Query& query, std::span<const TrianglePair> meeting);

/// Gives contacts of parts the whole meshes' numbers of triangles, vertices and edges. A feature may be in several
/// parts of the other mesh: their number is added to the ordinal.
void numberAsWhole(std::span<const PartPair> pairs, std::span<Contact> contacts);

/// Drops contacts with walls that lie inside another part. What two parts have in common may lie in another part of one
/// of the meshes. The translation that the contacts of all others request may take the two apart. Then their own
/// contacts add places, but no directions: where a block ends in a floor, flush with its top, a body that slides over
/// the end meets no wall. The smallest overlap comes first. `scratch` is for queries of parts after a translation.
void dropWallsInside(std::span<const PartPair> pairs, std::vector<Contact>& contacts, Workspace& scratch);

}  // namespace otg
