// SPDX-License-Identifier: BSD-3-Clause
// The report about an accepted mesh.
#pragma once

#include <cstdint>
#include <span>

#include "mesh/topology.h"
#include "mesh/validation.h"

namespace otg {

/// Fills everything in `report` that is said about an accepted mesh except `repair`.
void inspectMesh(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, const Topology& topology,
                 std::span<const std::uint8_t> degenerate, ValidationReport& report);

}  // namespace otg
