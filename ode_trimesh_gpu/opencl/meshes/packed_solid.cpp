// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/packed_solid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "collide/pair_history.h"
#include "shared/layout/solid_layout.h"

namespace otg::opencl {
namespace {

MeshUnit unit(const Vec3f& p, std::uint32_t w) {
  return {p.x, p.y, p.z, w};
}

MeshUnit words(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t w) {
  return {std::bit_cast<float>(x), std::bit_cast<float>(y), std::bit_cast<float>(z), w};
}

/// Whether a vertex and the first one of its point differ in the signs of zeros, which the CPU keeps apart.
bool hasTwoZeros(const TriMesh& mesh, std::uint32_t v) {
  using Bits = std::array<std::uint32_t, 3>;
  const auto bits = [&](std::uint32_t i) { return std::bit_cast<Bits>(mesh.vertices()[i]); };
  return bits(v) != bits(mesh.topology().weld[v]);
}
bool hasTwoZeros(const TriMesh& mesh) {
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (hasTwoZeros(mesh, v)) return true;
  }
  return false;
}

/// Bytes in whole units.
void addBytes(PackedMesh& out, const void* bytes, std::size_t size) {
  const std::size_t begin = out.units.size();
  out.units.resize(begin + (size + sizeof(MeshUnit) - 1) / sizeof(MeshUnit));
  if (size > 0) std::memcpy(out.units.data() + begin, bytes, size);
}

/// Numbers in double as units, two a unit.
template <std::size_t N>
void addNumbers(std::vector<MeshUnit>& units, const double (&numbers)[N]) {
  static_assert(N % 2 == 0 && sizeof(MeshUnit) == 2 * sizeof(double));
  units.resize(units.size() + N / 2);
  std::memcpy(units.data() + units.size() - N / 2, numbers, sizeof numbers);
}

/// The same vertices as isContained in collide/solid/inside.cpp.
void addSamples(std::vector<MeshUnit>& units, const TriMesh& mesh, const Adjacency& adjacency,
                std::uint32_t component) {
  const std::uint32_t first = adjacency.componentFirst[component];
  const std::uint32_t triangles = adjacency.componentFirst[component + 1] - first;
  const std::uint32_t samples = std::min<std::uint32_t>(triangles, OTG_SOLID_SAMPLES);
  for (std::uint32_t i = 0; i < OTG_SOLID_SAMPLES; ++i) {
    const std::uint32_t at = i < samples ? static_cast<std::uint32_t>(std::uint64_t{i} * triangles / samples) : 0;
    const std::uint32_t v = mesh.triangles()[adjacency.componentTriangles[first + at]].v[i % 3];
    units.push_back(unit(mesh.vertices()[v], samples));
  }
}

/// Normal and area: the last two of a triangle's four units.
void addNormal(std::vector<MeshUnit>& units, const Adjacency& adjacency, std::uint32_t t) {
  const Vec3d& n = adjacency.normal[t];
  addNumbers(units, {n.x, n.y, n.z, adjacency.area[t]});
}

MeshUnit vertexUnit(const TriMesh& mesh, const Adjacency& adjacency, std::uint32_t v) {
  const std::uint32_t cluster = adjacency.clusterOf[v] & ~OTG_VERTEX_FLAT;
  return unit(mesh.vertices()[v], cluster | (adjacency.flatVertex[v] ? OTG_VERTEX_FLAT : 0));
}

MeshUnit edgeUnit(const Topology& topology, const Adjacency& adjacency, std::uint32_t e) {
  return words(topology.edges[e].a, topology.edges[e].b, adjacency.halfEdgeOf[e], adjacency.edgeKind[e]);
}

void addCluster(std::vector<MeshUnit>& units, const Adjacency::Cluster& c) {
  units.push_back(unit(c.lo, c.first));
  units.push_back(unit(c.hi, c.firstNeighbour));
  addNumbers(units, {c.sum.vector.x, c.sum.vector.y, c.sum.vector.z, c.sum.area, c.moment, 0.0});
}

void addClusters(PackedMesh& out, const Adjacency& adjacency) {
  for (const Adjacency::Cluster& c : adjacency.clusters) addCluster(out.units, c);
  static_assert(sizeof(Adjacency::Star) == 4 * sizeof(double));
  addBytes(out, adjacency.star.data(), adjacency.star.size() * sizeof(Adjacency::Star));
  std::vector<std::uint32_t> lists(adjacency.clusterVertices.begin(), adjacency.clusterVertices.end());
  lists.insert(lists.end(), adjacency.clusterNeighbours.begin(), adjacency.clusterNeighbours.end());
  addBytes(out, lists.data(), lists.size() * sizeof(std::uint32_t));
}

}  // namespace

