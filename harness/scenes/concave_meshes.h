// SPDX-License-Identifier: BSD-3-Clause
// Closed meshes with inner corners: what bodies slide into.
#pragma once

#include <utility>
#include <vector>

#include "scenes/generated_meshes.h"

namespace otg::scenes {

/// A corner of a polygon: x and z.
using ProfilePoint = std::pair<double, double>;

/// The polygon (counter-clockwise seen along +y, so that x runs to the right and z up; simple, not closed) as a solid
/// from y = -width / 2 to y = width / 2. The ends are triangulated by clipping ears. Throws std::invalid_argument for
/// a polygon that goes the other way round or crosses itself.
MeshArrays makeProfile(const std::vector<ProfilePoint>& polygon, double width);

/// L-shaped: a floor and a wall of thickness `wall`, both of length `size`; the inner corner is along y at (wall,
/// wall).
MeshArrays makeCorner(double size, double wall, double width);

/// A room: the box-shaped cavity of inner size `size`, centred at the origin, in a box whose walls are `wall` thick.
MeshArrays makeRoom(Vec3d size, double wall);

/// A tray that is open above: inner size `size`, the inner floor centred at the origin, walls and floor `wall` thick.
MeshArrays makeTray(Vec3d size, double wall);

/// Each triangle divided into four, `levels` times: the same surface.
MeshArrays subdivided(const MeshArrays& mesh, int levels = 1);

}  // namespace otg::scenes
