// SPDX-License-Identifier: BSD-3-Clause
// A slot for bars that are too wide for it.
#pragma once

#include "scenes/concave_meshes.h"

namespace otg::test {

/// 1 wide and 1 high above z = 0, 3 long along y, between walls that are 0.3 thick.
inline scenes::MeshArrays makeSlot() {
  return scenes::makeProfile({{-0.8, -0.3}, {0.8, -0.3}, {0.8, 1}, {0.5, 1}, {0.5, 0}, {-0.5, 0}, {-0.5, 1}, {-0.8, 1}},
                             3);
}

}  // namespace otg::test
