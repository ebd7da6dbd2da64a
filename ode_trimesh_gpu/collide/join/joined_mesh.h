// SPDX-License-Identifier: BSD-3-Clause
// Placed meshes whose surfaces continue each other, as one mesh: pieces of a terrain, slabs laid side by side.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "collide/join/shared_places.h"

namespace otg {

/// Parts that hang together, with what lies between them taken away.
struct JoinedMesh {
  struct Source {
    std::uint32_t part;      ///< number among all parts that were given
    std::uint32_t triangle;  ///< its caller's number
  };
  std::shared_ptr<const CollisionMesh> mesh;  ///< in the frame of the pose of all parts
  std::vector<Source> sourceOf;               ///< by its callers' numbers of triangles
  std::vector<std::uint32_t> parts;           ///< ascending
};

/// Solids hang together where faces of theirs lie on each other, edge on edge; sheets where edges of their rims do and
/// both sides are wound alike. Vertices meet if they are as near as rounding to single precision leaves them. Solids
/// lose the faces that lie on each other. Other meshes are left out, and so are parts that would not make a solid, or
/// a sheet, of what they are. Throws std::bad_alloc.
std::vector<JoinedMesh> joinMeshes(std::span<const JoinPart> parts);

}  // namespace otg
