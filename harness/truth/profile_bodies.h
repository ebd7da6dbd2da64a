// SPDX-License-Identifier: BSD-3-Clause
// Prisms with many inner corners: stars, combs, hooks and spirals.
#pragma once

#include <string>

#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"

namespace otg::truth {

struct ProfileBody {
  scenes::MeshArrays mesh;
  std::string what;
};

/// One of the kinds at random, about 1 in size.
ProfileBody randomProfile(Random& random);

}  // namespace otg::truth
