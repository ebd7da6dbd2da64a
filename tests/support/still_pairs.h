// SPDX-License-Identifier: BSD-3-Clause
// Pairs that are asked about so often that answers are kept, beside pairs that are asked about once.
#pragma once

#include <vector>

#include "support/ode_world.h"

namespace otg::test {

/// Contacts as they are whatever the geoms' addresses.
inline std::vector<dContactGeom> asked(dGeomID mesh, dGeomID other, int places = 24) {
  std::vector<dContactGeom> contacts = collide(mesh, other, places);
  for (dContactGeom& c : contacts) {
    c.g1 = nullptr;
    c.g2 = nullptr;
  }
  return contacts;
}

/// Two geoms of one mesh. The first is asked so often that answers are kept, the second never twice.
struct StillPair {
  explicit StillPair(const scenes::MeshArrays& mesh) : data(mesh), often(data), once(data) {}
  Data data;
  Geom often, once;
};

}  // namespace otg::test
