// SPDX-License-Identifier: BSD-3-Clause
// Welding by position, edges, twins and components, with sorting by counting instead of node-based maps.
#include "mesh/topology.h"

#include <algorithm>
#include <bit>

#include "mesh/bounds.h"
#include "mesh/union_find.h"

namespace otg {
namespace {

/// Mixes the bits of a position. Adding +0 turns -0 into +0, so equal positions get equal hashes.
std::uint64_t hashPosition(const Vec3f& p) {
  const std::uint64_t x = std::bit_cast<std::uint32_t>(p.x + 0.0f);
  const std::uint64_t y = std::bit_cast<std::uint32_t>(p.y + 0.0f);
  const std::uint64_t z = std::bit_cast<std::uint32_t>(p.z + 0.0f);
  std::uint64_t h = (x | (y << 32)) * 0x9e3779b97f4a7c15ull;
  h = (h ^ (h >> 32) ^ z) * 0xd6e8feb86659fd93ull;
  return h ^ (h >> 32);
}

/// A half-edge in the bucket of its smaller end point.
struct BucketEntry {
  std::uint32_t larger;    // the other end point
  std::uint32_t halfEdge;  // ascending within a bucket before it is sorted
};

/// Sorts by (larger, halfEdge). Buckets hold about six entries in ordinary meshes; a hub may have any number.
void sortBucket(BucketEntry* begin, BucketEntry* end) {
  constexpr std::ptrdiff_t kInsertionLimit = 32;
  if (end - begin > kInsertionLimit) {
    std::sort(begin, end, [](const BucketEntry& a, const BucketEntry& b) {
      return a.larger != b.larger ? a.larger < b.larger : a.halfEdge < b.halfEdge;
    });
    return;
  }
  for (BucketEntry* i = begin + (begin == end ? 0 : 1); i < end; ++i) {
    const BucketEntry entry = *i;
    BucketEntry* j = i;
    for (; j > begin && j[-1].larger > entry.larger; --j) *j = j[-1];
    *j = entry;
  }
}

/// Welded start and end points of every half-edge, and whether its triangle has three distinct points.
struct WeldedTriangle {
  std::uint32_t v[3];
  bool proper() const { return v[0] != v[1] && v[1] != v[2] && v[2] != v[0]; }
};

WeldedTriangle welded(const Triangle& t, const std::vector<std::uint32_t>& weld) {
  return {{weld[t.v[0]], weld[t.v[1]], weld[t.v[2]]}};
}

void buildEdges(std::span<const Triangle> triangles, Topology& topology, UnionFind& components) {
  const std::vector<std::uint32_t>& weld = topology.weld;
  const auto halfEdgeEnds = [&](std::uint32_t h) {
    const Triangle& t = triangles[h / 3];
    const std::uint32_t k = h % 3;
    return Topology::Edge{weld[t.v[k]], weld[t.v[k == 2 ? 0 : k + 1]]};
  };

  // Counting sort of the half-edges by their smaller end point.
  std::vector<std::uint32_t> offset(weld.size() + 1, 0);
  std::size_t used = 0;
  for (const Triangle& t : triangles) {
    const WeldedTriangle w = welded(t, weld);
    if (!w.proper()) continue;
    for (int k = 0; k < 3; ++k) ++offset[std::min(w.v[k], w.v[(k + 1) % 3]) + 1];
    used += 3;
  }
  for (std::size_t v = 1; v < offset.size(); ++v) offset[v] += offset[v - 1];
  std::vector<BucketEntry> entries(used);
  {
    std::vector<std::uint32_t> next(offset.begin(), offset.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const WeldedTriangle w = welded(triangles[t], weld);
      if (!w.proper()) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = w.v[k], b = w.v[(k + 1) % 3];
        entries[next[std::min(a, b)]++] = {std::max(a, b), 3 * t + k};
      }
    }
  }

