// SPDX-License-Identifier: BSD-3-Clause
// Meshes of benchmarks as geoms in ODE.
#pragma once

#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "collide/query.h"
#include "scenes/generated_meshes.h"

namespace otg::cli {

/// Mesh data for geoms; the caller destroys them. Throws InputError where the library refuses the mesh.
dGpuTriMeshDataID meshData(const TriMesh& mesh, const std::string& name);

void poseGeom(dGeomID geom, const Transformd& pose);

/// By bisection the last place that touches, to `tolerance`: at `low` it does, at `high` it does not.
double lastTouch(double low, double high, double tolerance, const std::function<bool(double)>& touchesAt);

/// A mesh as a geom of ours and as a dTriMesh, in no space.
class MeshTwins {
 public:
  explicit MeshTwins(const scenes::MeshArrays& arrays);
  ~MeshTwins();
  MeshTwins(const MeshTwins&) = delete;
  MeshTwins& operator=(const MeshTwins&) = delete;
  int triangles() const { return static_cast<int>(arrays_.triangles.size()); }
  dGeomID ours, stock;

 private:
  scenes::MeshArrays arrays_;
  dGpuTriMeshDataID data_;
  dTriMeshDataID stockData_;
};

/// Queries as pairs of geoms, two for each, of meshes that they share.
class GeomPairs {
 public:
  /// Contact model and number of contacts are the queries' own. Throws InputError where the library refuses a mesh.
  explicit GeomPairs(const std::vector<Query>& queries);
  ~GeomPairs();
  GeomPairs(const GeomPairs&) = delete;
  GeomPairs& operator=(const GeomPairs&) = delete;

  void setBackend(int backend) const;
  /// dGPUTRIMESH_HISTORY_...: with it the CPU keeps the results of pairs that stay where they are.
  void setHistory(int history) const;
  const std::vector<dGpuTriMeshPair>& all() const { return pairs_; }
  int count() const { return static_cast<int>(pairs_.size()); }

 private:
  std::map<const CollisionMesh*, dGpuTriMeshDataID> data_;
  std::vector<dGpuTriMeshPair> pairs_;
};

/// What all devices have counted so far, e.g. of `calls`.
std::uint64_t deviceSum(duint64 dGpuTriMeshDevice::*member);

}  // namespace otg::cli
