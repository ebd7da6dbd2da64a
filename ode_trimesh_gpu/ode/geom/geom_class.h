// SPDX-License-Identifier: BSD-3-Clause
// What stands behind one geom of our class.
#pragma once

#include <ode/ode.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <shared_mutex>

#include "base/owned_later.h"
#include "ode/data/mesh_data.h"
#include "ode/geom/mesh_join.h"
#include "ode/geom/pair_memory.h"
#include "ode_trimesh_gpu/callbacks.h"
#include "ode_trimesh_gpu/params.h"
#include "ode_trimesh_gpu/stats.h"

namespace otg {

class PrefetchedPairs;
class PrefetchedShapes;
class KeptShapes;
class KeptPairs;

/// Sums of dGpuTriMeshStats. Several threads may collide one geom (a ground mesh) at once.
struct GeomStats {
  std::atomic<std::uint64_t> queries{0}, failedQueries{0}, boxTests{0}, candidatePairs{0}, intersectingPairs{0},
      decidedByDouble{0}, decidedExactly{0}, contactsBeforeReduction{0}, contacts{0}, prefetched{0}, onDevice{0},
      deviceFailures{0};
};

/// The program's callbacks to call; null members are not called.
struct GeomCallbacks {
  dTriCallback* triangle = nullptr;         ///< may this triangle collide?
  dTriArrayCallback* triangles = nullptr;   ///< all that are about to, at once
  dTriRayCallback* ray = nullptr;           ///< may this ray hit here?
  dTriTriMergeCallback* merge = nullptr;    ///< the number for a contact that stands for two triangles
  dGpuTriMeshPairCallback* pair = nullptr;  ///< may these two triangles collide?
  bool asked() const { return triangle != nullptr || triangles != nullptr || merge != nullptr || pair != nullptr; }
};

/// A pose of the step before, as dGeomTriMeshSetLastTransform has it.
struct LastTransform {
  bool isSet = false;
  Transformd pose{};
  dMatrix4 matrix{};  ///< as it was given
};

/// ODE keeps a pointer to it in the geom's class data (which it zeroes, copies nothing into and frees without a word).
/// Batches under way share it, so that a geom may be destroyed meanwhile.
struct GeomObject : ScaledMesh, std::enable_shared_from_this<GeomObject> {
  /// Orders geoms by creation. Of two that collide the younger one keeps what belongs to the pair: that must not depend
  /// on the order of the call nor on addresses. Which of them is mesh A is another matter (ode/pairs/pair_roles.h).
  std::uint64_t serial = 0;
  dxGpuTriMeshData* data = nullptr;  ///< attached to; may be null
  UseCount uses;                     ///< of queries that have the geom, and of who gives it other data or another scale
  GeomCallbacks callbacks;
  /// Bits of classes other than ours: with which of them pairs are remembered, if params.history says that any are.
  std::uint32_t coherentClasses = ~0u;
  dGpuTriMeshParams params{};               ///< always valid
  std::atomic<std::uint64_t> clearedAt{0};  ///< no stamp of memory up to this one counts any more
  PairMemory memory;                        ///< of pairs in which this geom is the younger one
  LastTransform last;
  JoinedPart joined;
  /// About so many bytes, from the first one on, are read of a geom of each pair.
  static constexpr std::size_t kReadBytes = 320;
  GeomStats stats;
  OwnedLater<PrefetchedPairs> prefetched;         ///< of pairs in which this geom is the younger one
  OwnedLater<KeptPairs> keptPairs;                ///< of the same
  OwnedLater<PrefetchedShapes> prefetchedShapes;  ///< of pairs with geoms of ODE's own
  OwnedLater<KeptShapes> keptShapes;              ///< of such pairs
  std::shared_ptr<GeomObject> self;               ///< the geom's own share, until it is destroyed

  GeomObject() = default;
  /// After the geom was destroyed, and after the last query that had it.
  ~GeomObject();
  GeomObject(const GeomObject&) = delete;
  GeomObject& operator=(const GeomObject&) = delete;

  /// Whether anything is remembered of pairs with geoms of a class, ours or ODE's.
  bool remembersWith(int geomClass) const;
  /// Null when there is nothing to collide with.
  const CollisionMesh* mesh() const;
  std::shared_ptr<const CollisionMesh> sharedMesh() const;
  /// Takes over a scale of data, which may be null. Returns a status: after an error nothing has changed. May throw
  /// std::bad_alloc.
  int rescale(dxGpuTriMeshData* of, const MeshScale& by);
};

/// A query's hold on one or two geoms and the data of theirs: neither changes meanwhile, and objects and data live on
/// should the geoms be destroyed. Objects may be null, and both may be one.
class GeomUse {
 public:
  explicit GeomUse(GeomObject* first, GeomObject* second = nullptr);
  ~GeomUse();
  GeomUse(const GeomUse&) = delete;
  GeomUse& operator=(const GeomUse&) = delete;
  /// False while one of them is changed: dGPUTRIMESH_ERROR_BUSY. Then nothing is held.
  bool good() const { return good_; }

 private:
  void release() noexcept;
  std::shared_ptr<GeomObject> held_[2];
  bool good_ = true;
};

/// Null for geoms of other classes, for NULL, and for geoms of our class that dCreateGeom made. For what ODE hands us,
/// which is alive.
GeomObject* objectOf(dGeomID geom) noexcept;
/// For what a program hands us: any pointer may be passed, it is not read. Null also for geoms that were destroyed
/// (as long as no other geom of ours has got the address).
GeomObject* liveObjectOf(dGeomID geom) noexcept;
/// For many of them: liveObjectOf() under one lock, which keeps them alive as long as this lives. Not for long, and no
/// geom of ours may be created or destroyed by the thread meanwhile.
class LiveObjects {
 public:
  LiveObjects();
  GeomObject* of(dGeomID geom) const noexcept;
  /// Prefetches what of() reads.
  void fetch(dGeomID geom) const noexcept;

 private:
  std::shared_lock<std::shared_mutex> lock_;
};

/// A geom's pose by value, as double: row-major rotation, position. ODE changes poses behind pointers during a call.
struct WorldPose {
  Transformd transform;
  bool finite = false;  ///< all twelve numbers are
  bool rigid = false;   ///< finite, and the matrix is a rotation within kRotationTolerance
  double defect = 0;    ///< no less than rotationDefect()
};
WorldPose readPose(dGeomID geom) noexcept;
/// Works out all but the transform.
void judgePose(WorldPose& pose) noexcept;

/// A geom that ODE has just made of our class gets its object. After an exception (std::bad_alloc) nothing has changed.
void giveObject(dGeomID geom, const std::shared_ptr<GeomObject>& object);

/// How far beyond its mesh a geom's box reaches.
double shellMargin(const GeomObject& object, const TriMesh& mesh);

/// dGeomClass::aabb: minx, maxx, miny, maxy, minz, maxz of all triangles, rounded outward; always finite.
void computeAabb(dGeomID geom, dReal aabb[6]) noexcept;

/// dGeomClass::dtor.
void destroyObject(dGeomID geom) noexcept;

}  // namespace otg
