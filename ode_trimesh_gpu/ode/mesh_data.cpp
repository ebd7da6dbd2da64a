// SPDX-License-Identifier: BSD-3-Clause
// Building, refitting and the life of mesh data.
#include "ode/mesh_data.h"

#include <utility>

#include "ode_trimesh_gpu/library.h"

int dxGpuTriMeshData::accept(otg::MeshResult&& result, std::shared_ptr<const otg::CollisionMesh> mesh) {
  report_ = std::move(result.report);
  if (mesh == nullptr) return dGPUTRIMESH_ERROR_MESH;
  mesh_ = std::move(mesh);
  useFlags.clear();
  ownFlags.clear();
  faceNormals.clear();
  const std::lock_guard lock(mutex_);
  for (const auto& [serial, geom] : users_) dGeomMoved(geom);
  return dGPUTRIMESH_OK;
}

int dxGpuTriMeshData::build(const otg::MeshInput& input, const otg::RepairOptions& repair,
                            otg::BuildStrategy strategy) {
  otg::MeshResult result = otg::buildTriMesh(input, repair, otg::MeshOrder::kSpatial);
  std::shared_ptr<const otg::CollisionMesh> mesh;
  if (result.mesh != nullptr) mesh = std::make_shared<const otg::CollisionMesh>(result.mesh, strategy);
  return accept(std::move(result), std::move(mesh));
}

int dxGpuTriMeshData::moveVertices(const otg::MeshInput& vertices) {
  if (mesh_ == nullptr) return dGPUTRIMESH_ERROR_ARGUMENT;
  otg::MeshResult result = otg::moveVertices(mesh_->mesh(), vertices);
  std::shared_ptr<const otg::CollisionMesh> mesh;
  if (result.mesh != nullptr) mesh = std::make_shared<const otg::CollisionMesh>(result.mesh, *mesh_);
  return accept(std::move(result), std::move(mesh));
}

void dxGpuTriMeshData::releaseHandle() noexcept {
  bool unused = false;
  {
    const std::lock_guard lock(mutex_);
    handle_ = false;
    unused = users_.empty();
  }
  if (unused) delete this;
}

bool dxGpuTriMeshData::hasHandle() const {
  const std::lock_guard lock(mutex_);
  return handle_;
}

void dxGpuTriMeshData::attach(std::uint64_t serial, dGeomID geom) {
  const std::lock_guard lock(mutex_);
  users_.emplace(serial, geom);
}

void dxGpuTriMeshData::detach(std::uint64_t serial) noexcept {
  bool unused = false;
  {
    const std::lock_guard lock(mutex_);
    users_.erase(serial);
    unused = users_.empty() && !handle_;
  }
  if (unused) delete this;
}
