// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/kept_shapes.h"

namespace otg {

bool isKeptClass(int geomClass) noexcept {
  switch (geomClass) {
    case dBoxClass:
    case dCapsuleClass:
    case dCylinderClass:
    case dConvexClass:
      return true;
    default:
      return false;
  }
}

}  // namespace otg
