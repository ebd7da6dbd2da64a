// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/content_key.h"

#include "mesh/tri_mesh.h"

namespace otg {

std::uint64_t hashOfVertices(const TriMesh& mesh) {
  std::uint64_t sum = 0;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v)
    sum += vertexHash(mesh.callerVertex(v), mesh.vertices()[v]);
  return sum;
}

std::uint64_t hashOfTriangles(const TriMesh& mesh) {
  std::uint64_t sum = 0;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    std::uint64_t hash = ~std::uint64_t{mesh.callerTriangle(t)};
    for (const std::uint32_t v : mesh.triangles()[t].v) hash = spreadBits(spreadBits(hash) ^ mesh.callerVertex(v));
    sum += hash;
  }
  return sum;
}

}  // namespace otg
