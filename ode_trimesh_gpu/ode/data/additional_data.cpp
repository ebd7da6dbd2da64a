// SPDX-License-Identifier: BSD-3-Clause
// The C API of what ODE calls additional and preprocessed data: normals, edges to use, angles of edges.
#include <cmath>
#include <vector>

#include "base/vectors.h"
#include "mesh/adjacency.h"
#include "ode/base/status.h"
#include "ode/data/mesh_data.h"

namespace otg {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// By how much the surface turns at half-edge h: see dGpuTriMeshDataGetEdgeAngle().
double edgeAngle(const CollisionMesh& mesh, std::uint32_t h) {
  const Topology& topology = mesh.mesh().topology();
  const std::uint32_t twin = topology.twin[h];
  if (twin == kNone) return kPi;
  const std::uint32_t t = h / 3, other = twin / 3;
  if (mesh.mesh().isDegenerate(t) || mesh.mesh().isDegenerate(other)) return kPi;
  const auto vertex = [&](std::uint32_t corner) {
    const Vec3f& v = mesh.mesh().vertices()[mesh.mesh().triangles()[corner / 3].v[corner % 3]];
    return Vec3d{v.x, v.y, v.z};
  };
  const Vec3d &n = mesh.adjacency().normal[t], &m = mesh.adjacency().normal[other];
  const Vec3d along = otgSub(vertex(3 * t + (h + 1) % 3), vertex(h));
  const double length = norm(along);
  // The sine is positive if the other triangle falls away behind this one's plane.
  return length > 0 ? std::atan2(otgDot(otgCross(n, m), along) / length, otgDot(n, m)) : kPi;
}

/// Half-edge k of a triangle in the caller's number.
std::uint32_t halfEdge(const TriMesh& mesh, std::uint32_t callerTriangle, std::uint32_t k) {
  return 3 * mesh.triangleOfCaller(callerTriangle) + k;
}

std::vector<std::uint8_t> usedEdges(const CollisionMesh& mesh) {
  const TriMesh& m = mesh.mesh();
  const auto count = static_cast<std::uint32_t>(m.triangleCount());
  constexpr double kLeast = Adjacency::kFlatDegrees * kPi / 180;
  std::vector<std::uint8_t> flags(count, 0), usable(m.vertices().size(), 0);
  for (std::uint32_t t = 0; t < count; ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t h = halfEdge(m, t, k), twin = m.topology().twin[h];
      if (edgeAngle(mesh, h) <= kLeast) continue;
      const Triangle& triangle = m.triangles()[h / 3];
      for (const std::uint32_t v : {triangle.v[k], triangle.v[(k + 1) % 3]}) usable[m.topology().weld[v]] = 1;
      if (twin == kNone || t < m.callerTriangle(twin / 3)) {
        flags[t] |= static_cast<std::uint8_t>(dMESHDATAUSE_EDGE1 << k);
      }
    }
  }
  for (std::uint32_t t = 0; t < count; ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint8_t& first = usable[m.topology().weld[m.triangles()[m.triangleOfCaller(t)].v[k]]];
      if (first != 0) flags[t] |= static_cast<std::uint8_t>(dMESHDATAUSE_VERTEX1 << k);
      first = 0;
    }
  }
  return flags;
}

std::vector<dReal> normalsOf(const CollisionMesh& mesh) {
  std::vector<dReal> normals;
  normals.reserve(3 * mesh.mesh().triangleCount());
  for (std::uint32_t t = 0; t < mesh.mesh().triangleCount(); ++t) {
    const Vec3d& n = mesh.adjacency().normal[mesh.mesh().triangleOfCaller(t)];
    normals.insert(normals.end(), {static_cast<dReal>(n.x), static_cast<dReal>(n.y), static_cast<dReal>(n.z)});
  }
  return normals;
}

bool isBuilt(dGpuTriMeshDataID g) {
  return dxGpuTriMeshData::isLive(g) && g->mesh() != nullptr;
}

}  // namespace
}  // namespace otg

