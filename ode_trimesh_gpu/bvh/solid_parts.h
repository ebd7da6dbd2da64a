// SPDX-License-Identifier: BSD-3-Clause
// Solids whose components overlap each other, taken apart into solids whose components don't.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bvh/tree.h"
#include "mesh/tri_mesh.h"

namespace otg {

/// A body built of overlapping blocks has walls inside, where blocks reach into each other. A surface that crosses
/// itself there has no contour with another body that alternates. So each part is a mesh of its own, in the frame of
/// the whole: the triangles of some components, in the order of the whole.
struct SolidParts {
  struct Part {
    std::shared_ptr<const TriMesh> mesh;
    std::vector<std::uint32_t> triangleOf, vertexOf;  ///< the whole mesh's number of each
  };
  std::vector<Part> parts;
  std::vector<std::uint32_t> partOf, numberOf;  ///< of the whole mesh's triangles; kNone of those in no component
};

/// The parts of a solid. None for all other meshes, and for a solid without two components that overlap. None either
/// where there would be more than 64 parts, or one that is no solid. Components that touch, or overlap by no more than
/// roundingOfVertices(), stay in one part: their coincident faces are no walls. So do a cavity and the components
/// around it. Of other components, those that lie beside each other are together as far as they can be. Up to 64 convex
/// components, none of them beside another one, are a part each.
///
/// Two components overlap if triangles of both meet along a line of some length. One of them goes behind the other
/// there, and the line is not at the other's rim.
///
/// `tree` is that of the mesh, with boxes of its own. May throw std::bad_alloc. The time follows the triangles of all
/// components but the largest one, as far as their boxes meet those of others.
SolidParts takeSolidApart(const TriMesh& mesh, const BinaryTree& tree);

/// Whether takeSolidApart() has anything to do: the mesh is a solid of several components. A quick no for most.
bool mayHaveParts(const TriMesh& mesh);

}  // namespace otg
