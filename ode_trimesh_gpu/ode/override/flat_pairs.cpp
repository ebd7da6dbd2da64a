// SPDX-License-Identifier: BSD-3-Clause
#include "ode/override/flat_pairs.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/fork_gate.h"
#include "ode/data/trimesh_cache.h"
#include "ode/geom/mesh_side.h"
#include "ode/pairs/left_pairs.h"

namespace otg {
namespace {

struct Known {
  std::mutex mutex;
  std::unordered_map<dTriMeshDataID, bool> isFlat;
  std::atomic<bool> anyTrimesh{false};
};

/// Never destroyed: geoms may collide in the destructors of a program's own globals.
Known& known() {
  static Known* const instance = new Known;
  return *instance;
}

/// A flat dTriMesh, or a space that has some.
struct Flat {
  dGeomID geom;
  dReal box[6];
  double margin;
};

void addFlat(dGeomID geom, std::vector<Flat>& flats) {
  if (dGeomGetClass(geom) != dTriMeshClass || dGeomIsEnabled(geom) == 0) return;
  const dTriMeshDataID data = dGeomTriMeshGetData(geom);
  if (data == nullptr) return;
  Known& all = known();
  const CallLock lock(all.mutex);
  const auto [it, isNew] = all.isFlat.try_emplace(data, false);
  if (!isNew && !it->second) return;
  const std::shared_ptr<const CollisionMesh> mesh = meshOfTrimesh(geom);
  if (isNew) it->second = mesh != nullptr && isFlat(*mesh);
  if (!it->second || mesh == nullptr) return;
  Flat& flat = flats.emplace_back();
  flat.geom = geom;
  dGeomGetAABB(geom, flat.box);
  flat.margin = shellMargin(*objectOfTrimesh(geom), mesh->mesh());
}

std::vector<Flat> flatsIn(dSpaceID space) {
  std::vector<Flat> flats;
  if (!known().anyTrimesh || dSpaceGetClass(space) == dQuadTreeSpaceClass) return flats;  // that one names no geoms
  const int count = dSpaceGetNumGeoms(space);
  for (int i = 0; i < count; ++i) {
    const dGeomID geom = dSpaceGetGeom(space, i);
    if (dGeomIsSpace(geom) == 0) {
      addFlat(geom, flats);
      continue;
    }
    double margin = 0;
    for (const Flat& inner : flatsIn(reinterpret_cast<dSpaceID>(geom))) margin = std::max(margin, inner.margin);
    if (!(margin > 0)) continue;
    Flat& flat = flats.emplace_back();
    flat.geom = geom;
    dGeomGetAABB(geom, flat.box);
    flat.margin = margin;
  }
  return flats;
}

/// Those in a space, or the geom itself if it is one.
std::vector<Flat> flatsOf(dGeomID where) {
  if (dGeomIsSpace(where) != 0) return flatsIn(reinterpret_cast<dSpaceID>(where));
  std::vector<Flat> flats;
  if (known().anyTrimesh) addFlat(where, flats);
  return flats;
}

/// Whether ODE would report the two if their boxes were larger, and has not.
bool areNear(const Flat& x, const Flat& y) {
  if (x.geom == y.geom) return false;
  const bool anySpace = dGeomIsSpace(x.geom) != 0 || dGeomIsSpace(y.geom) != 0;
  if (!anySpace && dGeomGetBody(x.geom) == dGeomGetBody(y.geom)) return false;
  const unsigned long category1 = dGeomGetCategoryBits(x.geom), category2 = dGeomGetCategoryBits(y.geom);
  if ((category1 & dGeomGetCollideBits(y.geom)) == 0 && (category2 & dGeomGetCollideBits(x.geom)) == 0) return false;
  bool meet = true;
  const double margin = x.margin + y.margin;
  for (int k = 0; k < 6; k += 2) {
    const double gap = static_cast<double>(std::max(x.box[k] - y.box[k + 1], y.box[k] - x.box[k + 1]));
    if (gap > margin) return false;
    meet = meet && gap <= 0;
  }
  return !meet;
}

}  // namespace

void noteTrimesh() noexcept {
  known().anyTrimesh = true;
}

bool isAnyTrimesh() noexcept {
  return known().anyTrimesh;
}

void forgetFlatness() noexcept {
  Known& all = known();
  const CallLock lock(all.mutex);
  all.isFlat.clear();
}

void askAboutFlats(dSpaceID space, void* data, dNearCallback* callback) {
  const std::vector<Flat> flats = flatsIn(space);
  for (std::size_t i = 0; i < flats.size(); ++i) {
    for (std::size_t k = i + 1; k < flats.size(); ++k) {
      if (areNear(flats[i], flats[k])) callback(data, flats[i].geom, flats[k].geom);
    }
  }
}

void askAboutFlats(dGeomID o1, dGeomID o2, void* data, dNearCallback* callback) {
  if (o1 == o2) {
    if (dGeomIsSpace(o1) != 0) askAboutFlats(reinterpret_cast<dSpaceID>(o1), data, callback);
    return;
  }
  const std::vector<Flat> flats1 = flatsOf(o1);
  if (flats1.empty()) return;
  for (const Flat& y : flatsOf(o2)) {
    for (const Flat& x : flats1) {
      if (areNear(x, y)) callback(data, x.geom, y.geom);
    }
  }
}

}  // namespace otg
