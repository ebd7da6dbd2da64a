// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/local_order.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace otg {
namespace {

constexpr std::size_t kMostLevels = 64;  ///< groups about halve from one to the next

template <class T>
std::vector<T> permuted(std::span<const T> from, const std::vector<std::uint32_t>& order) {
  std::vector<T> to(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i]];
  return to;
}

/// Groups of triangles and how many edges each shares with the others.
struct Graph {
  std::vector<std::uint32_t> size;  ///< triangles of each group
  std::vector<std::uint32_t> first{0};
  struct Link {
    std::uint32_t to, edges;
  };
  std::vector<Link> links;  ///< of group g from first[g] to first[g + 1]

  std::uint32_t count() const { return static_cast<std::uint32_t>(size.size()); }
  std::span<const Link> linksOf(std::uint32_t g) const {
    return std::span(links).subspan(first[g], first[g + 1] - first[g]);
  }
};

/// The one or two groups from which one of the next level is made.
struct Pair {
  std::uint32_t first, second;  ///< second: kNone if there is one
};

Graph graphOf(const Topology& topology, std::size_t triangleCount) {
  Graph graph;
  graph.size.assign(triangleCount, 1);
  graph.first.reserve(triangleCount + 1);
  graph.links.reserve(3 * triangleCount);
  for (std::size_t t = 0; t < triangleCount; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (const std::uint32_t twin = topology.twin[3 * t + k]; twin != kNone) graph.links.push_back({twin / 3, 1});
    }
    graph.first.push_back(static_cast<std::uint32_t>(graph.links.size()));
  }
  return graph;
}

/// Each group with the free neighbour that it shares most edges with, for their sizes.
std::vector<Pair> pairsOf(const Graph& graph) {
  std::vector<Pair> pairs;
  pairs.reserve(graph.count());
  std::vector<std::uint8_t> taken(graph.count(), 0);
  for (std::uint32_t g = 0; g < graph.count(); ++g) {
    if (taken[g]) continue;
    taken[g] = 1;
    std::uint32_t partner = kNone;
    double most = 0;
    for (const Graph::Link& link : graph.linksOf(g)) {
      if (taken[link.to]) continue;
      const double edges = link.edges, rating = edges * edges / graph.size[link.to];
      if (rating < most || (rating == most && link.to > partner)) continue;
      most = rating;
      partner = link.to;
    }
    if (partner != kNone) taken[partner] = 1;
    pairs.push_back({g, partner});
  }
  return pairs;
}

Graph merged(const Graph& graph, const std::vector<Pair>& pairs) {
  std::vector<std::uint32_t> newOf(graph.count());
  for (std::uint32_t p = 0; p < pairs.size(); ++p) {
    newOf[pairs[p].first] = p;
    if (pairs[p].second != kNone) newOf[pairs[p].second] = p;
  }
  Graph out;
  out.size.resize(pairs.size());
  out.first.reserve(pairs.size() + 1);
  out.links.reserve(graph.links.size());
  std::vector<std::uint32_t> linkTo(pairs.size(), kNone);  // the last link to each group
  for (std::uint32_t p = 0; p < pairs.size(); ++p) {
    const std::uint32_t begin = out.first.back();
    for (const std::uint32_t g : {pairs[p].first, pairs[p].second}) {
      if (g == kNone) continue;
      out.size[p] += graph.size[g];
      for (const Graph::Link& link : graph.linksOf(g)) {
        const std::uint32_t to = newOf[link.to];
        if (to == p) continue;
        if (linkTo[to] == kNone || linkTo[to] < begin) {
          linkTo[to] = static_cast<std::uint32_t>(out.links.size());
          out.links.push_back({to, 0});
        }
        out.links[linkTo[to]].edges += link.edges;
      }
    }
    out.first.push_back(static_cast<std::uint32_t>(out.links.size()));
  }
  return out;
}

}  // namespace

