// SPDX-License-Identifier: BSD-3-Clause
// Closed bodies at random that have little in common with each other: rings, springs, turned parts, spiky balls, rough
// ground, frames of bars, plates and needles, piles of blocks, flush ones. About 1 in size.
#pragma once

#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"

namespace otg::truth {

/// A closed bar along a ring that is bent and waves up and down, about the z axis. `radius` is its own about.
scenes::MeshArrays randomRing(Random& random, double radius);
/// A bar along a helix about the z axis, with a flat cap at either end.
scenes::MeshArrays randomSpring(Random& random);
/// A jagged profile turned about the z axis: spools, goblets, flanges.
scenes::MeshArrays turnedBody(Random& random);
/// A ball whose vertices are pulled out or pushed in, each by itself.
scenes::MeshArrays spikyBall(Random& random);
/// A ball with smooth bumps and hollows, of 1,280 to 20,480 triangles: as finely divided as scanned bodies.
scenes::MeshArrays bumpyBall(Random& random);
/// A block whose upper side has a height of its own at each point of a grid.
scenes::MeshArrays roughGround(Random& random);
/// Bars along the edges of a grid of boxes: windows on all sides.
scenes::MeshArrays barFrame(Random& random);
/// A box that is very thin in one direction or two.
scenes::MeshArrays thinBox(Random& random);
/// Boxes that reach into each other, in one mesh: as a solid of components that overlap. None is inside another one.
scenes::MeshArrays blockPile(Random& random);
/// Boxes with flush faces, in one mesh, as floors of tiles, stairs and walls are built: a box in pieces, some of which
/// are lower or missing. Vertices may be shared. Also cubes in a grid, which touch along edges and in corners.
scenes::MeshArrays flushBlocks(Random& random);

}  // namespace otg::truth