void sortUnique(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

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
  addSamples(out.units, mesh, adjacency, 0);
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    const auto& v = mesh.triangles()[t].v;
    const std::uint32_t* edge = topology.edgeOf.data() + 3 * std::size_t{t};
    const std::uint32_t component = topology.componentOf[t];
    const std::uint32_t part = component == kNone ? OTG_NOT_THERE : numberOf[component];
    out.units.push_back(words(topology.weld[v[0]], topology.weld[v[1]], topology.weld[v[2]], part));
    out.units.push_back(words(edge[0], edge[1], edge[2], mesh.callerTriangle(t)));
    addNormal(out.units, adjacency, t);
  }
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    out.units.push_back(vertexUnit(mesh, adjacency, v));
  }
  for (std::uint32_t e = 0; e < topology.edgeCount(); ++e) {
    out.units.push_back(edgeUnit(topology, adjacency, e));
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
    if (!isOne) addSamples(out.units, mesh, adjacency, c);
  }
}

bool addSolidChanges(PackedChanges& out, const CollisionMesh& collisionMesh, std::span<const std::uint32_t> triangles,
                     std::uint32_t begin, std::span<const std::uint32_t> head) {
  const TriMesh& mesh = collisionMesh.mesh();
  const Topology& topology = mesh.topology();
  const Adjacency& adjacency = collisionMesh.adjacency();
  // What is worked out again where a corner has moved: see updateAdjacency().
  std::vector<std::uint32_t> vertices, points, edges, clusters, components;
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles()[t].v[k], edge = topology.edgeOf[3 * t + k];
      if (hasTwoZeros(mesh, v)) return false;
      vertices.insert(vertices.end(), {v, topology.weld[v]});
      points.push_back(topology.weld[v]);
      if (edge != kNone) edges.push_back(edge);
    }
    if (topology.componentOf[t] != kNone) components.push_back(topology.componentOf[t]);
  }
  for (std::vector<std::uint32_t>* const numbers : {&vertices, &points, &edges, &components}) sortUnique(*numbers);
  for (const std::uint32_t v : points) {
    if (adjacency.clusterOf[v] != kNone) clusters.push_back(adjacency.clusterOf[v]);
  }
  sortUnique(clusters);

  std::vector<MeshUnit> units;
  const auto flush = [&](std::uint32_t at) {
    for (const MeshUnit& u : units) out.add(at++, u);
    units.clear();
  };
  const auto vertexCount = static_cast<std::uint32_t>(mesh.vertices().size());
  const std::uint32_t verticesAt = begin + OTG_SOLID_TRIANGLES + 4 * static_cast<std::uint32_t>(mesh.triangleCount());
  const std::uint32_t clustersAt = begin + head[OTG_SOLID_CLUSTERS_AT];
  const std::uint32_t starsAt = clustersAt + OTG_CLUSTER_UNITS * static_cast<std::uint32_t>(adjacency.clusters.size());
  out.add(begin, unit(mesh.boundsMin(), head[0]));
  out.add(begin + 1, unit(mesh.boundsMax(), head[1]));
  for (const std::uint32_t t : triangles) {
    addNormal(units, adjacency, t);
    flush(begin + OTG_SOLID_TRIANGLES + 4 * t + 2);
  }
  for (const std::uint32_t v : vertices) out.add(verticesAt + v, vertexUnit(mesh, adjacency, v));
  for (const std::uint32_t e : edges) out.add(verticesAt + vertexCount + e, edgeUnit(topology, adjacency, e));
  for (const std::uint32_t c : clusters) {
    addCluster(units, adjacency.clusters[c]);
    flush(clustersAt + OTG_CLUSTER_UNITS * c);
  }
  for (const std::uint32_t v : points) {
    const Adjacency::Star& star = adjacency.star[v];
    addNumbers(units, {star.vector.x, star.vector.y, star.vector.z, star.area});
    flush(starsAt + 2 * v);
  }
  // Samples: those of the first component lie in the head, too, where their fourth words have other meanings.
  const bool isOne = head[OTG_SOLID_PARTS_AT] == 2;
  std::uint32_t part = 0, next = 0;
  for (const std::uint32_t c : components) {
    if (c == 0) {
      addSamples(units, mesh, adjacency, 0);
      for (std::uint32_t i = 0; i < OTG_SOLID_SAMPLES; ++i) units[i].w = head[2 + i];
      flush(begin + 2);
    }
    for (; next < c; ++next) part += topology.componentClosed[next] && adjacency.componentVertex[next] != kNone;
    if (isOne || !topology.componentClosed[c] || adjacency.componentVertex[c] == kNone) continue;
    addSamples(units, mesh, adjacency, c);
    flush(begin + head[OTG_SOLID_PARTS_AT] + OTG_SOLID_SAMPLES * part);
  }
  return true;
}

}  // namespace otg::opencl
