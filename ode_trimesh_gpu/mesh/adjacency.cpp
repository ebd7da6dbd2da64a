// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/adjacency.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace otg {
namespace {

/// Breadth first from each vertex that is left, in order: with vertices sorted in space the sets come out compact.
void gatherClusters(const TriMesh& mesh, Adjacency& out) {
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices().size());
  out.clusterOf.assign(vertices, kNone);
  out.clusterVertices.reserve(vertices);
  std::vector<std::uint32_t>& members = out.clusterVertices;
  for (std::uint32_t seed = 0; seed < vertices; ++seed) {
    if (out.clusterOf[seed] != kNone || out.first[seed] == out.first[seed + 1]) continue;
    const auto id = static_cast<std::uint32_t>(out.clusters.size());
    const auto begin = static_cast<std::uint32_t>(members.size());
    Adjacency::Cluster cluster{mesh.vertices()[seed], mesh.vertices()[seed], begin, 0, {{0, 0, 0}, 0}, 0, false, false};
    members.push_back(seed);
    out.clusterOf[seed] = id;
    for (std::size_t i = begin; i < members.size(); ++i) {
      const std::uint32_t v = members[i];
      const Vec3f& p = mesh.vertices()[v];
      cluster.lo = {std::min(cluster.lo.x, p.x), std::min(cluster.lo.y, p.y), std::min(cluster.lo.z, p.z)};
      cluster.hi = {std::max(cluster.hi.x, p.x), std::max(cluster.hi.y, p.y), std::max(cluster.hi.z, p.z)};
      cluster.sum.vector = otgAdd(cluster.sum.vector, out.star[v].vector);
      cluster.sum.area += out.star[v].area;
      cluster.moment += otgDot(out.star[v].vector, Vec3d{p.x, p.y, p.z});
      for (std::uint32_t h = out.first[v]; h < out.first[v + 1]; ++h) {
        const std::uint32_t w = out.spokes[h].vertex;
        if (members.size() - begin == Adjacency::kClusterSize) break;
        if (out.clusterOf[w] != kNone || out.first[w] == out.first[w + 1]) continue;
        out.clusterOf[w] = id;
        members.push_back(w);
      }
    }
    out.clusters.push_back(cluster);
  }
  Adjacency::Cluster end{};
  end.first = static_cast<std::uint32_t>(members.size());
  out.clusters.push_back(end);
  std::vector<std::uint32_t> seen(out.clusters.size(), kNone);
  for (std::uint32_t c = 0; c + 1 < out.clusters.size(); ++c) {
    out.clusters[c].firstNeighbour = static_cast<std::uint32_t>(out.clusterNeighbours.size());
    seen[c] = c;
    for (std::uint32_t i = out.clusters[c].first; i < out.clusters[c + 1].first; ++i) {
      for (std::uint32_t h = out.first[members[i]]; h < out.first[members[i] + 1]; ++h) {
        const std::uint32_t d = out.clusterOf[out.spokes[h].vertex];
        if (d == kNone || seen[d] == c) continue;
        seen[d] = c;
        out.clusterNeighbours.push_back(d);
      }
    }
  }
  out.clusters.back().firstNeighbour = static_cast<std::uint32_t>(out.clusterNeighbours.size());
}

}  // namespace

