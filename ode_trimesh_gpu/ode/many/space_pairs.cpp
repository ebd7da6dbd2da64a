// SPDX-License-Identifier: BSD-3-Clause
#include "ode/many/space_pairs.h"

#include <ode/collision.h>
#include <ode/collision_space.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <new>

#include "base/hash.h"
#include "ode/geom/trimesh_pairs.h"
#include "ode/many/pair_batch.h"
#include "ode/many/shape_batch.h"

namespace otg {
namespace {

PairKind kindOf(dGeomID o1, dGeomID o2) {
  if (isMeshFor(o1, o2) && isMeshFor(o2, o1)) return PairKind::kMeshes;
  return isShapePair(o1, o2) || isShapePair(o2, o1) ? PairKind::kShape : PairKind::kOther;
}

class Finder {
 public:
  Finder(PairChoice choice, dGpuTriMeshPairFilter* filter, void* data)
      : choice_(choice), filter_(filter), data_(data) {}

  void addSpace(dSpaceID space) {
    if (std::find(done_.begin(), done_.end(), space) != done_.end()) return;
    done_.push_back(space);
    dSpaceCollide(space, this, &Finder::meet);
    if (failed_) throw std::bad_alloc();
    // The quad tree has no way to list its geoms; a space in one is found when it meets something.
    if (dSpaceGetClass(space) == dQuadTreeSpaceClass) return;
    const int count = dSpaceGetNumGeoms(space);
    for (int i = 0; i < count; ++i) {
      const dGeomID geom = dSpaceGetGeom(space, i);
      if (dGeomIsSpace(geom)) addSpace(reinterpret_cast<dSpaceID>(geom));
    }
  }

  std::vector<SpacePair> takeOnce() {
    // Open addressing: a number of `found_` plus one, 0 for nothing; at least half of them are nothing.
    std::vector<std::uint32_t> places(std::bit_ceil(2 * found_.size() + 1), 0);
    const auto keysOf = [this](std::size_t i) {
      const dGpuTriMeshPair& pair = found_[i].pair;
      const auto x = reinterpret_cast<std::uintptr_t>(pair.o1), y = reinterpret_cast<std::uintptr_t>(pair.o2);
      return std::pair<std::uint64_t, std::uint64_t>(std::minmax(x, y));
    };
    const auto isNew = [&](std::size_t i) {
      const auto keys = keysOf(i);
      std::size_t at = spreadBits(spreadBits(keys.first) ^ keys.second) & (places.size() - 1);
      for (; places[at] != 0; at = (at + 1) & (places.size() - 1)) {
        if (keysOf(places[at] - 1) == keys) return false;
      }
      places[at] = static_cast<std::uint32_t>(i + 1);
      return true;
    };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      // What is kept moves to the front, and its place in the table with it.
      found_[kept] = found_[i];
      if (isNew(kept)) ++kept;
    }
    found_.resize(kept);
    return std::move(found_);
  }

 private:
  static void meet(void* self, dGeomID o1, dGeomID o2) {
    auto& finder = *static_cast<Finder*>(self);
    if (dGeomIsSpace(o1) || dGeomIsSpace(o2)) {
      dSpaceCollide2(o1, o2, self, &Finder::meet);
      return;
    }
    if (finder.failed_ || !isPairInOde(o1, o2)) return;
    const PairKind kind = kindOf(o1, o2);
    if (kind == PairKind::kOther && finder.choice_ == PairChoice::kWithMesh) return;
    if (finder.filter_ != nullptr && finder.filter_(finder.data_, o1, o2) == 0) return;
    try {
      finder.found_.push_back({{o1, o2}, kind});
    } catch (...) {  // not through ODE, which has its space locked
      finder.failed_ = true;
    }
  }

  PairChoice choice_;
  dGpuTriMeshPairFilter* filter_;
  void* data_;
  bool failed_ = false;
  std::vector<dSpaceID> done_;
  std::vector<SpacePair> found_;
};

}  // namespace

std::vector<SpacePair> findPairs(std::span<const dSpaceID> spaces, PairChoice choice, dGpuTriMeshPairFilter* filter,
                                 void* data) {
  Finder finder(choice, filter, data);
  for (const dSpaceID space : spaces) finder.addSpace(space);
  return finder.takeOnce();
}

}  // namespace otg
