// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/spatial_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace otg {
namespace {

/// The low 21 bits of x with two zeros between each.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

template <class T>
std::vector<T> permuted(std::span<const T> from, const std::vector<std::uint32_t>& order) {
  std::vector<T> to(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i]];
  return to;
}

}  // namespace

SpatialOrder findSpatialOrder(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  const auto center = [&](const Triangle& t, int axis) {
    double sum = 0;
    for (const std::uint32_t v : t.v) {
      const Vec3f& p = vertices[v];
      sum += double{axis == 0 ? p.x : axis == 1 ? p.y : p.z};
    }
    return sum;
  };
  const double inf = std::numeric_limits<double>::infinity();
  double lo[3] = {inf, inf, inf}, size = 0;
  for (int k = 0; k < 3; ++k) {
    double hi = -inf;
    for (const Triangle& t : triangles) {
      lo[k] = std::min(lo[k], center(t, k));
      hi = std::max(hi, center(t, k));
    }
    size = std::max(size, hi - lo[k]);
  }
  const double scale = size > 0 ? 0x1fffff / size : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key |= spread(static_cast<std::uint64_t>((center(triangles[t], k) - lo[k]) * scale)) << k;
    keys[t] = {key, t};
  }
  std::sort(keys.begin(), keys.end());

  SpatialOrder order;
  order.triangles.reserve(triangles.size());
  order.vertices.reserve(vertices.size());
  std::vector<std::uint8_t> used(vertices.size(), 0);
  for (const auto& [key, t] : keys) {
    order.triangles.push_back(t);
    for (const std::uint32_t v : triangles[t].v) {
      if (used[v]) continue;
      used[v] = 1;
      order.vertices.push_back(v);
    }
  }
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (!used[v]) order.vertices.push_back(v);
  return order;
}

std::vector<std::uint32_t> inverseOf(std::span<const std::uint32_t> order) {
  std::vector<std::uint32_t> inverse(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) inverse[order[i]] = i;
  return inverse;
}

Topology renumber(const Topology& topology, const SpatialOrder& order) {
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
