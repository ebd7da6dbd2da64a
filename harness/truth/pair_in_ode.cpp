// SPDX-License-Identifier: BSD-3-Clause
#include "truth/pair_in_ode.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "truth/body_in_ode.h"

namespace otg::truth {

std::vector<JudgedContact> contactsInOde(const PairBody& a, const PairBody& b, const GeomChoices& choices) {
  std::unique_ptr<BodyInOde> first, second;
  if (choices.secondFirst) second = std::make_unique<BodyInOde>(b, choices);
  first = std::make_unique<BodyInOde>(a, choices);
  if (!second) second = std::make_unique<BodyInOde>(b, choices);
  dGeomID o1 = first->geom(), o2 = second->geom();
  if (choices.reversedCall) std::swap(o1, o2);
  std::vector<dContactGeom> found(static_cast<std::size_t>(choices.places));
  std::vector<dGpuTriMeshContactData> data(found.size());
  const bool meshes = first->isMesh() && second->isMesh();
  const int count = meshes ? dGpuTriMeshCollideEx(o1, o2, choices.places, found.data(), sizeof(dContactGeom),
                                                  data.data(), sizeof(dGpuTriMeshContactData))
                           : dCollide(o1, o2, choices.places, found.data(), sizeof(dContactGeom));
  if (count < 0) throw std::runtime_error("the library refuses a pair");
  std::vector<JudgedContact> contacts;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const dContactGeom& c = found[i];
    const double sign = choices.reversedCall ? -1 : 1;
    const bool exempt = meshes && (data[i].flags & (dGPUTRIMESH_CONTACT_CONTAINED | dGPUTRIMESH_CONTACT_CLAMPED)) != 0;
    contacts.push_back({{c.pos[0], c.pos[1], c.pos[2]},
                        {sign * c.normal[0], sign * c.normal[1], sign * c.normal[2]},
                        c.depth,
                        exempt});
  }
  return contacts;
}

}  // namespace otg::truth
