// SPDX-License-Identifier: BSD-3-Clause
// Building, refitting and the life of mesh data.
#include "ode/data/mesh_data.h"

#include <ode/collision.h>

#include <unordered_set>
#include <utility>

#include "base/fork_gate.h"
#include "ode_trimesh_gpu/library.h"

namespace otg {
namespace {

/// The handles that programs hold: a handle that was given up is not among them.
struct LiveHandles {
  std::mutex mutex;
  std::unordered_set<const dxGpuTriMeshData*> handles;
};

/// Never destroyed: programs may destroy data in the destructors of their own globals.
LiveHandles& live() {
  static LiveHandles* const instance = new LiveHandles;
  return *instance;
}

}  // namespace
}  // namespace otg

dxGpuTriMeshData* dxGpuTriMeshData::create() {
  const otg::CallLock lock(otg::live().mutex);
  auto* const data = new dxGpuTriMeshData;
  try {
    otg::live().handles.insert(data);
  } catch (...) {
    delete data;
    throw;
  }
  return data;
}

bool dxGpuTriMeshData::isLive(const dxGpuTriMeshData* data) noexcept {
  if (data == nullptr) return false;
  const otg::CallLock lock(otg::live().mutex);
  return otg::live().handles.count(data) != 0;
}

int dxGpuTriMeshData::accept(otg::MeshResult&& result, std::shared_ptr<otg::CollisionMesh> mesh) {
  if (mesh == nullptr) {
    report_ = std::move(result.report);
    return dGPUTRIMESH_ERROR_MESH;
  }
  ScaledMeshes scaled = scaledFrom(*mesh);
  mesh_ = std::move(mesh);
  commit(std::move(result.report), std::move(scaled));
  return dGPUTRIMESH_OK;
}

void dxGpuTriMeshData::commit(otg::ValidationReport&& report, ScaledMeshes&& scaled) {
  report_ = std::move(report);
  useFlags.clear();
  ownFlags.clear();
  faceNormals.clear();
  {
    const otg::CallLock lock(scaledMutex_);
    scaled_ = std::move(scaled.known);
  }
  const otg::CallLock lock(mutex_);
  for (const auto& [serial, user] : users_) {
    if (user.geom == nullptr) continue;
    const auto mesh = scaled.meshes.find(user.scaled->scale);
    user.scaled->scaled = mesh == scaled.meshes.end() ? nullptr : mesh->second;
    dGeomMoved(user.geom);
  }
}

int dxGpuTriMeshData::build(const otg::MeshInput& input, const otg::RepairOptions& repair,
                            otg::BuildStrategy strategy) {
  const otg::ChangeHold change(&uses);
  if (!change.good()) return dGPUTRIMESH_ERROR_BUSY;
  otg::MeshResult result = otg::buildTriMesh(input, repair, otg::MeshOrder::kBySize);
  std::shared_ptr<otg::CollisionMesh> mesh;
  if (result.mesh != nullptr) mesh = std::make_shared<otg::CollisionMesh>(result.mesh, strategy);
  return accept(std::move(result), std::move(mesh));
}

int dxGpuTriMeshData::moveVertices(const otg::MeshInput& vertices) {
  const otg::ChangeHold change(&uses);
  return change.good() ? moveAll(vertices) : dGPUTRIMESH_ERROR_BUSY;
}

int dxGpuTriMeshData::moveAll(const otg::MeshInput& vertices) {
  if (mesh_ == nullptr) return dGPUTRIMESH_ERROR_ARGUMENT;
  otg::MeshResult result = otg::moveVertices(mesh_->mesh(), vertices);
  std::shared_ptr<otg::CollisionMesh> mesh;
  if (result.mesh != nullptr) mesh = std::make_shared<otg::CollisionMesh>(result.mesh, *mesh_);
  return accept(std::move(result), std::move(mesh));
}

int dxGpuTriMeshData::moveSome(const otg::MeshInput& input, std::size_t first, const int* numbers) {
  const otg::ChangeHold change(&uses);
  if (!change.good()) return dGPUTRIMESH_ERROR_BUSY;
  if (mesh_ == nullptr) return dGPUTRIMESH_ERROR_ARGUMENT;
  const std::size_t all = mesh_->mesh().inputVertexCount();
  if (numbers == nullptr && (first > all || input.vertexCount > all - first)) return dGPUTRIMESH_ERROR_ARGUMENT;
  for (std::size_t i = 0; numbers != nullptr && i < input.vertexCount; ++i) {
    if (numbers[i] < 0 || static_cast<std::size_t>(numbers[i]) >= all) return dGPUTRIMESH_ERROR_ARGUMENT;
  }
  otg::ValidationReport report;
  const std::vector<otg::Vec3f> places = otg::readSomeVertices(mesh_->mesh(), input, report);
  if (!report.error.empty()) return accept({nullptr, std::move(report)}, nullptr);
  const auto numberOf = [&](std::size_t i) {
    return numbers == nullptr ? first + i : static_cast<std::size_t>(numbers[i]);
  };
  std::vector<PlacedVertex> placed(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    placed[i] = {static_cast<std::uint32_t>(numberOf(i)), places[i]};
  }
  if (moveInPlace(placed)) return dGPUTRIMESH_OK;
  std::vector<otg::Vec3f> vertices = otg::verticesOfCaller(mesh_->mesh());
  for (std::size_t i = 0; i < places.size(); ++i) vertices[numberOf(i)] = places[i];
  otg::MeshInput whole;
  whole.vertices = vertices.data();
  whole.vertexCount = vertices.size();
  return moveAll(whole);
}

int dxGpuTriMeshData::take(std::shared_ptr<otg::CollisionMesh> mesh, std::string error) {
  const otg::ChangeHold change(&uses);
  if (!change.good()) return dGPUTRIMESH_ERROR_BUSY;
  otg::MeshResult result;
  result.report.error = std::move(error);
  if (mesh != nullptr) result.report = mesh->mesh().report();
  return accept(std::move(result), std::move(mesh)) == dGPUTRIMESH_OK ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_COOKED;
}

void dxGpuTriMeshData::releaseHandle() noexcept {
  const otg::LibraryCall call;  // what goes with the data has locks of its own
  {
    const otg::CallLock lock(otg::live().mutex);
    otg::live().handles.erase(this);
  }
  bool unused = false;
  {
    const otg::CallLock lock(mutex_);
    handle_ = false;
    unused = users_.empty();
  }
  if (unused) delete this;
}

bool dxGpuTriMeshData::hasHandle() const {
  const otg::CallLock lock(mutex_);
  return handle_;
}

void dxGpuTriMeshData::attach(std::uint64_t serial, dGeomID geom, otg::ScaledMesh* scaled) {
  const otg::CallLock lock(mutex_);
  users_.emplace(serial, User{geom, scaled});
}

void dxGpuTriMeshData::detach(std::uint64_t serial) noexcept {
  bool unused = false;
  {
    const otg::CallLock lock(mutex_);
    users_.erase(serial);
    unused = users_.empty() && !handle_;
  }
  if (unused) delete this;
}

void dxGpuTriMeshData::forgetGeom(std::uint64_t serial) noexcept {
  const otg::CallLock lock(mutex_);
  if (const auto it = users_.find(serial); it != users_.end()) it->second.geom = nullptr;
}
