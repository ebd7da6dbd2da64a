// SPDX-License-Identifier: BSD-3-Clause
// Placed meshes outside of any world: what single queries and batches are asked about.
#pragma once

#include <ode/ode.h>

#include <atomic>
#include <memory>
#include <vector>

#include "mesh.h"

namespace otg::python {

/// A geom for each mesh, created in their order: of a pair, the one created first gives the frame of the computation.
class Geoms {
 public:
  Geoms(const std::vector<std::shared_ptr<Mesh>>& meshes, const dGpuTriMeshParams& params);
  ~Geoms();
  Geoms(const Geoms&) = delete;
  Geoms& operator=(const Geoms&) = delete;

  /// World from mesh, one matrix for each geom. Throws PoseError for one that is not rigid.
  void place(const Poses& poses);
  int size() const { return static_cast<int>(geoms_.size()); }
  dGeomID at(int index) const;
  std::vector<dGpuTriMeshPair> pairsOf(const Pairs& pairs) const;
  const std::vector<dGeomID>& all() const { return geoms_; }
  std::atomic<bool>& busy() const { return busy_; }

 private:
  std::vector<std::shared_ptr<Mesh>> meshes_;
  std::vector<dGeomID> geoms_;
  mutable std::atomic<bool> busy_ = false;
};

/// Sets position and rotation; throws where the matrix is no pose.
void placeGeom(dGeomID geom, const double* matrix);
/// Throws StatusError (pose) unless the row-major 4x4 matrix is a finite rigid motion to within the library's
/// tolerance.
void checkPose(const double* matrix);

void bindGeoms(nb::module_& module);

}  // namespace otg::python
