// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vectors.h"
#include "mesh/triangle_area.h"

namespace otg {
namespace {

/// Normal and area; returns areaVector2(), or zero for a triangle that has none.
Vec3d measureTriangle(const TriMesh& mesh, std::uint32_t t, Adjacency& out) {
  const Vec3d c = areaVector2(mesh, t);
  const double length = norm(c);
  const bool sound = length > 0;
  out.normal[t] = sound ? c * (1 / length) : Vec3d{0, 0, 0};
  out.area[t] = sound ? length / 2 : 0;
  return sound ? c : Vec3d{0, 0, 0};
}

void addToStar(Adjacency::Star& star, const Vec3d& areaVector2) {
  star.vector = star.vector + areaVector2 * (1.0 / 6);
  star.area += norm(areaVector2) / 6;
}

/// Bounds and sums of a cluster's vertices.
void measureCluster(const TriMesh& mesh, std::uint32_t id, Adjacency& out) {
  const std::uint32_t end = out.clusters[id + 1].first;
  Adjacency::Cluster& cluster = out.clusters[id];
  cluster.lo = cluster.hi = mesh.vertices()[out.clusterVertices[cluster.first]];
  cluster.sum = {{0, 0, 0}, 0};
  cluster.moment = 0;
  for (std::uint32_t i = cluster.first; i < end; ++i) {
    const std::uint32_t v = out.clusterVertices[i];
    const Vec3f& p = mesh.vertices()[v];
    cluster.lo = {std::min(cluster.lo.x, p.x), std::min(cluster.lo.y, p.y), std::min(cluster.lo.z, p.z)};
    cluster.hi = {std::max(cluster.hi.x, p.x), std::max(cluster.hi.y, p.y), std::max(cluster.hi.z, p.z)};
    cluster.sum.vector = cluster.sum.vector + out.star[v].vector;
    cluster.sum.area += out.star[v].area;
    cluster.moment += otgDot(out.star[v].vector, Vec3d{p.x, p.y, p.z});
  }
}

/// Whether any vertex of a cluster is flat, and whether any is not.
void markCluster(std::uint32_t id, Adjacency& out) {
  Adjacency::Cluster& cluster = out.clusters[id];
  cluster.anyFlat = cluster.anyCorner = false;
  for (std::uint32_t i = cluster.first; i < out.clusters[id + 1].first; ++i) {
    (out.flatVertex[out.clusterVertices[i]] ? cluster.anyFlat : cluster.anyCorner) = true;
  }
}

/// 1 - cos of an angle would lose half the digits; the sine is the length of the cross product.
double flatSine() {
  static const double sine = std::sin(Adjacency::kFlatDegrees * std::numbers::pi / 180);
  return sine;
}

/// Adjacency::edgeKind of a half-edge's edge.
std::uint8_t kindOfEdge(const TriMesh& mesh, std::uint32_t h, const Adjacency& out) {
  const Topology& topology = mesh.topology();
  const std::uint32_t twin = topology.twin[h];
  if (twin == kNone || topology.edgeOf[h] == kNone) return 0;
  const Vec3d &a = out.normal[h / 3], &b = out.normal[twin / 3];
  const Vec3d c = otgCross(a, b);
  const double cosine = otgDot(a, b);
  if (cosine > 0 && norm(c) < flatSine()) return OTG_EDGE_FLAT;
  static const double innerCosine = std::cos(Adjacency::kInnerDegrees * std::numbers::pi / 180);
  static const double hollowCosine = std::cos(Adjacency::kHollowDegrees * std::numbers::pi / 180);
  if (cosine > hollowCosine) return 0;
  const Triangle& t = mesh.triangles()[h / 3];
  const Vec3f &p = mesh.vertices()[t.v[h % 3]], &q = mesh.vertices()[t.v[(h + 1) % 3]];
  const bool isConcave = otgDot(c, Vec3d{q.x, q.y, q.z} - Vec3d{p.x, p.y, p.z}) < 0;
  if (!isConcave) return 0;
  return cosine > innerCosine ? OTG_EDGE_HOLLOW : OTG_EDGE_INNER;
}

bool isHollow(std::uint8_t kindOfEdge) {
  return kindOfEdge == OTG_EDGE_INNER || kindOfEdge == OTG_EDGE_HOLLOW;
}

/// The sharp edges of a vertex. It lies in a flat face or on a straight edge if it has none, or two that run on.
struct SharpEdges {
  std::uint32_t count = 0;
  Vec3d direction{0, 0, 0};  ///< of the first
  bool straight = false;     ///< the second is opposite to it
  void add(const TriMesh& mesh, std::uint32_t from, std::uint32_t to) {
    const Vec3f &p = mesh.vertices()[from], &q = mesh.vertices()[to];
    const Vec3d d = Vec3d{q.x, q.y, q.z} - Vec3d{p.x, p.y, p.z};
    const double length = norm(d);
    const Vec3d away = length > 0 ? d * (1 / length) : Vec3d{0, 0, 0};
    const Vec3d c = otgCross(direction, away);
    straight = count == 1 && otgDot(direction, away) < 0 && norm(c) < flatSine();
    if (count++ == 0) direction = away;
  }
  bool flat() const { return count == 0 || straight; }
};

}  // namespace

Adjacency buildAdjacency(const TriMesh& mesh) {
  Adjacency out{mesh.adjacencyLinks(), {}, {}, {}, {}, {}, 0, 0, {}};
  const Topology& topology = mesh.topology();
  const auto triangles = mesh.triangles();
  const auto vertices = mesh.vertices();
  const auto n = static_cast<std::uint32_t>(triangles.size());

  out.normal.resize(n);
  out.area.resize(n);
  out.star.assign(vertices.size(), {{0, 0, 0}, 0});
  for (std::uint32_t t = 0; t < n; ++t) {
    const Vec3d c = measureTriangle(mesh, t, out);
    if (out.area[t] == 0) continue;
    for (const std::uint32_t corner : triangles[t].v) addToStar(out.star[topology.weld[corner]], c);
  }

  out.clusters.resize(out.clusterLists.size(), Adjacency::Cluster{});
  for (std::size_t c = 0; c < out.clusters.size(); ++c) {
    out.clusters[c].first = out.clusterLists[c].first;
    out.clusters[c].firstNeighbour = out.clusterLists[c].firstNeighbour;
  }
  for (std::uint32_t c = 0; c + 1 < out.clusters.size(); ++c) measureCluster(mesh, c, out);

  out.edgeKind.assign(topology.edgeCount(), 0);
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    if (topology.edgeOf[h] != kNone) out.edgeKind[topology.edgeOf[h]] = kindOfEdge(mesh, h, out);
  }
  out.hollowEdges = static_cast<std::size_t>(std::count_if(out.edgeKind.begin(), out.edgeKind.end(), isHollow));
  out.flatEdges = static_cast<std::size_t>(std::ranges::count(out.edgeKind, OTG_EDGE_FLAT));

