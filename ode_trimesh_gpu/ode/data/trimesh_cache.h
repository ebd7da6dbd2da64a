// SPDX-License-Identifier: BSD-3-Clause
// ODE's dTriMesh geoms as meshes of ours: read through ODE's public functions, kept for each dTriMeshDataID.
//
// ODE does not report when such data are built anew, updated or destroyed. What is kept is therefore compared with the
// data each time that it is requested: the number of triangles, and kSample of the triangles, corner by corner. The
// sample moves on from one question to the next. So a change of all triangles is noticed at once, and one of a single
// triangle of F after at most F / kSample questions; meshes of up to kSample triangles are compared whole. Who knows of
// a change says so: trimeshDataChanged().
#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "bvh/collision_mesh.h"

namespace otg {

/// Triangles compared with ODE's each time.
inline constexpr std::uint32_t kTrimeshSample = 32;

/// The mesh of a geom of dTriMeshClass, as it is now: in the geom's own frame, triangles numbered as ODE numbers them.
/// Vertices are single precision, which is what ODE makes of double ones itself. Null for a geom without data or
/// without triangles, and for vertices that are not finite. Any number of threads, also for the same data: they get the
/// same mesh. Throws std::bad_alloc.
std::shared_ptr<const CollisionMesh> meshOfTrimesh(dGeomID trimesh);

/// The data were built anew or updated: they are read again when they are requested next.
void trimeshDataChanged(dTriMeshDataID data) noexcept;
/// The data are about to be destroyed: nothing is kept of them.
void forgetTrimeshData(dTriMeshDataID data) noexcept;
/// Nothing is kept of any data.
void clearTrimeshCache() noexcept;

/// Whether the calling thread is reading data just now: who looks at the geoms that ODE makes has to look away from the
/// reader's.
bool isReadingTrimesh() noexcept;

/// What became of the questions so far.
struct TrimeshCacheStats {
  std::uint64_t builds = 0;  ///< meshes made from nothing
  std::uint64_t refits = 0;  ///< meshes whose vertices had moved
  std::size_t kept = 0;      ///< data that something is kept of
};
TrimeshCacheStats trimeshCacheStats();

}  // namespace otg
