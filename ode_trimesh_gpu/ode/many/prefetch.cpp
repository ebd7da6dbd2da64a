// SPDX-License-Identifier: BSD-3-Clause
// Computing the contacts of whole spaces ahead of their near callbacks.
#include <ode/collision.h>
#include <ode/collision_space.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <climits>

#include "base/hash.h"
#include "ode/base/status.h"
#include "ode/geom/trimesh_pairs.h"
#include "ode/many/pair_batch.h"
#include "ode/many/shape_batch.h"
#include "ode/pairs/prefetched_pairs.h"
#include "ode/shapes/primitive_history.h"

namespace otg {
namespace {

/// Finds the pairs that have a mesh as programs do whose near callback follows ODE's manual: a space that meets
/// something is collided with it, and the geoms of a space among themselves.
class Gatherer {
 public:
  Gatherer(dGpuTriMeshPairFilter* filter, void* data) : filter_(filter), data_(data) {}

  void addSpace(dSpaceID space) {
    if (std::find(done_.begin(), done_.end(), space) != done_.end()) return;
    done_.push_back(space);
    dSpaceCollide(space, this, &Gatherer::meet);
    if (failed_) throw std::bad_alloc();
    // The quad tree has no way to ask for its geoms; a space in one is found when it meets something.
    if (dSpaceGetClass(space) == dQuadTreeSpaceClass) return;
    const int count = dSpaceGetNumGeoms(space);
    for (int i = 0; i < count; ++i) {
      const dGeomID geom = dSpaceGetGeom(space, i);
      if (dGeomIsSpace(geom)) addSpace(reinterpret_cast<dSpaceID>(geom));
    }
  }

  /// Pairs of two meshes, every one once, in the order in which it was found first.
  std::vector<dGpuTriMeshPair> takeMeshes() { return once(meshes_); }
  /// Pairs of a mesh, first, and a geom of ODE's.
  std::vector<dGpuTriMeshPair> takeShapes() { return once(shapes_); }

 private:
  struct Found {
    dGpuTriMeshPair pair;
    std::uint64_t x, y;  ///< equal for equal pairs
  };

  static std::vector<dGpuTriMeshPair> once(const std::vector<Found>& found) {
    // Open addressing: a number of `found` plus one, 0 for nothing; at least half of them are nothing.
    std::vector<std::uint32_t> places(std::bit_ceil(2 * found.size() + 1), 0);
    const auto isNew = [&](std::size_t i) {
      const Found& one = found[i];
      std::size_t at = spreadBits(spreadBits(one.x) ^ one.y) & (places.size() - 1);
      for (; places[at] != 0; at = (at + 1) & (places.size() - 1)) {
        const Found& other = found[places[at] - 1];
        if (other.x == one.x && other.y == one.y) return false;
      }
      places[at] = static_cast<std::uint32_t>(i + 1);
      return true;
    };
    std::vector<dGpuTriMeshPair> pairs;
    pairs.reserve(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (isNew(i)) pairs.push_back(found[i].pair);
    }
    return pairs;
  }

  static void meet(void* self, dGeomID o1, dGeomID o2) {
    auto& gatherer = *static_cast<Gatherer*>(self);
    if (dGeomIsSpace(o1) || dGeomIsSpace(o2)) {
      dSpaceCollide2(o1, o2, self, &Gatherer::meet);
      return;
    }
    const bool isMeshes = isMeshFor(o1, o2) && isMeshFor(o2, o1);
    const bool isShape = isShapePair(o1, o2), isOtherWay = !isShape && isShapePair(o2, o1);
    if (gatherer.failed_ || !(isMeshes || isShape || isOtherWay) || !isPairInOde(o1, o2)) return;
    if (gatherer.filter_ != nullptr && gatherer.filter_(gatherer.data_, o1, o2) == 0) return;
    try {
      if (isMeshes)
        gatherer.addMeshes(o1, o2);
      else
        gatherer.addShape(isShape ? o1 : o2, isShape ? o2 : o1);
    } catch (...) {  // not through ODE, which has its space locked
      gatherer.failed_ = true;
    }
  }

  /// Who has callbacks is asked when the pair is collided, and not before. A dTriMesh that is new gets its place in the
  /// order of geoms, as if it collided now. Pieces of a whole are computed when they are collided, too.
  void addMeshes(dGeomID o1, dGeomID o2) {
    const GeomObject& first = *meshObjectOf(o1);
    const GeomObject& second = *meshObjectOf(o2);
    if (first.joined.join != nullptr || second.joined.join != nullptr) return;
    if (callbacksOf(o1, first).asked() || callbacksOf(o2, second).asked()) return;
    meshes_.push_back({{o1, o2}, std::min(first.serial, second.serial), std::max(first.serial, second.serial)});
  }
  void addShape(dGeomID mesh, dGeomID other) {
    const GeomObject& object = *meshObjectOf(mesh);
    if (object.joined.join == nullptr && !callbacksOf(mesh, object).asked())
      shapes_.push_back({{mesh, other}, object.serial, memoryKey(other)});
  }

  dGpuTriMeshPairFilter* filter_;
  void* data_;
  bool failed_ = false;
  std::vector<dSpaceID> done_;
  std::vector<Found> meshes_, shapes_;
};

int prefetch(std::span<const dSpaceID> spaces, dGpuTriMeshPairFilter* filter, void* data) {
  Gatherer gatherer(filter, data);
  for (const dSpaceID space : spaces) gatherer.addSpace(space);
  const std::vector<dGpuTriMeshPair> pairs = gatherer.takeMeshes();
  PairBatch batch(pairs, {.known = true});
  batch.run();
  // Every geom forgets all that it has before any gets something new.
  batch.forParts([&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const PairTask& task = batch.task(i);
      PrefetchedPairs* const ready = task.state == PairTask::State::kReady ? task.b().prefetched.get() : nullptr;
      if (ready != nullptr) ready->clear();
    }
  });
  std::atomic<std::size_t> ready = prefetchShapes(gatherer.takeShapes());
  batch.forParts([&](std::size_t begin, std::size_t end) {
    std::size_t added = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const PairTask& task = batch.task(i);
      if (task.state != PairTask::State::kReady || batch.result(i).outcome != PairResult::Outcome::kDone) continue;
      task.b().prefetched.make().add(task, std::move(batch.result(i)));
      ++added;
    }
    ready += added;
  });
  return static_cast<int>(std::min<std::size_t>(ready, INT_MAX));
}

}  // namespace
}  // namespace otg

int dGpuTriMeshPrefetch(dSpaceID space) {
  return dGpuTriMeshPrefetchSpaces(&space, 1, nullptr, nullptr);
}

int dGpuTriMeshPrefetchSpaces(const dSpaceID* spaces, int count, dGpuTriMeshPairFilter* filter, void* data) {
  return otg::guarded([&] {
    if (count < 0 || (spaces == nullptr && count > 0)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    const std::span<const dSpaceID> all(spaces, static_cast<std::size_t>(count));
    if (std::find(all.begin(), all.end(), dSpaceID{}) != all.end()) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    return otg::prefetch(all, filter, data);
  });
}
