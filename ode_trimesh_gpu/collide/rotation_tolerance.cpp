// SPDX-License-Identifier: BSD-3-Clause
#include "collide/rotation_tolerance.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "shared/tests/pair_bounds.h"

namespace otg {

double rotationDefect(const Transformd& pose) {
  const double squared = otgRotationDefectSquared(pose);
  return squared >= 0 && std::isfinite(squared) ? std::sqrt(squared) : std::numeric_limits<double>::infinity();
}

void requireRigid(const Transformd& bInA) {
  if (!std::isfinite(bInA.t.x) || !std::isfinite(bInA.t.y) || !std::isfinite(bInA.t.z)) {
    throw std::invalid_argument("the pose of mesh B in A's frame is not finite");
  }
  const double defect = rotationDefect(bInA);
  if (defect <= kRelativeRotationTolerance) return;
  throw std::invalid_argument("the pose of mesh B in A's frame is no rotation: its defect is " +
                              std::to_string(defect) + ", at most " + std::to_string(kRelativeRotationTolerance) +
                              " can be worked with");
}

}  // namespace otg
