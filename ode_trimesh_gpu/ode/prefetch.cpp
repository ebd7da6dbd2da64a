// SPDX-License-Identifier: BSD-3-Clause
// Computing the contacts of whole spaces ahead of their near callbacks.
#include <ode/collision.h>
#include <ode/collision_space.h>

#include <algorithm>
#include <climits>
#include <tuple>

#include "ode/pair_batch.h"
#include "ode/primitive_history.h"
#include "ode/shape_batch.h"
#include "ode/status.h"

namespace otg {
namespace {

/// Finds the pairs of geoms of our class as programs do whose near callback follows ODE's manual: a space that meets
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
  std::vector<dGpuTriMeshPair> takeMeshes() {
    return once(meshes_, [](const dGpuTriMeshPair& p) {
      const std::uint64_t x = objectOf(p.o1)->serial, y = objectOf(p.o2)->serial;
      return std::make_pair(std::min(x, y), std::max(x, y));
    });
  }
  /// Pairs of a mesh, first, and a geom of ODE's.
  std::vector<dGpuTriMeshPair> takeShapes() {
    return once(shapes_,
                [](const dGpuTriMeshPair& p) { return std::make_pair(objectOf(p.o1)->serial, memoryKey(p.o2)); });
  }

 private:
  template <class Key>
  static std::vector<dGpuTriMeshPair> once(const std::vector<dGpuTriMeshPair>& found, const Key& key) {
    std::vector<std::tuple<std::uint64_t, std::uint64_t, std::size_t>> order;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto [x, y] = key(found[i]);
      order.emplace_back(x, y, i);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto& [x, y, i] = order[k];
      if (k == 0 || std::get<0>(order[k - 1]) != x || std::get<1>(order[k - 1]) != y) kept.push_back(i);
    }
    std::sort(kept.begin(), kept.end());
    std::vector<dGpuTriMeshPair> pairs;
    for (const std::size_t i : kept) pairs.push_back(found[i]);
    return pairs;
  }

  static void meet(void* self, dGeomID o1, dGeomID o2) {
    auto& gatherer = *static_cast<Gatherer*>(self);
    if (dGeomIsSpace(o1) || dGeomIsSpace(o2)) {
      dSpaceCollide2(o1, o2, self, &Gatherer::meet);
      return;
    }
    const bool isMeshes = objectOf(o1) != nullptr && objectOf(o2) != nullptr;
    const bool isShape = isShapePair(o1, o2), isOtherWay = !isShape && isShapePair(o2, o1);
    if (gatherer.failed_ || !(isMeshes || isShape || isOtherWay) || !isPairInOde(o1, o2)) return;
    if (gatherer.filter_ != nullptr && gatherer.filter_(gatherer.data_, o1, o2) == 0) return;
    try {
      std::vector<dGpuTriMeshPair>& pairs = isMeshes ? gatherer.meshes_ : gatherer.shapes_;
      pairs.push_back(isOtherWay ? dGpuTriMeshPair{o2, o1} : dGpuTriMeshPair{o1, o2});
    } catch (...) {  // not through ODE, which has its space locked
      gatherer.failed_ = true;
    }
  }

  dGpuTriMeshPairFilter* filter_;
  void* data_;
  bool failed_ = false;
  std::vector<dSpaceID> done_;
  std::vector<dGpuTriMeshPair> meshes_, shapes_;
};

int prefetch(std::span<const dSpaceID> spaces, dGpuTriMeshPairFilter* filter, void* data) {
  Gatherer gatherer(filter, data);
  for (const dSpaceID space : spaces) gatherer.addSpace(space);
  std::vector<dGpuTriMeshPair> pairs = gatherer.takeMeshes();
  // Who has callbacks is asked when the pair is collided, and not before.
  std::erase_if(pairs, [](const dGpuTriMeshPair& p) {
    return objectOf(p.o1)->callbacks.asked() || objectOf(p.o2)->callbacks.asked();
  });
  PairBatch batch(pairs, 0, false);
  batch.run();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (const PairTask& task = batch.task(i); task.state == PairTask::State::kReady) task.b().prefetched.clear();
  }
  std::size_t ready = prefetchShapes(gatherer.takeShapes());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairTask& task = batch.task(i);
    if (task.state != PairTask::State::kReady || batch.result(i).outcome != PairResult::Outcome::kDone) continue;
    task.b().prefetched.add(task, std::move(batch.result(i)));
    ++ready;
  }
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
