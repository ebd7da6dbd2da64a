// SPDX-License-Identifier: BSD-3-Clause
// Whole spaces: their contacts ahead of their near callbacks, and all of them in one array.
#include <ode/collision.h>

#include <algorithm>
#include <atomic>

#include "dispatch/dispatcher.h"
#include "ode/base/status.h"
#include "ode/geom/trimesh_pairs.h"
#include "ode/many/pair_batch.h"
#include "ode/many/shape_batch.h"
#include "ode/many/space_pairs.h"
#include "ode/pairs/prefetched_pairs.h"

namespace otg {
namespace {

/// What is worth computing ahead. Callbacks are called when the pair is collided, and not before; pieces of a
/// whole are computed then, too.
struct AheadPairs {
  std::vector<dGpuTriMeshPair> meshes;
  std::vector<dGpuTriMeshPair> shapes;  ///< the mesh first
};

bool isAhead(dGeomID geom, const GeomObject& object) {
  return object.joined.join == nullptr && !callbacksOf(geom, object).asked();
}

/// A dTriMesh that is new gets its place in the order of geoms, as if it collided now.
AheadPairs aheadOf(std::span<const SpacePair> pairs) {
  AheadPairs ahead;
  for (const auto& [pair, kind] : pairs) {
    if (kind == PairKind::kMeshes) {
      const GeomObject &first = *meshObjectOf(pair.o1), &second = *meshObjectOf(pair.o2);
      if (isAhead(pair.o1, first) && isAhead(pair.o2, second)) ahead.meshes.push_back(pair);
    } else if (kind == PairKind::kShape) {
      const bool isMeshFirst = isShapePair(pair.o1, pair.o2);
      const dGpuTriMeshPair sorted = isMeshFirst ? pair : dGpuTriMeshPair{pair.o2, pair.o1};
      if (isAhead(sorted.o1, *meshObjectOf(sorted.o1))) ahead.shapes.push_back(sorted);
    }
  }
  return ahead;
}

std::size_t prefetch(std::span<const SpacePair> pairs) {
  const AheadPairs ahead = aheadOf(pairs);
  PairBatch batch(ahead.meshes, {.known = true});
  batch.run();
  // Every geom forgets all that it has before any gets something new.
  batch.forParts([&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const PairTask& task = batch.task(i);
      PrefetchedPairs* const ready = task.state == PairTask::State::kReady ? task.younger().prefetched.get() : nullptr;
      if (ready != nullptr) ready->clear();
    }
  });
  std::atomic<std::size_t> ready = prefetchShapes(ahead.shapes);
  batch.forParts([&](std::size_t begin, std::size_t end) {
    std::size_t added = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const PairTask& task = batch.task(i);
      if (task.state != PairTask::State::kReady || batch.result(i).outcome != PairResult::Outcome::kDone) continue;
      task.younger().prefetched.make().add(task, std::move(batch.result(i)));
      ++added;
    }
    ready += added;
  });
  return ready;
}

/// What is requested of a whole space, and where its contacts go.
struct SpaceContacts {
  int flags = 0;  ///< of each dCollide()
  dContactGeom* contact = nullptr;
  int skip = 0;      ///< bytes from one place to the next
  int capacity = 0;  ///< places
};

/// Whether threads or devices may gain anything. Pairs of few triangles are done before another thread is awake.
bool isWorthSharing(std::span<const SpacePair> pairs) {
  constexpr std::size_t kFewTriangles = 4096;  // 170 pairs of boxes, some 0.2 ms
  if (dispatcher().threadCount() == 1 && !dispatcher().hasDevices()) return false;
  std::size_t triangles = 0;
  return std::any_of(pairs.begin(), pairs.end(), [&](const SpacePair& found) {
    if (found.kind == PairKind::kOther) return false;
    for (const dGeomID geom : {found.pair.o1, found.pair.o2}) {
      GeomObject* const object = meshObjectOf(geom);
      const GeomUse use(object);
      const CollisionMesh* const mesh = object != nullptr && use.good() ? object->mesh() : nullptr;
      if (mesh != nullptr) triangles += mesh->mesh().triangleCount();
    }
    return triangles > kFewTriangles;
  });
}

/// Of pairs that were shared before, something else may still be ready.
void forgetAhead(std::span<const SpacePair> pairs) {
  for (const SpacePair& found : pairs) {
    if (found.kind != PairKind::kMeshes) continue;
    for (const dGeomID geom : {found.pair.o1, found.pair.o2}) {
      if (PrefetchedPairs* const ready = meshObjectOf(geom)->prefetched.get(); ready != nullptr) ready->clear();
    }
  }
}

/// The contacts of all pairs, one pair after the other, until there is no place.
int collideInto(std::span<const SpacePair> pairs, const SpaceContacts& to) {
  int count = 0;
  for (const SpacePair& found : pairs) {
    if (count == to.capacity) break;
    const int places = std::min(capacityOf(to.flags), to.capacity - count);
    char* const place =
        reinterpret_cast<char*>(to.contact) + static_cast<std::size_t>(count) * static_cast<std::size_t>(to.skip);
    count += dCollide(found.pair.o1, found.pair.o2, to.flags - capacityOf(to.flags) + places,
                      reinterpret_cast<dContactGeom*>(place), to.skip);
  }
  return count;
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
    return otg::toInt(otg::prefetch(otg::findPairs(all, otg::PairChoice::kWithMesh, filter, data)));
  });
}

int dGpuTriMeshCollideSpace(dSpaceID space, int flags, dGpuTriMeshPairFilter* filter, void* data, dContactGeom* contact,
                            int skip, int capacity) {
  return otg::guarded([&] {
    const bool hasPlace = capacity == 0 || (contact != nullptr && skip >= int{sizeof(dContactGeom)});
    if (space == nullptr || otg::capacityOf(flags) == 0 || capacity < 0 || !hasPlace) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const std::vector<otg::SpacePair> pairs = otg::findPairs({&space, 1}, otg::PairChoice::kAll, filter, data);
    if (otg::isWorthSharing(pairs)) {
      otg::prefetch(pairs);
    } else {
      otg::forgetAhead(pairs);
    }
    return otg::collideInto(pairs, {flags, contact, skip, capacity});
  });
}
