// SPDX-License-Identifier: BSD-3-Clause
// Which triangles have no area, which are there twice, and where fans of triangles touch in a point.
#include "mesh/inspection.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/hash.h"
#include "base/union_find.h"
#include "shared/tests/triangle_exact.h"

namespace otg {
namespace {

/// The three points of a triangle in ascending order.
std::array<std::uint32_t, 3> sortedPoints(const Topology& topology, const Triangle& t) {
  std::array<std::uint32_t, 3> p = {topology.weld[t.v[0]], topology.weld[t.v[1]], topology.weld[t.v[2]]};
  if (p[0] > p[1]) std::swap(p[0], p[1]);
  if (p[1] > p[2]) std::swap(p[1], p[2]);
  if (p[0] > p[1]) std::swap(p[0], p[1]);
  return p;
}

std::uint32_t nextCorner(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
std::uint32_t previousCorner(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

/// For each corner (3 t + k: triangle t at its k-th vertex) one corner of its fan, the same for all of the fan.
std::vector<std::uint32_t> fansOfClosedSurface(const Topology& topology) {
  // With a twin everywhere, turning around a point from triangle to triangle comes back to the start.
  std::vector<std::uint32_t> fan(topology.twin.size(), kNone);
  for (std::uint32_t first = 0; first < fan.size(); ++first) {
    if (topology.edgeOf[first] == kNone) continue;
    for (std::uint32_t h = first; fan[h] == kNone; h = topology.twin[previousCorner(h)]) fan[h] = first;
  }
  return fan;
}

std::vector<std::uint32_t> fansOfAnySurface(const Topology& topology, std::span<const Triangle> triangles) {
  // At each end of an edge the corners of its triangles unite.
  UnionFind fans(3 * triangles.size());
  std::vector<std::uint32_t> firstUse(topology.edgeCount(), kNone);
  const auto start = [&](std::uint32_t h) { return topology.weld[triangles[h / 3].v[h % 3]]; };
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    std::uint32_t& first = firstUse[topology.edgeOf[h]];
    if (first == kNone) {
      first = h;
      continue;
    }
    const bool along = start(h) == start(first);
    fans.unite(h, along ? first : nextCorner(first));
    fans.unite(nextCorner(h), along ? nextCorner(first) : first);
  }
  std::vector<std::uint32_t> fan(topology.edgeOf.size(), kNone);
  for (std::uint32_t h = 0; h < fan.size(); ++h)
    if (topology.edgeOf[h] != kNone) fan[h] = fans.find(h);
  return fan;
}

}  // namespace

bool isDegenerateTriangle(std::span<const Vec3f> vertices, const Triangle& triangle) {
  double corners[9];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& v = vertices[triangle.v[k]];
    corners[3 * k] = v.x;
    corners[3 * k + 1] = v.y;
    corners[3 * k + 2] = v.z;
  }
  return otgIsWithoutArea(corners) != 0;
}

std::vector<std::uint8_t> findDegenerate(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  std::vector<std::uint8_t> degenerate(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) degenerate[t] = isDegenerateTriangle(vertices, triangles[t]);
  return degenerate;
}

std::vector<std::uint8_t> findDuplicates(const Topology& topology, std::span<const Triangle> triangles) {
  std::vector<std::uint8_t> duplicate(triangles.size(), 0);
  std::vector<std::uint32_t> suspects;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    // Duplicates share all edges. Where one of these has a twin, only the two triangles there can be duplicates.
    std::uint32_t h = 3 * t;
    while (h < 3 * t + 3 && topology.twin[h] == kNone) ++h;
    if (h == 3 * t + 3) {
      suspects.push_back(t);
      continue;
    }
    const std::uint32_t twin = topology.twin[h];
    if (twin / 3 < t) duplicate[t] = topology.edgeOf[previousCorner(twin)] == topology.edgeOf[nextCorner(h)];
  }
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(16, 2 * suspects.size()));
  std::vector<std::uint32_t> table(capacity, kNone);
  for (const std::uint32_t t : suspects) {
    const auto p = sortedPoints(topology, triangles[t]);
    std::size_t slot = spreadBits(spreadBits(p[0] | (std::uint64_t{p[1]} << 32)) ^ p[2]) & (capacity - 1);
    while (table[slot] != kNone && sortedPoints(topology, triangles[table[slot]]) != p)
      slot = (slot + 1) & (capacity - 1);
    if (table[slot] == kNone)
      table[slot] = t;
    else
      duplicate[t] = 1;
  }
  return duplicate;
}

std::vector<std::uint8_t> findNonManifoldVertices(const Topology& topology, std::span<const Triangle> triangles) {
  bool twinsEverywhere = true;
  for (std::size_t h = 0; h < topology.twin.size(); ++h)
    twinsEverywhere &= topology.twin[h] != kNone || topology.edgeOf[h] == kNone;
  const std::vector<std::uint32_t> fan =
      twinsEverywhere ? fansOfClosedSurface(topology) : fansOfAnySurface(topology, triangles);
  std::vector<std::uint32_t> fanAt(topology.weld.size(), kNone);
  std::vector<std::uint8_t> nonManifold(topology.weld.size(), 0);
  std::uint32_t h = 0;
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t vertex : triangle.v) {
      const std::uint32_t f = fan[h++], v = topology.weld[vertex];
      if (f == kNone) continue;
      if (fanAt[v] == kNone)
        fanAt[v] = f;
      else if (fanAt[v] != f)
        nonManifold[v] = 1;
    }
  }
  return nonManifold;
}

}  // namespace otg
