// SPDX-License-Identifier: BSD-3-Clause
// When a scaled image of a mesh can do with the mesh's trees.
#pragma once

#include <optional>

#include "bvh/box_scale.h"
#include "bvh/tree.h"

namespace otg {

/// How boxes of `mesh` become those of its image with vertices times `factors`, which are finite and not zero. None
/// where they could not: triangles in another order, numbers near the ends of single precision, or a rounding of a
/// vertex that is not small beside the image. That is so for images far from their origin, and for tiny ones. It
/// depends on nothing but the factors and the origins, and on the bounds only whether there is one.
std::optional<BoxScale<float>> makeBoxScale(const TriMesh& mesh, const TriMesh& image, const Vec3f& factors);

/// Whether one of the factors is many times another. Then a tree that was built for the mesh divides its image in the
/// wrong directions: up to kMostStretch queries take up to 1.3 times what they take with a tree of the image's own. At
/// 64 they take up to twice that (docs/dtrimesh_map.md). sahCost() hides this: it goes by the root, which stretches
/// as well.
bool stretchesTooMuch(const Vec3f& factors);
inline constexpr double kMostStretch = 16;

/// sahCost() of the image's boxes.
double sahCost(const BinaryTree& tree, const BoxScale<float>& scale);

}  // namespace otg
