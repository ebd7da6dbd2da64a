// SPDX-License-Identifier: BSD-3-Clause
// When a scaled image of a mesh can do with the mesh's trees.
#pragma once

#include <optional>

#include "bvh/box_scale.h"
#include "bvh/tree.h"

namespace otg {

/// How boxes of `mesh` become those of its image with vertices times `factors`, which are finite and not zero. None
/// where they could not: numbers near the ends of single precision, or an image so far from its origin, or so small,
/// that a rounding of a vertex is no longer small beside it. It depends on nothing but the factors and the origins, and
/// on the bounds only whether there is one.
std::optional<BoxScale<float>> makeBoxScale(const TriMesh& mesh, const TriMesh& image, const Vec3f& factors);

/// Whether one of the factors is so many times another that a tree which was built for the mesh divides its image in
/// the wrong directions: up to kMostStretch queries of the image take up to 1.3 times what they do with a tree that was
/// built for it, at 64 up to twice that (docs/dtrimesh_map.md). sahCost() does not tell: it goes by the root, which
/// stretches as well.
bool stretchesTooMuch(const Vec3f& factors);
inline constexpr double kMostStretch = 16;

/// sahCost() of the image's boxes.
double sahCost(const BinaryTree& tree, const BoxScale<float>& scale);

}  // namespace otg
