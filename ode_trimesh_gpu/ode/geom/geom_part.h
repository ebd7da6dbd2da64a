// SPDX-License-Identifier: BSD-3-Clause
// Geoms of many pairs, read by one thread side by side.
#pragma once

#include <ode/common.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ode/geom/geom_class.h"
#include "ode_trimesh_gpu/batch.h"

namespace otg {

/// What GeomUse and shares of objects and meshes are for one query, for a part of an array: what many geoms have in
/// common is held and shared once for all of them. A counter that is changed for each keeps threads waiting for each
/// other. Geoms lie far apart in memory; it is prefetched before it is needed. One thread.
class GeomPart {
 public:
  static constexpr std::size_t kMost = 64;
  /// At most kMost pairs, which have to stay where they are. `known`: their geoms are alive, and need not be looked up.
  GeomPart(std::span<const dGpuTriMeshPair> pairs, bool known);
  ~GeomPart() { letGo(); }
  GeomPart(const GeomPart&) = delete;
  GeomPart& operator=(const GeomPart&) = delete;

  /// Of a geom of ours of pair `i`; null for others, as liveObjectOf().
  GeomObject* object1(std::size_t i) const { return objects_[2 * i]; }
  GeomObject* object2(std::size_t i) const { return objects_[2 * i + 1]; }

  /// Holds both objects of pair `i`, as GeomUse does, and until letGo(); their data no longer than until another pair
  /// is held. False while one of them is changed. Once for each pair.
  bool hold(std::size_t i);

  /// Adds a share of the mesh of an object that is held to `shares`, if this part has not added one lately. May throw
  /// std::bad_alloc.
  void share(const GeomObject& object, const CollisionMesh* mesh,
             std::vector<std::shared_ptr<const CollisionMesh>>& shares);

  /// Prefetches the poses of pair `i`, which is going to be read soon, if there is one.
  void fetchPoses(std::size_t i) const noexcept;

  /// Holds nothing any more.
  void letGo() noexcept;

 private:
  bool holdOne(std::size_t k);
  bool holdData(dxGpuTriMeshData* data, std::size_t side) noexcept;

  std::span<const dGpuTriMeshPair> pairs_;
  GeomObject* objects_[2 * kMost];
  std::shared_ptr<GeomObject> held_[2 * kMost];
  /// By a hash of the address: what is held last stays, and what was there before is let go. Of first and second geoms,
  /// so that the two of a pair don't exclude each other.
  static constexpr std::size_t kData = 16, kMeshes = 32;
  dxGpuTriMeshData* data_[2][kData] = {};
  const CollisionMesh* shared_[kMeshes] = {};
};

}  // namespace otg
