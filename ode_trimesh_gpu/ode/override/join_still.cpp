// SPDX-License-Identifier: BSD-3-Clause
#include "ode/override/join_still.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/fork_gate.h"
#include "ode/data/trimesh_cache.h"
#include "ode/geom/joined_sides.h"

namespace otg {
namespace {

constexpr int kCallsStill = 10;                 ///< so long a geom has to stay where it is
constexpr std::size_t kMostGeoms = 2048;        ///< of a space; pairs of them are looked at
constexpr std::size_t kMostTriangles = 200000;  ///< more take too long to build in the middle of a program

struct Geom {
  std::array<dReal, 15> place{};
  int calls = 0;  ///< that it was there
  bool isJoined = false;
  bool hasMoved = false;  ///< after it was joined: never again
};

struct Known {
  std::mutex mutex;
  std::unordered_map<dGeomID, Geom> geoms;
  struct Space {
    std::vector<dGeomID> ready;                    ///< what was looked at last
    std::vector<std::shared_ptr<MeshJoin>> joins;  ///< and was made of it
  };
  std::unordered_map<dSpaceID, Space> spaces;
};

/// Never destroyed: geoms may collide in the destructors of a program's own globals.
Known& known() {
  static Known* const instance = new Known;
  return *instance;
}

std::array<dReal, 15> placeOf(dGeomID geom) {
  std::array<dReal, 15> place;
  const dReal *const x = dGeomGetPosition(geom), *const r = dGeomGetRotation(geom);
  std::copy(x, x + 3, place.begin());
  std::copy(r, r + 12, place.begin() + 3);
  return place;
}

/// Whether it has lain still for long enough.
bool isReady(Geom& geom, dGeomID id) {
  const std::array<dReal, 15> now = placeOf(id);
  if (now != geom.place) {
    if (geom.isJoined) {
      geom.hasMoved = true;
      geom.isJoined = false;
      if (const auto object = objectOfTrimesh(id)) object->joined.leave();
    }
    geom.place = now;
    geom.calls = 0;
  }
  return ++geom.calls > kCallsStill && !geom.hasMoved;
}

struct Box {
  dReal at[6];
};

/// Boxes that touch like tiles do: in a face, an edge or a thin layer.
bool areTiles(const Box& x, const Box& y) {
  double least = 1e300, size = 0;
  for (int k = 0; k < 6; k += 2) {
    const auto both = static_cast<double>(std::min(x.at[k + 1], y.at[k + 1]) - std::max(x.at[k], y.at[k]));
    least = std::min(least, both);
    size = std::max({size, static_cast<double>(x.at[k + 1] - x.at[k]), static_cast<double>(y.at[k + 1] - y.at[k])});
  }
  constexpr double kLayer = 1e-3;
  return std::fabs(least) <= kLayer * size;
}

/// Those that lie beside another one.
std::vector<dGeomID> tilesOf(const std::vector<dGeomID>& geoms) {
  std::vector<Box> boxes(geoms.size());
  for (std::size_t i = 0; i < geoms.size(); ++i) dGeomGetAABB(geoms[i], boxes[i].at);
  std::vector<bool> isTile(geoms.size(), false);
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    for (std::size_t k = i + 1; k < geoms.size(); ++k) {
      if (areTiles(boxes[i], boxes[k])) isTile[i] = isTile[k] = true;
    }
  }
  std::vector<dGeomID> tiles;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (isTile[i]) tiles.push_back(geoms[i]);
  }
  return tiles;
}

void join(Known& all, const std::vector<dGeomID>& tiles, std::vector<std::shared_ptr<MeshJoin>>& joins) {
  std::size_t triangles = 0;
  for (const dGeomID tile : tiles) triangles += static_cast<std::size_t>(dGeomTriMeshGetTriangleCount(tile));
  if (tiles.size() < 2 || triangles > kMostTriangles) return;
  std::vector<MeshGeom> sides;
  std::vector<WorldPose> poses;
  for (const dGeomID tile : tiles) {
    MeshGeom side = meshSideOf(tile);
    const WorldPose pose = readPose(tile);
    if (side.mesh == nullptr || side.mesh->tree().nodes.empty() || !pose.rigid) continue;
    poses.push_back(pose);
    sides.push_back(std::move(side));
  }
  if (sides.size() < 2) return;
  joinGeoms(sides, poses);
  for (const MeshGeom& side : sides) {
    const std::shared_ptr<MeshJoin>& join = side.object->joined.join;
    all.geoms[side.geom].isJoined = join != nullptr;
    if (join != nullptr && (joins.empty() || joins.back() != join)) joins.push_back(join);
  }
}

}  // namespace

void joinStill(dSpaceID space) {
  if (dSpaceGetClass(space) == dQuadTreeSpaceClass) return;  // which has no way to list its geoms
  Known& all = known();
  const CallLock lock(all.mutex);
  std::vector<dGeomID> ready;
  const int count = dSpaceGetNumGeoms(space);
  for (int i = 0; i < count; ++i) {
    const dGeomID geom = dSpaceGetGeom(space, i);
    if (dGeomGetClass(geom) != dTriMeshClass || dGeomGetBody(geom) != nullptr) continue;
    if (isReady(all.geoms[geom], geom)) ready.push_back(geom);
  }
  if (ready.size() > kMostGeoms) ready.clear();
  std::sort(ready.begin(), ready.end());
  Known::Space& known = all.spaces[space];
  if (known.ready == ready) return;
  for (const std::shared_ptr<MeshJoin>& join : known.joins) join->isBroken = true;
  known.joins.clear();
  known.ready = ready;
  // In the order of creation, by which the surface does not depend on addresses.
  std::vector<dGeomID> tiles = tilesOf(ready);
  std::sort(tiles.begin(), tiles.end(),
            [](dGeomID x, dGeomID y) { return objectOfTrimesh(x)->serial < objectOfTrimesh(y)->serial; });
  join(all, tiles, known.joins);
}

void dropStill(dGeomID geom) noexcept {
  Known& all = known();
  const CallLock lock(all.mutex);
  all.geoms.erase(geom);
}

void dropAllStill() noexcept {
  Known& all = known();
  const CallLock lock(all.mutex);
  all.geoms.clear();
  all.spaces.clear();
}

}  // namespace otg
