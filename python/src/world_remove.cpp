// SPDX-License-Identifier: BSD-3-Clause
// Taking bodies and joints out of a world. The numbers of those behind them go down.
#include <algorithm>

#include "errors.h"
#include "world.h"

namespace otg::python {
namespace {

/// The number of what was `number` once `count` things from `first` on are gone.
int without(int number, int first, int count) {
  return number < first ? number : number - count;
}

}  // namespace

void World::forgetPairsWith(int firstGeom, int count) {
  std::vector<dGeomID> rest = geomIds();
  rest.erase(rest.begin() + firstGeom, rest.begin() + firstGeom + count);
  // Meshes remember ODE's own geoms by their addresses, which a later geom may get.
  const int size = static_cast<int>(rest.size());
  std::string bytes(dGpuTriMeshHistorySave(rest.data(), size, nullptr, 0), '\0');
  if (bytes.empty()) failWithLastError();
  dGpuTriMeshHistorySave(rest.data(), size, bytes.data(), bytes.size());
  check(dGpuTriMeshHistoryLoad(rest.data(), size, bytes.data(), bytes.size()), "the memory of pairs");
}

std::vector<int> World::removeBody(int index) {
  const OneAtATime alone(busy_);
  prepareThread();
  const Body gone = body(index);
  const int firstGeom = gone.geoms.front(), count = static_cast<int>(gone.geoms.size());
  forgetPairsWith(firstGeom, count);

  std::vector<int> goneJoints;
  for (std::size_t i = joints_.size(); i-- > 0;) {
    Joint& joint = *joints_[i];
    if (joint.body1 == index || joint.body2 == index) {
      goneJoints.push_back(static_cast<int>(i));
      eraseJoint(i);
    } else {
      joint.body1 = without(joint.body1, index, 1);
      joint.body2 = without(joint.body2, index, 1);
    }
  }
  std::erase_if(contacts_, [&](const WorldContact& c) { return c.body1 == index || c.body2 == index; });
  for (WorldContact& c : contacts_) {
    c.body1 = without(c.body1, index, 1);
    c.body2 = without(c.body2, index, 1);
    c.geom1 = without(c.geom1, firstGeom, count);
    c.geom2 = without(c.geom2, firstGeom, count);
  }
  for (const int number : gone.geoms) dGeomDestroy(geoms_[static_cast<std::size_t>(number)].geom);
  geoms_.erase(geoms_.begin() + firstGeom, geoms_.begin() + firstGeom + count);
  if (gone.body != nullptr) dBodyDestroy(gone.body);
  bodies_.erase(bodies_.begin() + index);
  for (Body& body : bodies_) {
    for (int& number : body.geoms) number = without(number, firstGeom, count);
  }
  for (std::size_t i = 0; i < geoms_.size(); ++i) {
    geoms_[i].body = without(geoms_[i].body, index, 1);
    dGeomSetData(geoms_[i].geom, reinterpret_cast<void*>(i));
  }
  return goneJoints;
}

void World::removeJoint(int index) {
  const OneAtATime alone(busy_);
  joint(index);
  eraseJoint(static_cast<std::size_t>(index));
}

void World::eraseJoint(std::size_t index) {
  dJointDestroy(joints_[index]->joint);
  joints_.erase(joints_.begin() + static_cast<std::ptrdiff_t>(index));
}

}  // namespace otg::python