int dGpuTriMeshDataPreprocess2(dGpuTriMeshDataID g, unsigned int buildRequestFlags, const dintptr*) {
  const int status = otg::guarded([&] {
    if (!otg::isBuilt(g) || (buildRequestFlags >> dTRIDATAPREPROCESS_BUILD__MAX) != 0) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    if ((buildRequestFlags & (1u << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES)) != 0) {
      g->ownFlags = otg::usedEdges(*g->mesh());
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return status == dGPUTRIMESH_OK ? 1 : 0;
}

int dGpuTriMeshDataPreprocess(dGpuTriMeshDataID g) {
  return dGpuTriMeshDataPreprocess2(g, 1u << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES, nullptr);
}

int dGpuTriMeshDataSet(dGpuTriMeshDataID g, int data_id, const void* in_data) {
  return otg::guarded([&] {
    if (!otg::isBuilt(g) || (data_id != dTRIMESHDATA_USE_FLAGS && data_id != dTRIMESHDATA_FACE_NORMALS)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    if (data_id == dTRIMESHDATA_USE_FLAGS) {
      const auto* const from = static_cast<const std::uint8_t*>(in_data);
      std::vector<std::uint8_t> flags;
      if (from != nullptr) flags.assign(from, from + g->mesh()->mesh().triangleCount());
      g->useFlags = std::move(flags);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

const void* dGpuTriMeshDataGet2(dGpuTriMeshDataID g, int data_id, dsizeint* pout_size) {
  const void* found = nullptr;
  dsizeint size = 0;
  otg::guarded([&] {
    if (!otg::isBuilt(g)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (data_id == dTRIMESHDATA_USE_FLAGS) {
      const std::vector<std::uint8_t>& flags = g->useFlags.empty() ? g->ownFlags : g->useFlags;
      if (!flags.empty()) found = flags.data();
      size = flags.size();
    } else if (data_id == dTRIMESHDATA_FACE_NORMALS) {
      if (g->faceNormals.empty()) g->faceNormals = otg::normalsOf(*g->mesh());
      if (!g->faceNormals.empty()) found = g->faceNormals.data();
      size = g->faceNormals.size() * sizeof(dReal);
    } else {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  if (pout_size != nullptr) *pout_size = size;
  return found;
}

const void* dGpuTriMeshDataGet(dGpuTriMeshDataID g, int data_id) {
  return dGpuTriMeshDataGet2(g, data_id, nullptr);
}

void dGpuTriMeshDataGetBuffer(dGpuTriMeshDataID g, unsigned char** buf, int* bufLen) {
  dsizeint size = 0;
  const void* const flags = dGpuTriMeshDataGet2(g, dTRIMESHDATA_USE_FLAGS, &size);
  // ODE's signature: what it gives out is not const.
  if (buf != nullptr) *buf = static_cast<unsigned char*>(const_cast<void*>(flags));
  if (bufLen != nullptr) *bufLen = static_cast<int>(size);
}

void dGpuTriMeshDataSetBuffer(dGpuTriMeshDataID g, unsigned char* buf) {
  dGpuTriMeshDataSet(g, dTRIMESHDATA_USE_FLAGS, buf);
}

int dGpuTriMeshDataGetEdgeAngle(dGpuTriMeshDataID g, int Triangle, int Edge, dReal* angle) {
  return otg::guarded([&] {
    if (!otg::isBuilt(g) || angle == nullptr || Triangle < 0 || Edge < 0 || Edge > 2 ||
        static_cast<std::size_t>(Triangle) >= g->mesh()->mesh().triangleCount()) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const std::uint32_t h =
        otg::halfEdge(g->mesh()->mesh(), static_cast<std::uint32_t>(Triangle), static_cast<std::uint32_t>(Edge));
    *angle = static_cast<dReal>(otg::edgeAngle(*g->mesh(), h));
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