  std::vector<SharpEdges> sharp(vertices.size());
  for (std::uint32_t edge = 0; edge < topology.edgeCount(); ++edge) {
    if (out.isFlatEdge(edge)) continue;
    const std::uint32_t a = topology.edges[edge].a, b = topology.edges[edge].b;
    sharp[a].add(mesh, a, b);
    sharp[b].add(mesh, b, a);
  }
  out.flatVertex.resize(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) out.flatVertex[v] = sharp[v].flat();

  for (std::uint32_t c = 0; c + 1 < out.clusters.size(); ++c) markCluster(c, out);
  return out;
}

void updateAdjacency(Adjacency& adjacency, const TriMesh& mesh, std::span<const std::uint32_t> triangles) {
  const Topology& topology = mesh.topology();
  const auto once = [](std::vector<std::uint32_t>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  };
  std::vector<std::uint32_t> points, clusters, edges;
  points.reserve(3 * triangles.size());
  for (const std::uint32_t t : triangles) {
    measureTriangle(mesh, t, adjacency);
    for (const std::uint32_t corner : mesh.triangles()[t].v) points.push_back(topology.weld[corner]);
  }
  once(points);
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (topology.edgeOf[h] == kNone) continue;
      std::uint8_t& kind = adjacency.edgeKind[topology.edgeOf[h]];
      adjacency.hollowEdges -= isHollow(kind);
      adjacency.flatEdges -= kind == OTG_EDGE_FLAT;
      kind = kindOfEdge(mesh, h, adjacency);
      adjacency.hollowEdges += isHollow(kind);
      adjacency.flatEdges += kind == OTG_EDGE_FLAT;
    }
  }
  for (const std::uint32_t v : points) {
    // Outgoing half-edges ascend, and so do their triangles: the sum has the order that building has.
    adjacency.star[v] = {{0, 0, 0}, 0};
    edges.clear();
    for (std::uint32_t i = adjacency.first[v]; i < adjacency.first[v + 1]; ++i) {
      const std::uint32_t h = adjacency.halfEdges[i], t = h / 3;
      if (adjacency.area[t] != 0) addToStar(adjacency.star[v], areaVector2(mesh, t));
      for (const std::uint32_t side : {h, h % 3 == 0 ? h + 2 : h - 1}) edges.push_back(topology.edgeOf[side]);
    }
    once(edges);
    SharpEdges sharp;
    for (const std::uint32_t edge : edges) {
      if (adjacency.isFlatEdge(edge)) continue;
      sharp.add(mesh, v, topology.edges[edge].a == v ? topology.edges[edge].b : topology.edges[edge].a);
    }
    adjacency.flatVertex[v] = sharp.flat();
    if (adjacency.clusterOf[v] != kNone) clusters.push_back(adjacency.clusterOf[v]);
  }
  once(clusters);
  for (const std::uint32_t c : clusters) {
    measureCluster(mesh, c, adjacency);
    markCluster(c, adjacency);
  }
}

}  // namespace otg
