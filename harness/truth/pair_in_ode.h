// SPDX-License-Identifier: BSD-3-Clause
// A pair of bodies as geoms, queried for their contacts as a program does: by dCollide, without history.
#pragma once

#include <vector>

#include "truth/body_in_ode.h"
#include "truth/certificate.h"

namespace otg::truth {

/// ODE and the geom class must be initialised. Throws std::runtime_error where the library refuses a mesh.
std::vector<JudgedContact> contactsInOde(const PairBody& a, const PairBody& b, const GeomChoices& choices);

}  // namespace otg::truth
