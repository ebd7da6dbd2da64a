// SPDX-License-Identifier: BSD-3-Clause
// Pairs of closed bodies that fit each other at an acute angle: a wedge in a groove, a tile on a ridge, a hat on a
// pyramid. Both have their edge or apex at the origin, and the mover is put on from above, along -z.
#pragma once

#include <string>

#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"

namespace otg::truth {

struct FittingPair {
  scenes::MeshArrays host, mover;
  double angle = 0;  ///< between -z and the faces
  double along = 0;  ///< how far the mover is moved along y, where that changes nothing but what sticks out
  std::string what;
};

/// Half angles from 6.5 to 40 degrees: in narrower ones a way is longer than contacts may request. The mover is longer
/// or shorter than the groove, within it or over its end, and its edge may be blunt.
FittingPair wedgeInGroove(Random& random);
/// A tile of two boards on a longer or shorter ridge.
FittingPair tileOnRidge(Random& random);
/// A hollow pyramid of three to six sides on a pyramid of the same slope, which may have a flat top.
FittingPair hatOnPyramid(Random& random);

}  // namespace otg::truth
