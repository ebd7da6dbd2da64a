// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/adjacency_links.h"

#include <utility>
#include <vector>

namespace otg {
namespace {

/// Breadth first from each vertex that is left, in order: with vertices sorted for locality the sets come out compact.
void gatherClusters(std::uint32_t vertices, AdjacencyLinks& out) {
  std::vector<AdjacencyLinks::ClusterLists> lists;
  std::vector<std::uint32_t> clusterOf(vertices, kNone), members, neighbours;
  members.reserve(vertices);
  for (std::uint32_t seed = 0; seed < vertices; ++seed) {
    if (clusterOf[seed] != kNone || out.first[seed] == out.first[seed + 1]) continue;
    const auto id = static_cast<std::uint32_t>(lists.size());
    const auto begin = static_cast<std::uint32_t>(members.size());
    lists.push_back({begin, 0});
    members.push_back(seed);
    clusterOf[seed] = id;
    for (std::size_t i = begin; i < members.size(); ++i) {
      for (std::uint32_t h = out.first[members[i]]; h < out.first[members[i] + 1]; ++h) {
        const std::uint32_t w = out.spokes[h].vertex;
        if (members.size() - begin == AdjacencyLinks::kClusterSize) break;
        if (clusterOf[w] != kNone || out.first[w] == out.first[w + 1]) continue;
        clusterOf[w] = id;
        members.push_back(w);
      }
    }
  }
  lists.push_back({static_cast<std::uint32_t>(members.size()), 0});
  std::vector<std::uint32_t> seen(lists.size(), kNone);
  for (std::uint32_t c = 0; c + 1 < lists.size(); ++c) {
    lists[c].firstNeighbour = static_cast<std::uint32_t>(neighbours.size());
    seen[c] = c;
    for (std::uint32_t i = lists[c].first; i < lists[c + 1].first; ++i) {
      for (std::uint32_t h = out.first[members[i]]; h < out.first[members[i] + 1]; ++h) {
        const std::uint32_t d = clusterOf[out.spokes[h].vertex];
        if (d == kNone || seen[d] == c) continue;
        seen[d] = c;
        neighbours.push_back(d);
      }
    }
  }
  lists.back().firstNeighbour = static_cast<std::uint32_t>(neighbours.size());
  members.shrink_to_fit();
  neighbours.shrink_to_fit();
  lists.shrink_to_fit();
  out.clusterLists = std::move(lists);
  out.clusterOf = std::move(clusterOf);
  out.clusterVertices = std::move(members);
  out.clusterNeighbours = std::move(neighbours);
}

}  // namespace

AdjacencyLinks buildAdjacencyLinks(std::span<const Triangle> triangles, const Topology& topology) {
  AdjacencyLinks out;
  const auto vertices = static_cast<std::uint32_t>(topology.weld.size());
  const auto n = static_cast<std::uint32_t>(triangles.size());

  std::vector<std::uint32_t> first(std::size_t{vertices} + 1, 0);
  const auto originOf = [&](std::uint32_t h) { return topology.weld[triangles[h / 3].v[h % 3]]; };
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    if (topology.edgeOf[h] != kNone) ++first[originOf(h) + 1];
  }
  for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  std::vector<std::uint32_t> halfEdges(first.back());
  std::vector<std::uint32_t> cursor(first.begin(), first.end() - 1);
  std::vector<AdjacencyLinks::Spoke> spokes(halfEdges.size());
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    const std::uint32_t at = cursor[originOf(h)]++;
    halfEdges[at] = h;
    spokes[at] = {originOf(h - h % 3 + (h % 3 + 1) % 3), topology.edgeOf[h]};
  }
  std::vector<std::uint32_t> halfEdgeOf(topology.edgeCount());
  for (std::uint32_t h = 3 * n; h-- > 0;) {
    if (topology.edgeOf[h] != kNone) halfEdgeOf[topology.edgeOf[h]] = h;
  }
  out.first = std::move(first);
  out.halfEdges = std::move(halfEdges);
  out.spokes = std::move(spokes);
  out.halfEdgeOf = std::move(halfEdgeOf);
  gatherClusters(vertices, out);

  const std::size_t components = topology.componentCount();
  std::vector<std::uint32_t> componentVertex(components, kNone), componentFirst(components + 1, 0);
  for (std::uint32_t t = 0; t < n; ++t) {
    if (topology.componentOf[t] == kNone) continue;
    ++componentFirst[topology.componentOf[t] + 1];
  }
  for (std::size_t c = 0; c < components; ++c) componentFirst[c + 1] += componentFirst[c];
  std::vector<std::uint32_t> componentTriangles(componentFirst.back());
  cursor.assign(componentFirst.begin(), componentFirst.end() - 1);
  for (std::uint32_t t = 0; t < n; ++t) {
    const std::uint32_t c = topology.componentOf[t];
    if (c == kNone) continue;
    componentTriangles[cursor[c]++] = t;
    if (componentVertex[c] == kNone) componentVertex[c] = topology.weld[triangles[t].v[0]];
  }
  out.componentVertex = std::move(componentVertex);
  out.componentFirst = std::move(componentFirst);
  out.componentTriangles = std::move(componentTriangles);
  return out;
}

}  // namespace otg
