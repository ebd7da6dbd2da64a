// SPDX-License-Identifier: BSD-3-Clause
// Geoms that collide as the pieces of one surface.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "collide/join/joined_mesh.h"
#include "collide/query.h"

namespace otg {

/// Along the axes of the world; by itself all of it.
struct WorldBox {
  static constexpr double kAnywhere = 1e300;
  Vec3d low{-kAnywhere, -kAnywhere, -kAnywhere}, high{kAnywhere, kAnywhere, kAnywhere};
};
/// That of a box in a frame of its own.
WorldBox worldBox(const Vec3d& low, const Vec3d& high, const Transformd& pose);

/// What joined geoms share. Each pair of one of them and another geom is computed with the surface as a whole. It keeps
/// the contacts that lie on the piece. So the contacts of all pieces together are those of the whole.
struct MeshJoin {
  struct Part {
    Transformd pose;                     ///< of the geom in the world, when it was joined
    Transformd toPart;                   ///< from the frame of the surface to that of the geom
    Vec3d low, high;                     ///< bounds of the piece in the frame of the surface
    std::weak_ptr<const void> lifetime;  ///< of the mesh that was joined
  };
  std::shared_ptr<const CollisionMesh> mesh;
  Transformd pose;  ///< of the surface in the world, when it was joined
  std::vector<Part> parts;
  std::vector<JoinedMesh::Source> sourceOf;  ///< by the mesh's callers' triangles; parts as above
  /// One of the geoms is gone or has got another mesh: all collide by themselves.
  std::atomic<bool> isBroken{false};

  /// The piece that a contact belongs to: that of its triangle, if the other geom's box meets its own, so that the pair
  /// is sure to be queried; else the nearest one of which that is so. `at`: the surface in the world, where the
  /// other two are.
  std::uint32_t ownerOf(std::uint32_t callerTriangle, const Transformd& at, const Vec3d& position,
                        const WorldBox& other) const;
};

/// A geom's place in what it is joined to.
struct JoinedPart {
  std::shared_ptr<MeshJoin> join;
  std::uint32_t part = 0;

  /// The geom, and those that it is joined to, collide by themselves from now on.
  void leave() noexcept {
    if (join != nullptr) join->isBroken = true;
    *this = {};
  }
};

}  // namespace otg
