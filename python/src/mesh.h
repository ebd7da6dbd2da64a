// SPDX-License-Identifier: BSD-3-Clause
// Mesh data of the C API with an owner.
#pragma once

#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <memory>
#include <string>

#include "arrays.h"

namespace otg::python {

class Mesh {
 public:
  Mesh();
  ~Mesh();
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  dGpuTriMeshDataID data() const { return data_; }
  /// Builds from arrays; `vertexType` is dGPUTRIMESH_VERTEX_... Throws StatusError with the report's sentence.
  void build(const void* vertices, int vertexType, std::size_t vertexCount, const std::uint32_t* triangles,
             std::size_t triangleCount, bool repair);
  /// Throws StatusError with the data's own sentence where there is one.
  void checkData(int status, const std::string& doing) const;

 private:
  dGpuTriMeshDataID data_;
};

void bindMesh(nb::module_& module);

}  // namespace otg::python
