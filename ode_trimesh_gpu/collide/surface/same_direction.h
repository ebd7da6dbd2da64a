// SPDX-License-Identifier: BSD-3-Clause
// Directions that contacts of ODE's shapes take for one.
#pragma once

namespace otg {

/// The cosine of 3 degrees: unit vectors whose product is larger point the same way.
inline constexpr double kSameDirection = 0.9986;

}  // namespace otg
