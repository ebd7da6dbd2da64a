// SPDX-License-Identifier: BSD-3-Clause
// How far a pose's matrix may be from a rotation. A matrix is used as given (nothing normalises it), and the box tests
// widen by its defect times the mesh's radius: harmless where the defect is rounding, ruinous where it is a scale.
#pragma once

#include "shared/math/vec3.h"
#include "shared/tests/pair_bounds.h"

namespace otg {

/// Of one pose, in the world or of B in A's frame, as users give it. Rounding to single precision costs about 2e-7,
/// writing a matrix with four decimals 2e-4.
constexpr double kRotationTolerance = OTG_ROTATION_TOLERANCE;

/// Of the pose of one mesh in the other's frame, which has the defects of both: with t for the tolerance,
/// t + t (1 + t).
constexpr double kRelativeRotationTolerance = OTG_RELATIVE_ROTATION_TOLERANCE;

/// The Frobenius norm of R^T R - 1; infinity where R mirrors, is singular, or is not finite or too large to judge.
/// (The norm of R R^T - 1 is the same.)
double rotationDefect(const Transformd& pose);

/// Whether rotationDefect() is at most `most`, and a number that it does not exceed -> `bound`. Quicker where the
/// matrix is a rotation but for rounding, as most are.
bool isRotationWithin(const Transformd& pose, double most, double& bound);

/// Throws std::invalid_argument unless the pose is finite and its defect at most kRelativeRotationTolerance.
void requireRigid(const Transformd& bInA);

}  // namespace otg
