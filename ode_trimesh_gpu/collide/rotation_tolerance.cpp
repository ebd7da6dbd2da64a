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

bool isRotationWithin(const Transformd& pose, double most, double& bound) {
  constexpr double kOfRounding = 1e-9;
  const double* const r = pose.r;
  const double xx = r[0] * r[0] + r[3] * r[3] + r[6] * r[6] - 1, yy = r[1] * r[1] + r[4] * r[4] + r[7] * r[7] - 1,
               zz = r[2] * r[2] + r[5] * r[5] + r[8] * r[8] - 1, xy = r[0] * r[1] + r[3] * r[4] + r[6] * r[7],
               xz = r[0] * r[2] + r[3] * r[5] + r[6] * r[8], yz = r[1] * r[2] + r[4] * r[5] + r[7] * r[8];
  const double squares = (xx * xx + yy * yy) + (zz * zz + 2 * (xy * xy + (xz * xz + yz * yz)));
  const double determinant =
      (r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6])) + r[2] * (r[3] * r[7] - r[4] * r[6]);
  constexpr double kShare = 0.9;  // squares rounds otherwise than in rotationDefect()
  if (kOfRounding <= most && squares <= kShare * kOfRounding * kOfRounding && determinant > 0) {
    bound = kOfRounding;
    return true;
  }
  bound = rotationDefect(pose);
  return bound <= most;
}

void requireRigid(const Transformd& bInA) {
  if (!std::isfinite(bInA.t.x) || !std::isfinite(bInA.t.y) || !std::isfinite(bInA.t.z)) {
    throw std::invalid_argument("the pose of mesh B in A's frame is not finite");
  }
  double defect = 0;
  if (isRotationWithin(bInA, kRelativeRotationTolerance, defect)) return;
  throw std::invalid_argument("the pose of mesh B in A's frame is no rotation: its defect is " +
                              std::to_string(defect) + ", at most " + std::to_string(kRelativeRotationTolerance) +
                              " can be worked with");
}

}  // namespace otg
