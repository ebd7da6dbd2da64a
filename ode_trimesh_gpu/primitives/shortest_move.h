// SPDX-License-Identifier: BSD-3-Clause
// What contacts ask for together.
#pragma once

#include <optional>
#include <span>

#include "collide/query.h"

namespace otg {

/// The shortest translation of the second body by which it moves at least `depth` against every contact's normal; none
/// where the contacts leave no such way.
std::optional<Vec3d> shortestMove(std::span<const Contact> contacts);

}  // namespace otg
