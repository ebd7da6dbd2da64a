// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_parts.h"

#include <algorithm>
#include <cmath>

#include "mesh/spatial_order.h"

namespace otg {
namespace {

/// Whether all numbers are below `limit` or, where that is allowed, kNone. Without a branch, so that it is done eight
/// at a time.
bool allBelow(const std::uint32_t* begin, std::size_t count, std::size_t limit, bool noneToo) {
  const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(limit, kNone));
  std::uint32_t bad = 0;
  if (noneToo) {
    for (std::size_t i = 0; i < count; ++i) bad |= (begin[i] >= most) & (begin[i] != kNone);
  } else {
    for (std::size_t i = 0; i < count; ++i) bad |= begin[i] >= most;
  }
  return bad == 0;
}
bool allBelow(const std::vector<std::uint32_t>& numbers, std::size_t limit, bool noneToo) {
  return allBelow(numbers.data(), numbers.size(), limit, noneToo);
}

bool allFinite(const std::vector<Vec3f>& vertices) {
  float sum = 0;  // of zeros; NaN once there is anything else
  for (const Vec3f& v : vertices) sum += v.x * 0 + v.y * 0 + v.z * 0;
  return sum == 0;
}

bool isPermutation(const std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint8_t> seen(numbers.size(), 0);
  for (const std::uint32_t n : numbers) {
    if (n >= seen.size() || seen[n] != 0) return false;
    seen[n] = 1;
  }
  return true;
}

bool twinsMatch(const Topology& topology) {
  std::uint32_t bad = 0;
  for (std::uint32_t h = 0; h < topology.twin.size(); ++h) {
    const std::uint32_t twin = topology.twin[h];
    if (twin != kNone) bad |= (topology.twin[twin] != h) | (topology.edgeOf[twin] != topology.edgeOf[h]) | (twin == h);
  }
  return bad == 0;
}

}  // namespace

TriMeshParts TriMeshParts::of(const TriMesh& mesh) {
  TriMeshParts parts;
  parts.vertices = mesh.vertices_;
  parts.triangles = mesh.triangles_;
  parts.degenerate = mesh.degenerate_;
  parts.topology = mesh.topology_;
  parts.report = mesh.report_;
  parts.mass = mesh.massProperties();
  parts.boundsMin = mesh.boundsMin_;
  parts.boundsMax = mesh.boundsMax_;
  parts.center = mesh.center_;
  parts.origin = mesh.origin_;
  parts.radius = mesh.radius_;
  parts.inputVertexCount = mesh.inputVertexCount_;
  parts.inputVertexOf = mesh.inputVertexOf_;
  parts.callerTriangle = mesh.callerTriangle_;
  return parts;
}

std::string TriMeshParts::fault() const {
  const std::size_t v = vertices.size(), t = triangles.size();
  if (v > kMaxVertices || t > kMaxTriangles || inputVertexCount > kMaxVertices) return "too many vertices or triangles";
  const bool sizes = degenerate.size() == t && topology.weld.size() == v && topology.edgeOf.size() == 3 * t &&
                     topology.twin.size() == 3 * t && topology.componentOf.size() == t &&
                     topology.componentVolume.size() == topology.componentClosed.size() &&
                     (inputVertexOf.empty() ? inputVertexCount == v : inputVertexOf.size() == v) &&
                     (callerTriangle.empty() || callerTriangle.size() == t);
  if (!sizes) return "arrays of sizes that do not match";
  // An empty mesh has no bounds, and the radius of the largest ones is rounded up to infinity.
  if (!allFinite(vertices) || (t > 0 && !allFinite({boundsMin, boundsMax, center, origin})) || !(radius >= 0)) {
    return "a vertex or bound that is not finite";
  }
  const std::size_t edges = topology.edges.size();
  const bool inRange = allBelow(t == 0 ? nullptr : triangles[0].v, 3 * t, v, false) &&
                       allBelow(topology.weld, v, false) && allBelow(topology.edgeOf, edges, true) &&
                       allBelow(topology.twin, 3 * t, true) &&
                       allBelow(edges == 0 ? nullptr : &topology.edges[0].a, 2 * edges, v, false) &&
                       allBelow(topology.componentOf, topology.componentCount(), true) &&
                       allBelow(inputVertexOf, inputVertexCount, false);
  if (!inRange) return "a number out of range";
  for (std::uint32_t i = 0; i < v; ++i) {
    if (topology.weld[i] > i || topology.weld[topology.weld[i]] != topology.weld[i]) return "points that do not match";
  }
  if (!twinsMatch(topology)) return "neighbours that do not match";
  if (!isPermutation(callerTriangle)) return "numbers of triangles that do not match";
  return {};
}

std::shared_ptr<const TriMesh> TriMeshParts::assemble(TriMeshParts&& parts) {
  const std::shared_ptr<TriMesh> mesh(new TriMesh);
  mesh->vertices_ = std::move(parts.vertices);
  mesh->triangles_ = std::move(parts.triangles);
  mesh->degenerate_ = std::move(parts.degenerate);
  mesh->topology_ = std::move(parts.topology);
  mesh->report_ = std::move(parts.report);
  mesh->mass_.set(parts.mass);
  mesh->boundsMin_ = parts.boundsMin;
  mesh->boundsMax_ = parts.boundsMax;
  mesh->center_ = parts.center;
  mesh->origin_ = parts.origin;
  mesh->radius_ = parts.radius;
  mesh->inputVertexCount_ = parts.inputVertexCount;
  mesh->inputVertexOf_ = std::move(parts.inputVertexOf);
  if (!parts.callerTriangle.empty()) mesh->triangleOfCaller_ = inverseOf(parts.callerTriangle);
  mesh->callerTriangle_ = std::move(parts.callerTriangle);
  return mesh;
}

}  // namespace otg
