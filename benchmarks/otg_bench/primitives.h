// SPDX-License-Identifier: BSD-3-Clause
// What the parts of `otg bench primitives` share.
#pragma once

#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "scenes/convex_geom.h"
#include "scenes/generated_meshes.h"
#include "truth/body_in_ode.h"
#include "truth/contact_errors.h"
#include "truth/contact_families.h"
#include "truth/tessellated_bodies.h"

namespace otg::cli {

struct PrimitivesOptions {
  bool json = false;
  int poses = 2000;
  std::uint32_t seed = 1;
};

/// A mesh as a geom of the library's, outside of any space.
class MeshGeom {
 public:
  explicit MeshGeom(const scenes::MeshArrays& mesh);
  ~MeshGeom();
  MeshGeom(const MeshGeom&) = delete;
  MeshGeom& operator=(const MeshGeom&) = delete;
  dGeomID id() const { return geom_; }

 private:
  dGpuTriMeshDataID data_;
  dGeomID geom_;
};

/// A body as a geom of ODE's own, outside of any space.
class NativeGeom {
 public:
  /// `mesh`: of a polyhedron, its faces.
  NativeGeom(const truth::ConvexBody& body, const scenes::MeshArrays& mesh);
  ~NativeGeom() { dGeomDestroy(geom_); }
  NativeGeom(const NativeGeom&) = delete;
  NativeGeom& operator=(const NativeGeom&) = delete;
  dGeomID id() const { return geom_; }

 private:
  std::unique_ptr<scenes::ConvexData> convex_;
  dGeomID geom_;
};

/// The meshes that all are compared with, and the bodies that they stand for.
std::vector<truth::TessellatedBody> comparedMeshes();

void placeGeom(dGeomID geom, const Transformd& pose);
/// Anyhow turned, within `reach` of the origin along each axis.
Transformd drawnPose(truth::Random& random, double reach);

struct DeepestContact {
  int count = 0;
  double depth = 0;
  Vec3d position{0, 0, 0}, normal{0, 0, 0};
};
DeepestContact collideDeepest(dGeomID a, dGeomID b);

/// How many poses were compared, and how many of them one of the two sides says nothing of.
struct PoseCounts {
  int poses = 0, missed = 0, missedByOde = 0;
  /// Counts a pose; returns whether both sides say something.
  bool add(bool isOurs, bool isOdes);
};
/// A row of a table: `words`, the counts, and the quantiles of errors by name.
Json makeRow(Json words, const PoseCounts& counts,
             const std::vector<std::pair<const char*, const truth::Errors*>>& errors);

/// Overlaps up to a tenth of the mesh's size: what worlds see, where nothing is deep in anything.
inline constexpr double kLeastOverlap = 0.001, kMostOverlap = 0.1;

/// Meshes and planes, beside the same body of ODE's and the formula.
Json comparePlanes(const PrimitivesOptions& options);
/// Rays on meshes, beside the same rays on the same body of ODE's.
Json compareRays(const PrimitivesOptions& options);
/// A mesh on ODE's dTriMesh and on its heightfield, beside two meshes of the same triangles.
Json compareOtherMeshes(const PrimitivesOptions& options);

}  // namespace otg::cli