Adjacency buildAdjacency(const TriMesh& mesh) {
  Adjacency out;
  const Topology& topology = mesh.topology();
  const auto triangles = mesh.triangles();
  const auto vertices = mesh.vertices();
  const auto n = static_cast<std::uint32_t>(triangles.size());

  out.first.assign(vertices.size() + 1, 0);
  const auto originOf = [&](std::uint32_t h) { return topology.weld[triangles[h / 3].v[h % 3]]; };
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    if (topology.edgeOf[h] != kNone) ++out.first[originOf(h) + 1];
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) out.first[v + 1] += out.first[v];
  out.halfEdges.resize(out.first.back());
  std::vector<std::uint32_t> cursor(out.first.begin(), out.first.end() - 1);
  out.spokes.resize(out.halfEdges.size());
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    const std::uint32_t at = cursor[originOf(h)]++;
    out.halfEdges[at] = h;
    out.spokes[at] = {originOf(h - h % 3 + (h % 3 + 1) % 3), topology.edgeOf[h]};
  }

  out.halfEdgeOf.resize(topology.edgeCount());
  for (std::uint32_t h = 3 * n; h-- > 0;) {
    if (topology.edgeOf[h] != kNone) out.halfEdgeOf[topology.edgeOf[h]] = h;
  }

  out.normal.resize(n);
  out.area.resize(n);
  out.star.assign(vertices.size(), {{0, 0, 0}, 0});
  for (std::uint32_t t = 0; t < n; ++t) {
    Vec3d p[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3f& v = vertices[triangles[t].v[k]];
      p[k] = {v.x, v.y, v.z};
    }
    const Vec3d c = otgCross(otgSub(p[1], p[0]), otgSub(p[2], p[0]));
    const double length = std::sqrt(otgDot(c, c));
    const bool sound = length > 0 && !mesh.isDegenerate(t);
    out.normal[t] = sound ? otgScale(c, 1 / length) : Vec3d{0, 0, 0};
    out.area[t] = sound ? length / 2 : 0;
    if (!sound) continue;
    for (const std::uint32_t corner : triangles[t].v) {
      Adjacency::Star& star = out.star[topology.weld[corner]];
      star.vector = otgAdd(star.vector, otgScale(c, 1.0 / 6));
      star.area += length / 6;
    }
  }

  gatherClusters(mesh, out);

  // 1 - cos of the angle would lose half the digits; the sine is the length of the cross product.
  const double flatSine = std::sin(Adjacency::kFlatDegrees * std::numbers::pi / 180);
  out.flatEdge.assign(topology.edgeCount(), 0);
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    const std::uint32_t twin = topology.twin[h];
    if (twin == kNone || topology.edgeOf[h] == kNone) continue;
    const Vec3d &a = out.normal[h / 3], &b = out.normal[twin / 3];
    const Vec3d c = otgCross(a, b);
    if (otgDot(a, b) > 0 && std::sqrt(otgDot(c, c)) < flatSine) out.flatEdge[topology.edgeOf[h]] = 1;
  }

  // Each vertex with its sharp edges: none, or two that run on straight.
  struct Sharp {
    std::uint32_t count = 0;
    Vec3d direction{0, 0, 0};  // of the first
    bool straight = false;     // the second is opposite to it
  };
  std::vector<Sharp> sharp(vertices.size());
  for (std::uint32_t edge = 0; edge < topology.edgeCount(); ++edge) {
    if (out.flatEdge[edge]) continue;
    const std::uint32_t a = topology.edges[edge].a, b = topology.edges[edge].b;
    const Vec3d d =
        otgSub(Vec3d{vertices[b].x, vertices[b].y, vertices[b].z}, Vec3d{vertices[a].x, vertices[a].y, vertices[a].z});
    const double length = std::sqrt(otgDot(d, d));
    const Vec3d along = length > 0 ? otgScale(d, 1 / length) : Vec3d{0, 0, 0};
    for (const std::uint32_t v : {a, b}) {
      Sharp& s = sharp[v];
      const Vec3d away = v == a ? along : otgScale(along, -1.0);
      const Vec3d c = otgCross(s.direction, away);
      s.straight = s.count == 1 && otgDot(s.direction, away) < 0 && std::sqrt(otgDot(c, c)) < flatSine;
      if (s.count++ == 0) s.direction = away;
    }
  }
  out.flatVertex.resize(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) out.flatVertex[v] = sharp[v].count == 0 || sharp[v].straight;

  for (std::size_t c = 0; c + 1 < out.clusters.size(); ++c) {
    for (std::uint32_t i = out.clusters[c].first; i < out.clusters[c + 1].first; ++i) {
      (out.flatVertex[out.clusterVertices[i]] ? out.clusters[c].anyFlat : out.clusters[c].anyCorner) = true;
    }
  }

  const std::size_t components = topology.componentCount();
  out.componentVertex.assign(components, kNone);
  out.componentFirst.assign(components + 1, 0);
  for (std::uint32_t t = 0; t < n; ++t) {
    if (topology.componentOf[t] == kNone) continue;
    ++out.componentFirst[topology.componentOf[t] + 1];
  }
  for (std::size_t c = 0; c < components; ++c) out.componentFirst[c + 1] += out.componentFirst[c];
  out.componentTriangles.resize(out.componentFirst.back());
  cursor.assign(out.componentFirst.begin(), out.componentFirst.end() - 1);
  for (std::uint32_t t = 0; t < n; ++t) {
    const std::uint32_t c = topology.componentOf[t];
    if (c == kNone) continue;
    out.componentTriangles[cursor[c]++] = t;
    if (out.componentVertex[c] == kNone) out.componentVertex[c] = topology.weld[triangles[t].v[0]];
  }
  return out;
}

}  // namespace otg
