// SPDX-License-Identifier: BSD-3-Clause
// The C API of mesh data: argument checks and conversion to MeshInput.
#include "ode_trimesh_gpu/trimesh_data.h"

#include <cstdint>
#include <new>
#include <vector>

#include "ode/base/status.h"
#include "ode/data/mesh_data.h"

namespace otg {
namespace {

std::size_t scalarSize(MeshInput::Scalar scalar) {
  return scalar == MeshInput::Scalar::kFloat ? sizeof(float) : sizeof(double);
}

/// A stride of ours: 0, or at least one element. Smaller ones would make elements overlap, which no array has.
bool isStride(int stride, std::size_t elementSize) {
  return stride == 0 || (stride > 0 && static_cast<std::size_t>(stride) >= elementSize);
}

bool setVertices(MeshInput& input, MeshInput::Scalar scalar, const void* vertices, int stride, int count) {
  if (count < 0 || !isStride(stride, 3 * scalarSize(scalar))) return false;
  input.vertices = vertices;
  input.scalar = scalar;
  input.vertexStride = static_cast<std::size_t>(stride);
  input.vertexCount = static_cast<std::size_t>(count);
  return true;
}

bool setTriangles(MeshInput& input, const void* indices, int indexCount, int stride) {
  if (indexCount < 0 || indexCount % 3 != 0 || !isStride(stride, 3 * sizeof(std::uint32_t))) return false;
  input.indices = indices;
  input.triangleStride = static_cast<std::size_t>(stride);
  input.triangleCount = static_cast<std::size_t>(indexCount) / 3;
  return true;
}

int build(dGpuTriMeshDataID g, MeshInput::Scalar scalar, const void* vertices, int vertexStride, int vertexCount,
          const void* indices, int indexCount, int triStride, const RepairOptions& repair = {},
          BuildStrategy strategy = BuildStrategy::kSah) noexcept {
  return guarded([&] {
    MeshInput input;
    if (!dxGpuTriMeshData::isLive(g) || !setVertices(input, scalar, vertices, vertexStride, vertexCount) ||
        !setTriangles(input, indices, indexCount, triStride)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    return g->build(input, repair, strategy);
  });
}

int update(dGpuTriMeshDataID g, MeshInput::Scalar scalar, const void* vertices, int stride, int count) noexcept {
  return guarded([&] {
    MeshInput input;
    if (!dxGpuTriMeshData::isLive(g) || !setVertices(input, scalar, vertices, stride, count)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    return g->moveVertices(input);
  });
}

int updateSome(dGpuTriMeshDataID g, MeshInput::Scalar scalar, const void* vertices, int stride, int first,
               const int* numbers, int count) noexcept {
  return guarded([&] {
    MeshInput input;
    if (!dxGpuTriMeshData::isLive(g) || first < 0 || !setVertices(input, scalar, vertices, stride, count)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    return g->moveSome(input, static_cast<std::size_t>(first), numbers);
  });
}

int updateList(dGpuTriMeshDataID g, MeshInput::Scalar scalar, const void* vertices, int stride, const int* numbers,
               int count) noexcept {
  if (numbers == nullptr && count > 0) return noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  return updateSome(g, scalar, vertices, stride, 0, numbers, count);
}

constexpr MeshInput::Scalar kRealScalar = sizeof(dReal) == 8 ? MeshInput::Scalar::kDouble : MeshInput::Scalar::kFloat;
/// ODE's "simple" arrays are arrays of dVector3.
constexpr int kVector3Stride = sizeof(dVector3);

}  // namespace
}  // namespace otg

dGpuTriMeshDataID dGpuTriMeshDataCreate(void) {
  dxGpuTriMeshData* data = nullptr;
  otg::guarded([&] {
    data = dxGpuTriMeshData::create();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return data;
}

void dGpuTriMeshDataDestroy(dGpuTriMeshDataID g) {
  if (g == nullptr) return;
  if (!dxGpuTriMeshData::isLive(g)) {
    otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
    return;
  }
  g->releaseHandle();
}

int dGpuTriMeshDataBuildSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                               const void* Indices, int IndexCount, int TriStride) {
  return otg::build(g, otg::MeshInput::Scalar::kFloat, Vertices, VertexStride, VertexCount, Indices, IndexCount,
                    TriStride);
}

int dGpuTriMeshDataBuildSingle1(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                                const void* Indices, int IndexCount, int TriStride, const void*) {
  return dGpuTriMeshDataBuildSingle(g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride);
}

int dGpuTriMeshDataBuildDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                               const void* Indices, int IndexCount, int TriStride) {
  return otg::build(g, otg::MeshInput::Scalar::kDouble, Vertices, VertexStride, VertexCount, Indices, IndexCount,
                    TriStride);
}

int dGpuTriMeshDataBuildDouble1(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                                const void* Indices, int IndexCount, int TriStride, const void*) {
  return dGpuTriMeshDataBuildDouble(g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride);
}

int dGpuTriMeshDataBuildSimple(dGpuTriMeshDataID g, const dReal* Vertices, int VertexCount, const dTriIndex* Indices,
                               int IndexCount) {
  if constexpr (sizeof(dTriIndex) == sizeof(std::uint32_t)) {
    return otg::build(g, otg::kRealScalar, Vertices, otg::kVector3Stride, VertexCount, Indices, IndexCount, 0);
  } else {
    return otg::guarded([&] {  // an ODE with 16-bit indices
      std::vector<std::uint32_t> wide;
      if (Indices != nullptr && IndexCount > 0) wide.assign(Indices, Indices + IndexCount);
      return otg::build(g, otg::kRealScalar, Vertices, otg::kVector3Stride, VertexCount,
                        Indices == nullptr ? nullptr : wide.data(), IndexCount, 0);
    });
  }
}

int dGpuTriMeshDataBuildSimple1(dGpuTriMeshDataID g, const dReal* Vertices, int VertexCount, const dTriIndex* Indices,
                                int IndexCount, const int*) {
  return dGpuTriMeshDataBuildSimple(g, Vertices, VertexCount, Indices, IndexCount);
}

void dGpuTriMeshBuildParamsInit(dGpuTriMeshBuildParams* params) {
  if (params == nullptr) return;
  *params = dGpuTriMeshBuildParams{};
  params->size = sizeof(dGpuTriMeshBuildParams);
  params->vertex_type = dGPUTRIMESH_VERTEX_SINGLE;
  params->repair = dGPUTRIMESH_REPAIR_NONE;
  params->tree = dGPUTRIMESH_TREE_SAH;
}

int dGpuTriMeshDataBuild(dGpuTriMeshDataID g, const dGpuTriMeshBuildParams* params) {
  if (!otg::isCurrentSize(params) || (params->repair & ~dGPUTRIMESH_REPAIR_ALL) != 0 ||
      params->vertex_type < dGPUTRIMESH_VERTEX_SINGLE || params->vertex_type > dGPUTRIMESH_VERTEX_DOUBLE ||
      params->tree < dGPUTRIMESH_TREE_SAH || params->tree > dGPUTRIMESH_TREE_MEAN_SPLIT) {
    return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  }
  otg::RepairOptions repair;
  repair.weldVertices = (params->repair & dGPUTRIMESH_REPAIR_WELD) != 0;
  repair.dropDegenerate = (params->repair & dGPUTRIMESH_REPAIR_DROP_DEGENERATE) != 0;
  repair.dropDuplicates = (params->repair & dGPUTRIMESH_REPAIR_DROP_DUPLICATES) != 0;
  repair.orientConsistently = (params->repair & dGPUTRIMESH_REPAIR_ORIENT) != 0;
  const auto scalar = params->vertex_type == dGPUTRIMESH_VERTEX_DOUBLE ? otg::MeshInput::Scalar::kDouble
                                                                       : otg::MeshInput::Scalar::kFloat;
  const auto strategy =
      params->tree == dGPUTRIMESH_TREE_MEAN_SPLIT ? otg::BuildStrategy::kMeanSplit : otg::BuildStrategy::kSah;
  return otg::build(g, scalar, params->vertices, params->vertex_stride, params->vertex_count, params->indices,
                    params->index_count, params->tri_stride, repair, strategy);
}

int dGpuTriMeshDataUpdateVerticesSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount) {
  return otg::update(g, otg::MeshInput::Scalar::kFloat, Vertices, VertexStride, VertexCount);
}

int dGpuTriMeshDataUpdateVerticesDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount) {
  return otg::update(g, otg::MeshInput::Scalar::kDouble, Vertices, VertexStride, VertexCount);
}

int dGpuTriMeshDataUpdate(dGpuTriMeshDataID g, const dReal* Vertices, int VertexCount) {
  return otg::update(g, otg::kRealScalar, Vertices, otg::kVector3Stride, VertexCount);
}

int dGpuTriMeshDataUpdateRangeSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int First,
                                     int Count) {
  return otg::updateSome(g, otg::MeshInput::Scalar::kFloat, Vertices, VertexStride, First, nullptr, Count);
}

int dGpuTriMeshDataUpdateRangeDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int First,
                                     int Count) {
  return otg::updateSome(g, otg::MeshInput::Scalar::kDouble, Vertices, VertexStride, First, nullptr, Count);
}

int dGpuTriMeshDataUpdateListSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, const int* Numbers,
                                    int Count) {
  return otg::updateList(g, otg::MeshInput::Scalar::kFloat, Vertices, VertexStride, Numbers, Count);
}

int dGpuTriMeshDataUpdateListDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, const int* Numbers,
                                    int Count) {
  return otg::updateList(g, otg::MeshInput::Scalar::kDouble, Vertices, VertexStride, Numbers, Count);
}
