// SPDX-License-Identifier: BSD-3-Clause
// The table `kink` of `otg bench heightfield`.
#pragma once

#include "cli/command.h"

namespace otg::cli {

/// How deep a box of 0.6 m sinks into a heightfield that it slides over where the ground has a concave kink: as a mesh
/// and as ODE's box, for valleys whose sides rise differently, each with and without friction, straight and turned. The
/// last row is of all.
Json kinkRows();

}  // namespace otg::cli
