// SPDX-License-Identifier: BSD-3-Clause
// Numbering triangles and vertices so that what hangs together lies together in memory. Inside the mesh layer only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// A numbering that depends on connectivity alone: vertices that move do not change it, nor do triangles that are all
/// turned round. Neighbouring triangles are merged in pairs, these pairs in pairs, and so on: those first that share
/// most edges for their sizes (heavy edge matching; G. Karypis and V. Kumar, "A fast and high quality multilevel scheme
/// for partitioning irregular graphs", SIAM J. Sci. Comput. 20, 1998; the rating is that of M. Holtgrewe, P. Sanders
/// and C. Schulz, "Engineering a scalable high quality graph partitioner", IPDPS 2010). Triangles lie in the order of
/// this tree's leaves, ties by number. Vertices lie in the order in which those triangles use them, unused ones last.
/// Entry i is the old number of what gets number i. Linear time in practice.
struct LocalOrder {
  std::vector<std::uint32_t> triangles, vertices;
};
LocalOrder findLocalOrder(const Topology& topology, std::span<const Triangle> triangles);

/// The inverse of a permutation.
std::vector<std::uint32_t> inverseOf(std::span<const std::uint32_t> order);

/// What buildTopology would say of the renumbered mesh.
Topology renumber(const Topology& topology, const LocalOrder& order);

}  // namespace otg
