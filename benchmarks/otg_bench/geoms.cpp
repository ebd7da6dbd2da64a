// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/geoms.h"

#include "cli/command.h"

namespace otg::cli {

dGpuTriMeshDataID meshData(const TriMesh& mesh, const std::string& name) {
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  if (dGpuTriMeshDataBuildSingle(data, mesh.vertices().data(), sizeof(Vec3f), static_cast<int>(mesh.vertices().size()),
                                 mesh.triangles().data(), static_cast<int>(3 * mesh.triangleCount()),
                                 sizeof(Triangle)) != dGPUTRIMESH_OK) {
    dGpuTriMeshDataDestroy(data);
    throw InputError(name + ": the library refuses this mesh");
  }
  return data;
}

void poseGeom(dGeomID geom, const Transformd& pose) {
  dMatrix3 r{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = pose.r[3 * row + column];
  }
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, pose.t.x, pose.t.y, pose.t.z);
}

double lastTouch(double low, double high, double tolerance, const std::function<bool(double)>& touchesAt) {
  while (high - low > tolerance) {
    const double middle = 0.5 * (low + high);
    (touchesAt(middle) ? low : high) = middle;
  }
  return low;
}

MeshTwins::MeshTwins(const scenes::MeshArrays& arrays) : arrays_(arrays) {
  const MeshInput in = arrays_.input();
  data_ = dGpuTriMeshDataCreate();
  dGpuTriMeshDataBuildSingle(data_, in.vertices, sizeof(Vec3f), static_cast<int>(in.vertexCount), in.indices,
                             static_cast<int>(3 * in.triangleCount), sizeof(Triangle));
  stockData_ = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(stockData_, in.vertices, sizeof(Vec3f), static_cast<int>(in.vertexCount), in.indices,
                              static_cast<int>(3 * in.triangleCount), sizeof(Triangle));
  dGeomTriMeshDataPreprocess2(stockData_, 1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);  // for convexes
  ours = dCreateGpuTriMesh(nullptr, data_);
  stock = dCreateTriMesh(nullptr, stockData_, nullptr, nullptr, nullptr);
}

MeshTwins::~MeshTwins() {
  dGeomDestroy(ours);
  dGeomDestroy(stock);
  dGpuTriMeshDataDestroy(data_);
  dGeomTriMeshDataDestroy(stockData_);
}

GeomPairs::GeomPairs(const std::vector<Query>& queries) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  const auto geomOf = [&](const CollisionMesh& mesh) {
    const auto [found, isNew] = data_.try_emplace(&mesh, nullptr);
    if (isNew) found->second = meshData(mesh.mesh(), "a mesh of this benchmark");
    const dGeomID geom = dCreateGpuTriMesh(nullptr, found->second);
    dGeomGpuTriMeshSetParams(geom, &params);
    return geom;
  };
  for (const Query& query : queries) {
    params.contact_model =
        query.options.contacts == ContactModel::kSolid ? dGPUTRIMESH_CONTACTS_SOLID : dGPUTRIMESH_CONTACTS_PAIRWISE;
    params.max_contacts = query.options.maxContacts;
    const dGpuTriMeshPair pair{geomOf(*query.a), geomOf(*query.b)};
    poseGeom(pair.o2, query.bInA);
    for (const dGeomID geom : {pair.o1, pair.o2}) {  // ODE works out poses and boxes on demand, in one thread
      dReal box[6];
      dGeomGetAABB(geom, box);
    }
    pairs_.push_back(pair);
  }
}

GeomPairs::~GeomPairs() {
  for (const dGpuTriMeshPair& pair : pairs_) {
    dGeomDestroy(pair.o1);
    dGeomDestroy(pair.o2);
  }
  for (const auto& [mesh, data] : data_) dGpuTriMeshDataDestroy(data);
}

void GeomPairs::setBackend(int backend) const {
  for (const dGpuTriMeshPair& pair : pairs_) {
    dGeomGpuTriMeshSetBackend(pair.o1, backend);
    dGeomGpuTriMeshSetBackend(pair.o2, backend);
  }
}

void GeomPairs::setHistory(int history) const {
  for (const dGpuTriMeshPair& pair : pairs_) {
    for (const dGeomID geom : {pair.o1, pair.o2}) {
      dGpuTriMeshParams params;
      dGpuTriMeshParamsInit(&params);
      dGeomGpuTriMeshGetParams(geom, &params);
      params.history = history;
      dGeomGpuTriMeshSetParams(geom, &params);
    }
  }
}

std::uint64_t deviceSum(duint64 dGpuTriMeshDevice::*member) {
  std::uint64_t sum = 0;
  for (int i = 0; i < dGpuTriMeshGetDeviceCount(); ++i) {
    dGpuTriMeshDevice device;
    dGpuTriMeshDeviceInit(&device);
    if (dGpuTriMeshGetDevice(i, &device) == dGPUTRIMESH_OK) sum += device.*member;
  }
  return sum;
}

}  // namespace otg::cli
