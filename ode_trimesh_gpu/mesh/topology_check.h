// SPDX-License-Identifier: BSD-3-Clause
// Whether a topology that comes from elsewhere is that of its triangles.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "mesh/topology.h"

namespace otg {

/// What TriMeshCheck needs to know of the edges. Counts as in ValidationReport.
struct TopologyFindings {
  std::string fault;  ///< in words, empty where nothing is wrong
  std::size_t boundaryEdges = 0, nonManifoldEdges = 0, inconsistentEdges = 0;
};

/// Compares everything with what the triangles and Topology::weld say: the ends and the numbers of edges, which
/// half-edges have an edge and which a twin; which triangles are a component, and whether it is closed. Two vertices
/// that are one point lie at one place. Not compared: the direction of edges, the volumes of components, and whether
/// vertices at one place could be one point.
///
/// All numbers point into their arrays, and those of `twin` that are not kNone name each other and have the same edge:
/// TriMeshCheck has looked at that. Linear time. May throw std::bad_alloc.
TopologyFindings checkTopology(const Topology& topology, std::span<const Vec3f> vertices,
                               std::span<const Triangle> triangles);

}  // namespace otg
