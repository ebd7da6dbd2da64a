// SPDX-License-Identifier: BSD-3-Clause
// A heightfield of ODE, known to this library, made of a HeightGrid.
#pragma once

#include <ode/ode.h>

#include "base/triangle.h"
#include "scenes/height_grid.h"

namespace otg::scenes {

/// The data go with the object; a geom that has them must be gone by then.
class HeightfieldData {
 public:
  /// Throws std::runtime_error if it is refused.
  explicit HeightfieldData(const HeightGrid& grid);
  ~HeightfieldData();
  HeightfieldData(const HeightfieldData&) = delete;
  HeightfieldData& operator=(const HeightfieldData&) = delete;
  /// In the space, which may be null, with the grid's frame at `pose`. A rotation that is nearly one of right angles is
  /// made one: with others ODE's box of the field is too small, and spaces miss pairs.
  dGeomID makeGeom(dSpaceID space, const Transformd& pose) const;

 private:
  dHeightfieldDataID data_;
};

/// Whether the unit quaternion w, x, y, z takes axes to axes.
bool isOfRightAngles(const double rotation[4]);

}  // namespace otg::scenes
