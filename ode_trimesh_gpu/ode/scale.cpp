// SPDX-License-Identifier: BSD-3-Clause
// Scaled geoms. Boxes could be scaled while a tree is walked, but what triangles do is decided by vertices in single
// precision: every stage, and every device, would have to round a scaled vertex in the same way, and a mirrored mesh
// has its half-edges the other way round. So a scaled mesh is a mesh of its own, made once for all geoms that have the
// same data and the same scale.
#include <array>
#include <cmath>
#include <limits>

#include "ode/geom_class.h"
#include "ode/mesh_data.h"
#include "ode/status.h"
#include "ode_trimesh_gpu/geom.h"

namespace otg {
namespace {

/// Vertices as the caller numbers them (repair may have left some out: they are zero and no triangle uses them).
std::vector<Vec3f> scaledVertices(const TriMesh& mesh, const MeshScale& scale) {
  std::vector<Vec3f> vertices(mesh.inputVertexCount());
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3f& p = mesh.vertices()[v];
    vertices[mesh.callerVertex(v)] = {p.x * scale[0], p.y * scale[1], p.z * scale[2]};
  }
  return vertices;
}

MeshInput inputOf(const std::vector<Vec3f>& vertices) {
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  return input;
}

/// Null if a vertex is no finite float any more.
std::shared_ptr<const CollisionMesh> makeScaled(const CollisionMesh& from, const MeshScale& scale) {
  const TriMesh& mesh = from.mesh();
  const std::vector<Vec3f> vertices = scaledVertices(mesh, scale);
  if (scale[0] * scale[1] * scale[2] > 0) {
    const MeshResult moved = moveVertices(mesh, inputOf(vertices));
    return moved.mesh == nullptr ? nullptr : std::make_shared<const CollisionMesh>(moved.mesh, from);
  }
  std::vector<Triangle> triangles(mesh.triangleCount());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Triangle& own = mesh.triangles()[mesh.triangleOfCaller(t)];
    triangles[t] = {{mesh.callerVertex(own.v[0]), mesh.callerVertex(own.v[2]), mesh.callerVertex(own.v[1])}};
  }
  MeshInput input = inputOf(vertices);
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  const MeshResult built = buildTriMesh(input, {}, MeshOrder::kSpatial);
  return built.mesh == nullptr ? nullptr : std::make_shared<const CollisionMesh>(built.mesh, from.tree().strategy);
}

bool isOne(const MeshScale& scale) {
  return scale == MeshScale{1, 1, 1};
}

}  // namespace

int GeomObject::rescale(dxGpuTriMeshData* of, const MeshScale& by) {
  std::shared_ptr<const CollisionMesh> made;
  if (!isOne(by) && of != nullptr && of->mesh() != nullptr) {
    made = of->scaledMesh(by);
    if (made == nullptr) return dGPUTRIMESH_ERROR_MESH;
  }
  scale = by;
  scaled = std::move(made);
  return dGPUTRIMESH_OK;
}

const CollisionMesh* GeomObject::mesh() const {
  return isOne(scale) ? (data == nullptr ? nullptr : data->mesh()) : scaled.get();
}

std::shared_ptr<const CollisionMesh> GeomObject::sharedMesh() const {
  return isOne(scale) ? (data == nullptr ? nullptr : data->meshPtr()) : scaled;
}

}  // namespace otg

std::shared_ptr<const otg::CollisionMesh> dxGpuTriMeshData::scaledMesh(const otg::MeshScale& scale) {
  const std::lock_guard lock(scaledMutex_);
  std::weak_ptr<const otg::CollisionMesh>& known = scaled_[scale];
  std::shared_ptr<const otg::CollisionMesh> mesh = known.lock();
  if (mesh == nullptr) {
    mesh = otg::makeScaled(*mesh_, scale);
    known = mesh;
  }
  std::erase_if(scaled_, [](const auto& entry) { return entry.second.expired(); });
  return mesh;
}

int dGeomGpuTriMeshSetScale(dGeomID g, dReal x, dReal y, dReal z) {
  return otg::guarded([&] {
    otg::GeomObject* const object = otg::liveObjectOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    const otg::MeshScale scale = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    for (const float s : scale) {
      if (!std::isfinite(s) || s == 0) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const otg::ChangeHold change(&object->uses);
    const otg::UseHold use(change.good() && object->data != nullptr ? &object->data->uses : nullptr);
    if (!change.good() || !use.good()) return static_cast<int>(dGPUTRIMESH_ERROR_BUSY);
    if (const int status = object->rescale(object->data, scale)) return status;
    dGeomMoved(g);
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshGetScale(dGeomID g, dVector3 scale) {
  const otg::GeomObject* const object = otg::liveObjectOf(g);
  if (object == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_CLASS);
  if (scale == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  for (std::size_t k = 0; k < 3; ++k) scale[k] = static_cast<dReal>(object->scale[k]);
  scale[3] = 0;
  return dGPUTRIMESH_OK;
}
