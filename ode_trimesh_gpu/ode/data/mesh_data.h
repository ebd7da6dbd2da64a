// SPDX-License-Identifier: BSD-3-Clause
// What a dGpuTriMeshDataID points to: the mesh, what was found out about it, and the geoms that use it.
#pragma once

#include <ode/common.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bvh/collision_mesh.h"
#include "mesh/tri_mesh.h"
#include "ode/base/use_count.h"
#include "ode_trimesh_gpu/trimesh_data.h"

namespace otg {
/// Factors along x, y and z of a mesh's frame.
using MeshScale = std::array<float, 3>;
inline bool isOne(const MeshScale& scale) {
  return scale == MeshScale{1, 1, 1};
}

/// What a geom has of its data: a scale of their vertices, and the mesh that it makes of them, which is null while the
/// scale is 1, 1, 1.
struct ScaledMesh {
  MeshScale scale{1, 1, 1};
  std::shared_ptr<CollisionMesh> scaled;
};
}  // namespace otg

/// Lives as long as the user's handle or any geom that uses it. The mesh is shared as one that does not
/// change; building again puts another one in its place, and vertices move in place only while no one shares it. No
/// function runs while another thread changes the object (the rule of the API). But geoms may come and go in several
/// threads at once: the mutex is for these.
struct dxGpuTriMeshData {
 public:
  /// A new object, which isLive() knows. May throw std::bad_alloc.
  static dxGpuTriMeshData* create();
  dxGpuTriMeshData(const dxGpuTriMeshData&) = delete;
  dxGpuTriMeshData& operator=(const dxGpuTriMeshData&) = delete;

  /// Null until a build has succeeded.
  const otg::CollisionMesh* mesh() const { return mesh_.get(); }
  std::shared_ptr<const otg::CollisionMesh> meshPtr() const { return mesh_; }
  /// Of the last build or update, successful or not.
  const otg::ValidationReport& report() const { return report_; }

  /// Builds and takes over. Returns a status.
  int build(const otg::MeshInput& input, const otg::RepairOptions& repair, otg::BuildStrategy strategy);
  /// Refits to moved vertices and takes over. Returns a status.
  int moveVertices(const otg::MeshInput& vertices);

  /// Moves some vertices, in place where that can be done: number `first` and those that follow it, or where `numbers`
  /// are given, as many of them as there are vertices, these. Returns a status.
  int moveSome(const otg::MeshInput& vertices, std::size_t first, const int* numbers);

  /// Takes over a mesh that was made elsewhere; with none, `error` says why. Returns a status.
  int take(std::shared_ptr<otg::CollisionMesh> mesh, std::string error);

  /// The mesh with scaled vertices, made once for all geoms that have it; mirrored ones face outward all the same. Null
  /// if a vertex leaves single precision. There must be a mesh. May throw std::bad_alloc.
  std::shared_ptr<otg::CollisionMesh> scaledMesh(const otg::MeshScale& scale);

  /// Whether this is a handle that was created and is not given up yet. Any pointer may be passed: it is not read.
  static bool isLive(const dxGpuTriMeshData* data) noexcept;

  /// Of queries that read the mesh, and of who changes it.
  otg::UseCount uses;

  /// The user's handle is given up.
  void releaseHandle() noexcept;
  /// False once the handle was given up.
  bool hasHandle() const;
  /// A geom, known by its serial number, begins to use the object, which informs ODE and `scaled` when the mesh changes
  /// until detach() or forgetGeom(). May throw std::bad_alloc.
  void attach(std::uint64_t serial, dGeomID geom, otg::ScaledMesh* scaled);
  /// It stops using it; deletes the object if that was the last use.
  void detach(std::uint64_t serial) noexcept;
  /// The geom is destroyed while a query has it: it counts until detach(), but is not looked at any more.
  void forgetGeom(std::uint64_t serial) noexcept;

  /// Additional data as the C API has them, by callers' triangles; of the present mesh alone.
  std::vector<std::uint8_t> useFlags;  ///< set by the program; empty: it did not
  std::vector<std::uint8_t> ownFlags;  ///< worked out; empty: not yet
  std::vector<dReal> faceNormals;      ///< empty: not requested yet

 private:
  dxGpuTriMeshData() = default;
  ~dxGpuTriMeshData() = default;  ///< through releaseHandle() and detach() only
  int moveAll(const otg::MeshInput& vertices);
  /// Takes over a result; a refused one leaves the mesh as it is. Returns a status.
  int accept(otg::MeshResult&& result, std::shared_ptr<otg::CollisionMesh> mesh);
  struct ScaledMeshes {
    std::map<otg::MeshScale, std::shared_ptr<otg::CollisionMesh>> meshes;  ///< null where the scale cannot be borne
    std::map<otg::MeshScale, std::weak_ptr<otg::CollisionMesh>> known;
    void add(const otg::MeshScale& scale, const std::shared_ptr<otg::CollisionMesh>& mesh) {
      meshes.emplace(scale, mesh);
      known.emplace(scale, mesh);
    }
  };
  struct ScaleInUse {
    std::shared_ptr<otg::CollisionMesh> mesh;  ///< null where the scale cannot be borne
    long geoms = 0;                            ///< how many have it
  };
  using ScalesInUse = std::map<otg::MeshScale, ScaleInUse>;
  /// Of the geoms, other than 1, 1, 1.
  ScalesInUse scalesInUse() const;
  /// For all of them. May throw std::bad_alloc.
  ScaledMeshes scaledFrom(const otg::CollisionMesh& mesh) const;
  /// The last step of a change, to which all others lead without changing anything: takes over the mesh's report, drops
  /// what was derived from the mesh as it was, and gives geoms the meshes of their scales. A geom whose scale the
  /// vertices do not bear is left without a mesh: nothing to collide with is better than the wrong thing.
  void commit(otg::ValidationReport&& report, ScaledMeshes&& scaled);
  /// A vertex, by the caller's number, and where it goes.
  struct PlacedVertex {
    std::uint32_t vertex;
    otg::Vec3f to;
  };
  /// Moves vertices of the mesh in place, and those of the scaled meshes, which are made anew where that cannot be
  /// done. False, and nothing has changed, where the mesh itself does not move in place. Throws std::bad_alloc, and
  /// nothing has changed.
  bool moveInPlace(const std::vector<PlacedVertex>& placed);

  std::shared_ptr<otg::CollisionMesh> mesh_;
  otg::ValidationReport report_;
  std::mutex scaledMutex_;
  std::map<otg::MeshScale, std::weak_ptr<otg::CollisionMesh>> scaled_;  ///< of the present mesh
  mutable std::mutex mutex_;
  bool handle_ = true;
  /// In the order of creation, so that marking them as moved shuffles ODE's lists the same way in every run.
  struct User {
    dGeomID geom;  ///< null once it is forgotten
    otg::ScaledMesh* scaled;
  };
  std::map<std::uint64_t, User> users_;
};
