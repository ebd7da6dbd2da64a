// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/packed_solid.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "collide/solid_contacts.h"
#include "shared/solid_layout.h"

namespace otg::opencl {
namespace {

MeshUnit unit(const Vec3f& p, std::uint32_t w) {
  return {p.x, p.y, p.z, w};
}

MeshUnit words(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t w) {
  return {std::bit_cast<float>(x), std::bit_cast<float>(y), std::bit_cast<float>(z), w};
}

/// Whether vertices that are one point differ in the signs of zeros, which the host keeps apart.
bool hasTwoZeros(const TriMesh& mesh) {
  const SharedArray<std::uint32_t>& weld = mesh.topology().weld;
  for (std::size_t v = 0; v < weld.size(); ++v) {
    if (std::memcmp(&mesh.vertices()[v], &mesh.vertices()[weld[v]], sizeof(Vec3f)) != 0) return true;
  }
  return false;
}

/// Bytes in whole units.
void addBytes(PackedMesh& out, const void* bytes, std::size_t size) {
  const std::size_t begin = out.units.size();
  out.units.resize(begin + (size + sizeof(MeshUnit) - 1) / sizeof(MeshUnit));
  if (size > 0) std::memcpy(out.units.data() + begin, bytes, size);
}

/// The same vertices as isContained in collide/solid/inside.cpp.
void addSamples(PackedMesh& out, const TriMesh& mesh, const Adjacency& adjacency, std::uint32_t component) {
  const std::uint32_t first = adjacency.componentFirst[component];
  const std::uint32_t triangles = adjacency.componentFirst[component + 1] - first;
  const std::uint32_t samples = std::min<std::uint32_t>(triangles, OTG_SOLID_SAMPLES);
  for (std::uint32_t i = 0; i < OTG_SOLID_SAMPLES; ++i) {
    const std::uint32_t at = i < samples ? static_cast<std::uint32_t>(std::uint64_t{i} * triangles / samples) : 0;
    const std::uint32_t v = mesh.triangles()[adjacency.componentTriangles[first + at]].v[i % 3];
    out.units.push_back(unit(mesh.vertices()[v], samples));
  }
}

void addClusters(PackedMesh& out, const Adjacency& adjacency) {
  for (const Adjacency::Cluster& c : adjacency.clusters) {
    out.units.push_back(unit(c.lo, c.first));
    out.units.push_back(unit(c.hi, c.firstNeighbour));
    const double numbers[6] = {c.sum.vector.x, c.sum.vector.y, c.sum.vector.z, c.sum.area, c.moment, 0};
    addBytes(out, numbers, sizeof numbers);
  }
  static_assert(sizeof(Adjacency::Star) == 4 * sizeof(double));
  addBytes(out, adjacency.star.data(), adjacency.star.size() * sizeof(Adjacency::Star));
  std::vector<std::uint32_t> lists(adjacency.clusterVertices.begin(), adjacency.clusterVertices.end());
  lists.insert(lists.end(), adjacency.clusterNeighbours.begin(), adjacency.clusterNeighbours.end());
  addBytes(out, lists.data(), lists.size() * sizeof(std::uint32_t));
}

}  // namespace

void addSolid(PackedMesh& out, const CollisionMesh& collisionMesh) {
  const TriMesh& mesh = collisionMesh.mesh();
  const Topology& topology = mesh.topology();
  const bool isSolid = mesh.meshClass() == MeshClass::kSolid;
  if (!isSolid && !isSheet(mesh)) return;
  out.place.flags |= isSolid ? OTG_MESH_CLOSED : OTG_MESH_SHEET;
  const Adjacency& adjacency = collisionMesh.adjacency();
  std::vector<std::uint32_t> closed, numberOf(topology.componentCount(), OTG_NOT_THERE);
  for (std::uint32_t c = 0; c < topology.componentCount(); ++c) {
    if (!topology.componentClosed[c] || adjacency.componentVertex[c] == kNone) continue;
    numberOf[c] = static_cast<std::uint32_t>(closed.size());
    closed.push_back(c);
  }
  if (numberOf.empty() || closed.size() > OTG_SOLID_MOST_PARTS || hasTwoZeros(mesh)) return;
  const bool isOne = isSolid && topology.componentCount() == 1;
  out.place.flags |= isOne ? OTG_MESH_SOLID | OTG_MESH_LISTED : OTG_MESH_LISTED;
  const std::size_t begin = out.units.size();
  out.units.push_back(unit(mesh.boundsMin(), static_cast<std::uint32_t>(mesh.vertices().size())));
  out.units.push_back(unit(mesh.boundsMax(), static_cast<std::uint32_t>(topology.edgeCount())));
  addSamples(out, mesh, adjacency, 0);
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    const auto& v = mesh.triangles()[t].v;
    const std::uint32_t* edge = topology.edgeOf.data() + 3 * std::size_t{t};
    const std::uint32_t component = topology.componentOf[t];
    const std::uint32_t part = component == kNone ? OTG_NOT_THERE : numberOf[component];
    out.units.push_back(words(topology.weld[v[0]], topology.weld[v[1]], topology.weld[v[2]], part));
    out.units.push_back(words(edge[0], edge[1], edge[2], 0));
    const Vec3d& n = adjacency.normal[t];
    const double numbers[4] = {n.x, n.y, n.z, adjacency.area[t]};
    addBytes(out, numbers, sizeof numbers);
  }
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const std::uint32_t cluster = adjacency.clusterOf[v] & ~OTG_VERTEX_FLAT;
    out.units.push_back(unit(mesh.vertices()[v], cluster | (adjacency.flatVertex[v] ? OTG_VERTEX_FLAT : 0)));
  }
  for (std::uint32_t e = 0; e < topology.edgeCount(); ++e) {
    out.units.push_back(
        words(topology.edges[e].a, topology.edges[e].b, adjacency.halfEdgeOf[e], adjacency.flatEdge[e]));
  }
  std::vector<std::uint32_t> spokes(adjacency.first.begin(), adjacency.first.end());
  spokes.insert(spokes.end(), adjacency.halfEdges.begin(), adjacency.halfEdges.end());
  const std::size_t listed = adjacency.first.size() + 3 * mesh.triangleCount();
  spokes.resize((listed + 1) / 2 * 2);
  for (const Adjacency::Spoke& spoke : adjacency.spokes) spokes.insert(spokes.end(), {spoke.vertex, spoke.edge});
  addBytes(out, spokes.data(), spokes.size() * sizeof(std::uint32_t));
  out.units[begin + OTG_SOLID_CLUSTERS_AT].w = static_cast<std::uint32_t>(out.units.size() - begin);
  out.units[begin + OTG_SOLID_CLUSTER_COUNT].w = static_cast<std::uint32_t>(adjacency.clusters.size() - 1);
  addClusters(out, adjacency);
  out.units[begin + OTG_SOLID_PARTS_AT].w = isOne ? 2 : static_cast<std::uint32_t>(out.units.size() - begin);
  out.units[begin + OTG_SOLID_PART_COUNT].w = static_cast<std::uint32_t>(closed.size());
  for (const std::uint32_t c : closed) {
    if (!isOne) addSamples(out, mesh, adjacency, c);
  }
}

}  // namespace otg::opencl
