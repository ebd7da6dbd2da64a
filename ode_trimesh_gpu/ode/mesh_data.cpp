// SPDX-License-Identifier: BSD-3-Clause
// Building, refitting and the life of mesh data.
#include "ode/mesh_data.h"

#include <utility>

#include "ode/geom_class.h"
#include "ode_trimesh_gpu/library.h"

namespace otg {
namespace {

/// A geom whose scale the new vertices don't bear is left without a mesh: nothing to collide with is better than the
/// wrong thing. False for want of memory.
bool rescaleOrEmpty(GeomObject& object, dxGpuTriMeshData* data) {
  object.scaled = nullptr;
  try {
    object.rescale(data, object.scale);
    return true;
  } catch (...) {
    return false;
  }
}

}  // namespace
}  // namespace otg

int dxGpuTriMeshData::accept(otg::MeshResult&& result, std::shared_ptr<const otg::CollisionMesh> mesh) {
  report_ = std::move(result.report);
  if (mesh == nullptr) return dGPUTRIMESH_ERROR_MESH;
  mesh_ = std::move(mesh);
  useFlags.clear();
  ownFlags.clear();
  faceNormals.clear();
  {
    const std::lock_guard lock(scaledMutex_);
    scaled_.clear();
  }
  int status = dGPUTRIMESH_OK;
  const std::lock_guard lock(mutex_);
  for (const auto& [serial, geom] : users_) {
    otg::GeomObject* const object = otg::objectOf(geom);
    if (object != nullptr && !otg::rescaleOrEmpty(*object, this)) status = dGPUTRIMESH_ERROR_MEMORY;
    dGeomMoved(geom);
  }
  return status;
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

int dxGpuTriMeshData::take(std::shared_ptr<const otg::CollisionMesh> mesh, std::string error) {
  otg::MeshResult result;
  result.report.error = std::move(error);
  if (mesh != nullptr) result.report = mesh->mesh().report();
  return accept(std::move(result), std::move(mesh)) == dGPUTRIMESH_OK ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_COOKED;
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