LocalOrder findLocalOrder(const Topology& topology, std::span<const Triangle> triangles) {
  std::vector<std::vector<Pair>> levels;
  Graph graph = graphOf(topology, triangles.size());
  while (!graph.links.empty() && levels.size() < kMostLevels) {
    levels.push_back(pairsOf(graph));
    graph = merged(graph, levels.back());
  }
  LocalOrder order;
  order.triangles.resize(levels.empty() ? triangles.size() : levels.back().size());
  std::iota(order.triangles.begin(), order.triangles.end(), 0u);
  std::vector<std::uint32_t> below;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    below.clear();
    for (const std::uint32_t p : order.triangles) {
      below.push_back((*level)[p].first);
      if ((*level)[p].second != kNone) below.push_back((*level)[p].second);
    }
    order.triangles.swap(below);
  }
  order.vertices.reserve(topology.weld.size());
  std::vector<std::uint8_t> used(topology.weld.size(), 0);
  const auto use = [&](std::uint32_t v) {
    if (!used[v]) order.vertices.push_back(v);
    used[v] = 1;
  };
  for (const std::uint32_t t : order.triangles) {
    Triangle corners = triangles[t];
    std::ranges::sort(corners.v);  // so that a mesh turned inside out has the same numbers
    std::ranges::for_each(corners.v, use);
  }
  for (std::uint32_t v = 0; v < used.size(); ++v) use(v);
  return order;
}

std::vector<std::uint32_t> inverseOf(std::span<const std::uint32_t> order) {
  std::vector<std::uint32_t> inverse(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) inverse[order[i]] = i;
  return inverse;
}

Topology renumber(const Topology& topology, const LocalOrder& order) {
  Topology out;
  const std::vector<std::uint32_t> newTriangle = inverseOf(order.triangles);
  // The smallest new number among the vertices of one point.
  std::vector<std::uint32_t> smallest(order.vertices.size(), kNone);
  std::vector<std::uint32_t> weld(order.vertices.size());
  for (std::uint32_t v = 0; v < order.vertices.size(); ++v) {
    std::uint32_t& first = smallest[topology.weld[order.vertices[v]]];
    first = std::min(first, v);
    weld[v] = first;
  }
  std::vector<std::uint32_t> newEdge(topology.edgeCount(), kNone), newComponent(topology.componentCount(), kNone);
  std::vector<std::uint32_t> components;
  std::vector<std::uint32_t> edgeOf(topology.edgeOf.size()), twins(topology.twin.size());
  std::vector<std::uint32_t> componentOf(topology.componentOf.size());
  std::vector<Topology::Edge> edges;
  edges.reserve(topology.edgeCount());
  for (std::uint32_t t = 0; t < order.triangles.size(); ++t) {
    const std::uint32_t old = order.triangles[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t edge = topology.edgeOf[3 * old + k], twin = topology.twin[3 * old + k];
      twins[3 * t + k] = twin == kNone ? kNone : 3 * newTriangle[twin / 3] + twin % 3;
      if (edge == kNone) {
        edgeOf[3 * t + k] = kNone;
        continue;
      }
      if (newEdge[edge] == kNone) {
        newEdge[edge] = static_cast<std::uint32_t>(edges.size());
        // In the direction that they had: whose numbers come first does not depend on places.
        edges.push_back({smallest[topology.edges[edge].a], smallest[topology.edges[edge].b]});
      }
      edgeOf[3 * t + k] = newEdge[edge];
    }
    const std::uint32_t component = topology.componentOf[old];
    if (component != kNone && newComponent[component] == kNone) {
      newComponent[component] = static_cast<std::uint32_t>(components.size());
      components.push_back(component);
    }
    componentOf[t] = component == kNone ? kNone : newComponent[component];
  }
  out.weld = std::move(weld);
  out.edgeOf = std::move(edgeOf);
  out.twin = std::move(twins);
  out.edges = std::move(edges);
  out.componentOf = std::move(componentOf);
  out.componentClosed = permuted(std::span<const std::uint8_t>(topology.componentClosed), components);
  out.componentVolume = permuted(std::span<const double>(topology.componentVolume), components);
  return out;
}

}  // namespace otg
