// SPDX-License-Identifier: BSD-3-Clause
// The shortest translation that separates two bodies of any form, found by trying.
#pragma once

#include <optional>
#include <vector>

#include "truth/pair_oracle.h"

namespace otg::truth {

/// `guess` is the length to begin with, at least some thousandth of the result. `starts` are directions that may be
/// good, beside many over the sphere and those of the faces that meet. None where nothing up to `most` separates.
/// The result does separate; directions that are not near a better one are missed only where they are rarer than one
/// in sixty.
std::optional<Vec3d> shortestSeparation(PairOracle& oracle, double guess, double most,
                                        const std::vector<Vec3d>& starts);

/// The same where a translation that separates is known already: begins again if `direction` is a better one.
Vec3d shorterSeparation(PairOracle& oracle, const Vec3d& known, const Vec3d& direction);

}  // namespace otg::truth
