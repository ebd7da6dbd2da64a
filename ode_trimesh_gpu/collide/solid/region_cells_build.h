// SPDX-License-Identifier: BSD-3-Clause
// Large regions, described by the cells of a grid.
#pragma once

#include "collide/solid/region_work.h"

namespace otg {

/// The interior by the stars of its vertices, everything gathered in cells: the region's pieces, points, sums and
/// extent.
void describeByCells(RegionWork& work, std::uint32_t region);

}  // namespace otg
