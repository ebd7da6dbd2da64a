// SPDX-License-Identifier: BSD-3-Clause
// The triangles of one mesh that the other's surface passes through, clipped.
#pragma once

#include "collide/solid/region_work.h"

namespace otg {

/// Clips every boundary triangle, and notes what its inside corners' stars hold of it: pieces and corrections, by
/// region.
void clipBoundary(RegionWork& work);

}  // namespace otg
