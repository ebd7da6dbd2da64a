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
};

/// A region of the overlap of two parts.
struct PartRegion {
  std::size_t pair;        ///< which of the pairs
  std::size_t begin, end;  ///< into the contacts: its own
  Vec3d middle;            ///< of its bounds, in A's frame
  double volume;
};

/// All parts of A with all parts of B, in this order. `meeting`: the pairs of triangles that intersect, of the whole
/// meshes.
std::vector<PartPair> pairsOfParts(const Query& query, std::span<const TrianglePair> meeting);

/// 1 for a mesh without parts.
std::uint32_t countParts(const CollisionMesh& mesh);

/// A pair of the parts number i and j of the two meshes, without triangles.
PartPair pairOfParts(const Query& query, std::uint32_t i, std::uint32_t j);

/// Gives contacts of parts the whole meshes' numbers of triangles, vertices and edges. A feature may be in several
/// parts of the other mesh: their number is added to the ordinal.
void numberAsWhole(std::span<const PartPair> pairs, std::span<Contact> contacts);

/// Drops contacts with walls that lie inside another part. A region that two parts share may lie in another part of one
/// of the meshes. The translation that the contacts of all other regions request may take the two parts apart. Then its
/// own contacts add places, but no directions: where a block ends in a floor, flush with its top, a body that slides
/// over the end meets no wall. The smallest region comes first. `scratch` is for queries of parts after a translation.
void dropWallsInside(std::span<const PartPair> pairs, std::span<const PartRegion> regions,
                     std::vector<Contact>& contacts, Workspace& scratch);

}  // namespace otg