  // Runs of equal entries are the edges. edgeOf first names the smallest half-edge of the run.
  topology.edgeOf.assign(3 * triangles.size(), kNone);
  topology.twin.assign(3 * triangles.size(), kNone);
  std::size_t edgeCount = 0;
  for (std::size_t v = 0; v < weld.size(); ++v) {
    BucketEntry* const begin = entries.data() + offset[v];
    BucketEntry* const end = entries.data() + offset[v + 1];
    sortBucket(begin, end);
    for (BucketEntry* run = begin; run < end;) {
      BucketEntry* next = run;
      for (; next < end && next->larger == run->larger; ++next) {
        topology.edgeOf[next->halfEdge] = run->halfEdge;
        components.unite(run->halfEdge / 3, next->halfEdge / 3);
      }
      if (next - run == 2 && halfEdgeEnds(run[0].halfEdge).a != halfEdgeEnds(run[1].halfEdge).a) {
        topology.twin[run[0].halfEdge] = run[1].halfEdge;
        topology.twin[run[1].halfEdge] = run[0].halfEdge;
      }
      ++edgeCount;
      run = next;
    }
  }
  topology.edges.reserve(edgeCount);
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    const std::uint32_t first = topology.edgeOf[h];
    if (first == kNone) continue;
    if (first != h) {
      topology.edgeOf[h] = topology.edgeOf[first];
      continue;
    }
    const Topology::Edge ends = halfEdgeEnds(h);
    topology.edgeOf[h] = static_cast<std::uint32_t>(topology.edges.size());
    topology.edges.push_back({std::min(ends.a, ends.b), std::max(ends.a, ends.b)});
  }
}

void numberComponents(std::size_t triangleCount, Topology& topology, UnionFind& components) {
  topology.componentOf.assign(triangleCount, kNone);
  for (std::uint32_t t = 0; t < triangleCount; ++t) {
    if (topology.edgeOf[3 * t] == kNone) continue;
    const std::uint32_t root = components.find(t);  // the smallest triangle, so it has its number already
    if (root == t) {
      topology.componentOf[t] = static_cast<std::uint32_t>(topology.componentClosed.size());
      topology.componentClosed.push_back(1);
    } else {
      topology.componentOf[t] = topology.componentOf[root];
    }
    for (std::uint32_t k = 0; k < 3; ++k)
      if (topology.twin[3 * t + k] == kNone) topology.componentClosed[topology.componentOf[t]] = 0;
  }
}

}  // namespace

std::vector<std::uint32_t> weldByPosition(std::span<const Vec3f> vertices) {
  std::vector<std::uint32_t> weld(vertices.size());
  // Open addressing at most half full. Vertices enter in ascending order, so a slot holds the smallest one.
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(16, 2 * vertices.size()));
  std::vector<std::uint32_t> table(capacity, kNone);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    std::size_t slot = hashPosition(vertices[i]) & (capacity - 1);
    while (table[slot] != kNone && vertices[table[slot]] != vertices[i]) slot = (slot + 1) & (capacity - 1);
    if (table[slot] == kNone) table[slot] = i;
    weld[i] = table[slot];
  }
  return weld;
}

std::vector<double> componentVolumes(const Topology& topology, std::span<const Vec3f> vertices,
                                     std::span<const Triangle> triangles) {
  std::vector<double> volume(topology.componentCount(), 0.0);
  const Vec3d center = boundsOf(vertices, triangles).middle();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (topology.componentOf[t] == kNone) continue;
    const Vec3d a = relativeTo(vertices[triangles[t].v[0]], center);
    const Vec3d b = relativeTo(vertices[triangles[t].v[1]], center);
    const Vec3d c = relativeTo(vertices[triangles[t].v[2]], center);
    volume[topology.componentOf[t]] += otgDot(a, otgCross(b, c));
  }
  for (double& v : volume) v /= 6;
  return volume;
}

Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  Topology topology;
  topology.weld = weldByPosition(vertices);
  UnionFind components(triangles.size());
  buildEdges(triangles, topology, components);
  numberComponents(triangles.size(), topology, components);
  topology.componentVolume = componentVolumes(topology, vertices, triangles);
  return topology;
}

}  // namespace otg
