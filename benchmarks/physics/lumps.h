// SPDX-License-Identifier: BSD-3-Clause
// Irregular bodies like a scanned figure: a trunk with limbs.
#pragma once

#include <cstdint>

#include "physics/shape.h"

namespace otg::physics {

/// A closed surface without self-intersections: a ball with six limbs that stick out, about 1 m across; 20 * 4^level
/// triangles, its limbs fixed by `seed`.
ShapePointer limbedShape(std::uint32_t seed, int level = 4);
/// The same as scans often are: trunk and limbs are closed parts of one mesh that run into each other.
ShapePointer patchedShape(std::uint32_t seed);

/// The largest distance of b's centre from a's along `direction` (unit) at which their surfaces touch, both unturned.
double touchingDistance(const Shape& a, const Shape& b, const Vec& direction);

}  // namespace otg::physics
