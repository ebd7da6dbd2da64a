// SPDX-License-Identifier: BSD-3-Clause
// The pairs of geoms that the broad phase of ODE's spaces finds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ode_trimesh_gpu/batch.h"

namespace otg {

/// Who computes a pair's contacts.
enum class PairKind : std::uint8_t {
  kMeshes,  ///< two meshes (isMeshFor())
  kShape,   ///< a mesh and a geom that contacts are computed ahead for (isShapePair()), in either order
  kOther,   ///< the rest: two geoms of ODE's own, rays, heightfields, geoms of other libraries
};

/// As the near callback gets it.
struct SpacePair {
  dGpuTriMeshPair pair;
  PairKind kind = PairKind::kOther;
};

enum class PairChoice { kWithMesh, kAll };  ///< kWithMesh: without kOther

/// Finds pairs as programs do whose near callback follows ODE's manual: a space that meets something is collided with
/// it, and the geoms of a space among themselves. Every pair once, in the order in which it is found first; not one of
/// two geoms of one body. `filter` may be null. Throws std::bad_alloc.
std::vector<SpacePair> findPairs(std::span<const dSpaceID> spaces, PairChoice choice, dGpuTriMeshPairFilter* filter,
                                 void* data);

}  // namespace otg
