// SPDX-License-Identifier: BSD-3-Clause
// A pair of bodies as geoms, asked for their contacts as a program asks: by dCollide, without history.
#pragma once

#include <vector>

#include "truth/certificate.h"

namespace otg::truth {

struct GeomChoices {
  bool secondFirst = false;   ///< the geom of B is created before that of A
  bool byUpdate = false;      ///< meshes are built from other vertices and moved to theirs
  bool reversedCall = false;  ///< dCollide(B, A), the answer turned round
  int places = 64;
  bool asTriMesh = false;  ///< meshes are ODE's dTriMesh: stock ODE's contacts, or with the override the library's
};

/// ODE and the geom class must be initialised. Throws std::runtime_error where the library refuses a mesh.
std::vector<JudgedContact> contactsInOde(const PairBody& a, const PairBody& b, const GeomChoices& choices);

}  // namespace otg::truth
