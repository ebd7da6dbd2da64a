// SPDX-License-Identifier: BSD-3-Clause
#include "truth/body_in_ode.h"

#include <algorithm>
#include <stdexcept>

#include "scenes/convex_geom.h"

namespace otg::truth {
namespace {

/// A closed solid that faces outward still, and that sorts otherwise along a curve through space.
std::vector<Vec3f> before(const std::vector<Vec3f>& vertices) {
  std::vector<Vec3f> others = vertices;
  for (Vec3f& v : others) v = {0.4F * v.x - 0.9F * v.y, 0.9F * v.x + 0.4F * v.y, 2 * v.z};
  return others;
}

}  // namespace

dGeomID makeShapeGeom(const ConvexBody& shape, const scenes::MeshArrays& mesh,
                      std::unique_ptr<scenes::ConvexData>& convex) {
  switch (shape.kind) {
    case ConvexBody::Kind::kSphere:
      return dCreateSphere(nullptr, shape.radius);
    case ConvexBody::Kind::kBox:
      return dCreateBox(nullptr, 2 * shape.half.x, 2 * shape.half.y, 2 * shape.half.z);
    case ConvexBody::Kind::kCapsule:
      return dCreateCapsule(nullptr, shape.radius, 2 * shape.length);
    case ConvexBody::Kind::kCylinder:
      return dCreateCylinder(nullptr, shape.radius, 2 * shape.length);
    case ConvexBody::Kind::kPolyhedron:
      convex = std::make_unique<scenes::ConvexData>(mesh);
      return convex->makeGeom(nullptr);
  }
  throw std::runtime_error("no such shape");
}

BodyInOde::BodyInOde(const PairBody& body, const GeomChoices& choices) {
  if (body.shape) {
    geom_ = makeShapeGeom(*body.shape, body.mesh, convex_);
  } else if (choices.asTriMesh) {
    makeTriMesh(body.mesh, choices.byUpdate);
  } else {
    makeMesh(body.mesh, choices);
  }
  dMatrix3 r{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = body.pose.r[3 * row + column];
  }
  dGeomSetRotation(geom_, r);
  dGeomSetPosition(geom_, body.pose.t.x, body.pose.t.y, body.pose.t.z);
}

BodyInOde::~BodyInOde() {
  if (triMeshData_) dGpuTriMeshOverrideForgetGeom(geom_);
  if (geom_) dGeomDestroy(geom_);
  if (triMeshData_) {
    dGpuTriMeshOverrideForgetData(triMeshData_);
    dGeomTriMeshDataDestroy(triMeshData_);
  }
  if (data_) dGpuTriMeshDataDestroy(data_);
}

void BodyInOde::makeTriMesh(const scenes::MeshArrays& mesh, bool byUpdate) {
  arrays_ = mesh;  // ODE keeps pointers
  if (byUpdate) arrays_.vertices = before(mesh.vertices);
  triMeshData_ = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(triMeshData_, arrays_.vertices.data(), sizeof(Vec3f),
                              static_cast<int>(arrays_.vertices.size()), arrays_.triangles.data(),
                              static_cast<int>(3 * arrays_.triangles.size()), sizeof(Triangle));
  // What stock ODE requires where it collides convex shapes.
  dGeomTriMeshDataPreprocess2(triMeshData_, 1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);
  geom_ = dCreateTriMesh(nullptr, triMeshData_, nullptr, nullptr, nullptr);
  if (!byUpdate) return;
  dGpuTriMeshOverridePrepare(geom_);  // else the library would not read the first vertices at all
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), arrays_.vertices.begin());
  dGeomTriMeshDataUpdate(triMeshData_);
  dGpuTriMeshOverrideDataChanged(triMeshData_);
}

void BodyInOde::makeMesh(const scenes::MeshArrays& mesh, const GeomChoices& choices) {
  data_ = dGpuTriMeshDataCreate();
  const std::vector<Vec3f> vertices = choices.byUpdate ? before(mesh.vertices) : mesh.vertices;
  const int count = static_cast<int>(vertices.size());
  int status = dGpuTriMeshDataBuildSingle(data_, vertices.data(), sizeof(Vec3f), count, mesh.triangles.data(),
                                          static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
  if (status == dGPUTRIMESH_OK && choices.byUpdate) {
    status = dGpuTriMeshDataUpdateVerticesSingle(data_, mesh.vertices.data(), sizeof(Vec3f), count);
  }
  if (status != dGPUTRIMESH_OK) throw std::runtime_error("the library refuses a mesh");
  geom_ = dCreateGpuTriMesh(nullptr, data_);
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  if (!choices.remembers) params.history = dGPUTRIMESH_HISTORY_OFF;
  params.backend = dGPUTRIMESH_BACKEND_CPU;
  dGeomGpuTriMeshSetParams(geom_, &params);
}

}  // namespace otg::truth
