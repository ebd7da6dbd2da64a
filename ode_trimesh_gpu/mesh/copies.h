// SPDX-License-Identifier: BSD-3-Clause
// Triangles that lie on one another: queries look at one of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// For each triangle the first one with the same three points in the same turn, as Topology::weld says what is one
/// point: itself, but for copies. Empty where there are none. Linear time. May throw std::bad_alloc.
std::vector<std::uint32_t> findFirstCopies(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld);

}  // namespace otg
