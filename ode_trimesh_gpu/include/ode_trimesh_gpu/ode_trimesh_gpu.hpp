// SPDX-License-Identifier: BSD-3-Clause
// The C API for C++ programs (C++11 and later): ownership by scope, and arrays with their sizes. Header only;
// everything here is a call or two of the C API, which may be used beside it.
#ifndef ODE_TRIMESH_GPU_HPP
#define ODE_TRIMESH_GPU_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "ode_trimesh_gpu.h"

namespace otg {

/// Whether the library, the ODE in this process and the compiler's view of dReal agree, and the class could be
/// registered.
inline bool initGpuTriMesh() {
  const char* const precision = sizeof(dReal) == 8 ? "double_precision" : "single_precision";
  return dGpuTriMeshCheckConfiguration(precision) != 0 && dGpuTriMeshInit() != 0;
}

/// Owns a dGpuTriMeshDataID. Move-only. Geoms that were made from it outlive it safely.
class GpuTriMeshData {
 public:
  /// Without triangles; id() is NULL when memory is short.
  GpuTriMeshData() : id_(dGpuTriMeshDataCreate()) {}
  ~GpuTriMeshData() { dGpuTriMeshDataDestroy(id_); }
  /// Takes the mesh of another one.
  /// @param other  may only be destroyed or assigned to afterwards
  GpuTriMeshData(GpuTriMeshData&& other) noexcept : id_(other.id_) { other.id_ = nullptr; }
  /// Exchanges the meshes.
  /// @param other  gets the mesh that was here
  /// @returns this
  GpuTriMeshData& operator=(GpuTriMeshData&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GpuTriMeshData(const GpuTriMeshData&) = delete;
  GpuTriMeshData& operator=(const GpuTriMeshData&) = delete;

  /// @returns the object, for functions of the C API
  dGpuTriMeshDataID id() const { return id_; }

  /// Builds from tightly packed arrays.
  /// @param vertices       three coordinates for each vertex
  /// @param vertexCount    number of vertices
  /// @param indices        three vertex indices for each triangle
  /// @param triangleCount  number of triangles
  /// @param repair         dGPUTRIMESH_REPAIR_... added up
  /// @returns the status of dGpuTriMeshDataBuild()
  int build(const float* vertices, std::size_t vertexCount, const std::uint32_t* indices, std::size_t triangleCount,
            int repair = dGPUTRIMESH_REPAIR_NONE) {
    return build(vertices, dGPUTRIMESH_VERTEX_SINGLE, vertexCount, indices, triangleCount, repair);
  }
  /// Builds from double precision vertices.
  /// @copydetails build(const float*, std::size_t, const std::uint32_t*, std::size_t, int)
  int build(const double* vertices, std::size_t vertexCount, const std::uint32_t* indices, std::size_t triangleCount,
            int repair = dGPUTRIMESH_REPAIR_NONE) {
    return build(vertices, dGPUTRIMESH_VERTEX_DOUBLE, vertexCount, indices, triangleCount, repair);
  }

  /// @returns what dGpuTriMeshDataGetReport() says of the mesh
  dGpuTriMeshReport report() const {
    dGpuTriMeshReport result;
    dGpuTriMeshReportInit(&result);
    dGpuTriMeshDataGetReport(id_, &result);
    return result;
  }
  /// @returns why the last mesh was refused (dGPUTRIMESH_ERROR_MESH); empty after one that was accepted
  std::string error() const { return dGpuTriMeshDataGetErrorString(id_); }

  /// A geom that shares this mesh; the caller or the space destroys it, as with any geom.
  /// @param space  may be NULL
  /// @returns the geom; NULL: dGpuTriMeshGetError()
  dGeomID createGeom(dSpaceID space = nullptr) const { return dCreateGpuTriMesh(space, id_); }

 private:
  int build(const void* vertices, int type, std::size_t vertexCount, const std::uint32_t* indices,
            std::size_t triangleCount, int repair) {
    // The C API counts in int, as ODE's does.
    if (vertexCount > 0x7fffffffu || triangleCount > 0x7fffffffu / 3) return dGPUTRIMESH_ERROR_ARGUMENT;
    dGpuTriMeshBuildParams params;
    dGpuTriMeshBuildParamsInit(&params);
    params.vertices = vertices;
    params.vertex_type = type;
    params.vertex_count = static_cast<int>(vertexCount);
    params.indices = indices;
    params.index_count = static_cast<int>(3 * triangleCount);
    params.repair = repair;
    return dGpuTriMeshDataBuild(id_, &params);
  }

  dGpuTriMeshDataID id_;
};

}  // namespace otg

#endif  // ODE_TRIMESH_GPU_HPP
