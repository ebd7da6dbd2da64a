// SPDX-License-Identifier: BSD-3-Clause
// Which closed components of a mesh lie inside which: distinguishes outer surfaces from cavities.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// A closed component that lies inside another one.
struct Nesting {
  std::uint32_t inner, outer;
};
/// All of them. Of components that cross each other neither is inside the other. Faces may lie on each other: what is
/// looked at is inside, by the sign of Topology::componentVolume. Of two that lie on each other wholly, one that is
/// wound as a cavity has the other in it.
std::vector<Nesting> nestingsOf(const Topology& topology, std::span<const Vec3f> vertices,
                                std::span<const Triangle> triangles);

/// For each component the number of closed components that it lies inside; 0 for components that are not closed.
std::vector<std::uint32_t> nestingDepths(const Topology& topology, std::span<const Vec3f> vertices,
                                         std::span<const Triangle> triangles);

/// The sign that the volume of a component at this depth has in a well-wound mesh: walls outward, cavities inward.
inline double expectedVolumeSign(std::uint32_t depth) {
  return depth % 2 == 0 ? 1 : -1;
}

/// True if a closed component is wound as its depth requires. False also for one that encloses nothing (to within the
/// rounding of its volume), such as two copies of a triangle back to back.
std::vector<std::uint8_t> componentsWellWound(const Topology& topology, const std::vector<std::uint32_t>& depths,
                                              std::span<const Vec3f> vertices, std::span<const Triangle> triangles);

}  // namespace otg
