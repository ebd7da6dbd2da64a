// SPDX-License-Identifier: BSD-3-Clause
#include "collide/rotation_tolerance.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace otg {

double rotationDefect(const Transformd& pose) {
  const double* const r = pose.r;
  double squares = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double off = r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j] - (i == j ? 1.0 : 0.0);
      squares += off * off;
    }
  }
  const double determinant =
      r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]);
  return determinant > 0 && std::isfinite(squares) ? std::sqrt(squares) : std::numeric_limits<double>::infinity();
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
