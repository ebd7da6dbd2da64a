// SPDX-License-Identifier: BSD-3-Clause
// Welding by position, edges, twins and components, with sorting by counting instead of node-based maps.
#include "mesh/topology.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/block_sum.h"
#include "base/hash.h"
#include "base/union_find.h"
#include "mesh/measure.h"

namespace otg {

std::uint64_t hashPosition(const Vec3f& p) {  // +0 turns -0 into +0
  const std::uint64_t x = std::bit_cast<std::uint32_t>(p.x + 0.0f);
  const std::uint64_t y = std::bit_cast<std::uint32_t>(p.y + 0.0f);
  const std::uint64_t z = std::bit_cast<std::uint32_t>(p.z + 0.0f);
  return spreadBits(spreadBits(x | (y << 32)) ^ z);
}

namespace {

/// A half-edge in the bucket of its smaller end point.
struct BucketEntry {
  std::uint32_t larger;  ///< the other end point
  std::uint32_t code;    ///< twice the half-edge, plus 1 if it starts at the larger end; ascending before sorting
  std::uint32_t halfEdge() const { return code >> 1; }
};
static_assert(6 * kMaxTriangles <= 0xffffffffu, "codes of half-edges have to fit");

/// Sorts by (larger, code). Buckets hold about six entries in ordinary meshes; a hub may have any number.
void sortBucket(BucketEntry* begin, BucketEntry* end) {
  constexpr std::ptrdiff_t kInsertionLimit = 32;
  if (end - begin > kInsertionLimit) {
    std::sort(begin, end, [](const BucketEntry& a, const BucketEntry& b) {
      return a.larger != b.larger ? a.larger < b.larger : a.code < b.code;
    });
    return;
  }
  for (BucketEntry* i = begin + 1; i < end; ++i) {
    const BucketEntry entry = *i;
    BucketEntry* j = i;
    for (; j > begin && j[-1].larger > entry.larger; --j) *j = j[-1];
    *j = entry;
  }
}

/// Welded corners.
std::vector<Triangle> weldedTriangles(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  std::vector<Triangle> welded(triangles.begin(), triangles.end());
  for (Triangle& t : welded)
    for (std::uint32_t& v : t.v) v = weld[v];
  return welded;
}

bool hasThreePoints(const Triangle& t) {
  return t.v[0] != t.v[1] && t.v[1] != t.v[2] && t.v[2] != t.v[0];
}

/// The half-edges sorted by their smaller end point v: those of v are entries[offset[v]] ... entries[offset[v + 1] -
/// 1].
struct Buckets {
  std::vector<std::uint32_t> offset;
  std::vector<BucketEntry> entries;
};

Buckets fillBuckets(std::span<const Triangle> welded, std::size_t vertexCount) {
  Buckets buckets;
  // Counted two places ahead and summed, offset[v + 1] is where bucket v begins; filling advances it to where it ends.
  std::vector<std::uint32_t>& offset = buckets.offset;
  offset.assign(vertexCount + 2, 0);
  std::size_t used = 0;
  for (const Triangle& t : welded) {
    if (!hasThreePoints(t)) continue;
    ++offset[std::min(t.v[0], t.v[1]) + 2];
    ++offset[std::min(t.v[1], t.v[2]) + 2];
    ++offset[std::min(t.v[2], t.v[0]) + 2];
    used += 3;
  }
  for (std::size_t v = 1; v < offset.size(); ++v) offset[v] += offset[v - 1];
  buckets.entries.resize(used);
  std::uint32_t code = 0;
  for (const Triangle& t : welded) {
    if (!hasThreePoints(t)) {
      code += 6;
      continue;
    }
    for (const auto& [a, b] : {std::pair{t.v[0], t.v[1]}, {t.v[1], t.v[2]}, {t.v[2], t.v[0]}}) {
      buckets.entries[offset[std::min(a, b) + 1]++] = {std::max(a, b), code + (a > b)};
      code += 2;
    }
  }
  return buckets;
}

struct Pairs {
  std::vector<std::uint32_t> first;  ///< for each half-edge the smallest one of its edge
  std::vector<std::uint32_t> twin;   ///< Topology::twin
  std::size_t edgeCount = 0;
};

/// Half-edges with the same ends have one edge.
Pairs pairByEnds(std::span<const Triangle> welded, std::size_t vertexCount) {
  Buckets buckets = fillBuckets(welded, vertexCount);
  Pairs pairs;
  pairs.first.assign(3 * welded.size(), kNone);
  pairs.twin.assign(3 * welded.size(), kNone);
  // Runs of equal entries are the edges.
  for (std::size_t v = 0; v < vertexCount; ++v) {
    BucketEntry* const begin = buckets.entries.data() + buckets.offset[v];
    BucketEntry* const end = buckets.entries.data() + buckets.offset[v + 1];
    if (begin == end) continue;
    sortBucket(begin, end);
    for (BucketEntry* run = begin; run < end; ++pairs.edgeCount) {
      BucketEntry* next = run;
      for (; next < end && next->larger == run->larger; ++next) pairs.first[next->halfEdge()] = run->halfEdge();
      if (next - run == 2 && ((run[0].code ^ run[1].code) & 1) != 0) {
        pairs.twin[run[0].halfEdge()] = run[1].halfEdge();
        pairs.twin[run[1].halfEdge()] = run[0].halfEdge();
      }
      run = next;
    }
  }
  return pairs;
}

/// Fills edgeOf, twin and edges and unites the triangles of each edge.
void numberEdges(std::span<const Triangle> welded, Pairs&& pairs, Topology& topology, UnionFind& components) {
  std::vector<std::uint32_t>& edgeOf = pairs.first;
  std::vector<Topology::Edge> edges;
  edges.reserve(pairs.edgeCount);
  std::uint32_t h = 0;
  for (std::uint32_t t = 0; t < welded.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k, ++h) {
      const std::uint32_t first = edgeOf[h];
      if (first == kNone) continue;
      if (first == h) {
        const std::uint32_t a = welded[t].v[k], b = welded[t].v[k == 2 ? 0 : k + 1];
        edgeOf[h] = static_cast<std::uint32_t>(edges.size());
        edges.push_back({std::min(a, b), std::max(a, b)});
      } else {
        edgeOf[h] = edgeOf[first];  // smaller, so renumbered already
        components.unite(first / 3, t);
      }
    }
  }
  topology.edgeOf = std::move(edgeOf);
  topology.twin = std::move(pairs.twin);
  topology.edges = std::move(edges);
}

void numberComponents(std::size_t triangleCount, Topology& topology, UnionFind& components) {
  std::vector<std::uint32_t> componentOf(triangleCount, kNone);
  std::vector<std::uint8_t> closed;
  for (std::uint32_t t = 0; t < triangleCount; ++t) {
    if (topology.edgeOf[3 * t] == kNone) continue;
    const std::uint32_t root = components.find(t);  // the smallest triangle, so it has its number already
    if (root == t) {
      componentOf[t] = static_cast<std::uint32_t>(closed.size());
      closed.push_back(1);
    } else {
      componentOf[t] = componentOf[root];
    }
    for (std::uint32_t k = 0; k < 3; ++k)
      if (topology.twin[3 * t + k] == kNone) closed[componentOf[t]] = 0;
  }
  topology.componentOf = std::move(componentOf);
  topology.componentClosed = std::move(closed);
}

Topology assemble(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                  std::span<const Triangle> welded, Pairs&& pairs, std::vector<std::uint32_t>&& weld) {
  Topology topology;
  topology.weld = std::move(weld);
  UnionFind components(triangles.size());
  numberEdges(welded, std::move(pairs), topology, components);
  numberComponents(triangles.size(), topology, components);
  topology.componentVolume =
      componentVolumes(topology, vertices, triangles, middleAsFloat(boundsOf(vertices, triangles)));
  return topology;
}

}  // namespace

Topology turnedTopology(const Topology& topology) {
  // The half-edge between two corners is the first of a turned triangle where it was the last.
  const auto turned = [](std::uint32_t h) { return 3 * (h / 3) + 2 - h % 3; };
  const std::size_t halfEdges = topology.edgeOf.size();
  std::vector<std::uint32_t> edgeOf(halfEdges, kNone), twin(halfEdges, kNone), number(topology.edgeCount(), kNone);
  std::vector<Topology::Edge> edges;
  edges.reserve(topology.edgeCount());
  for (std::uint32_t h = 0; h < halfEdges; ++h) {
    const std::uint32_t edge = topology.edgeOf[turned(h)], other = topology.twin[turned(h)];
    if (other != kNone) twin[h] = turned(other);
    if (edge == kNone) continue;
    if (number[edge] == kNone) {
      number[edge] = static_cast<std::uint32_t>(edges.size());
      edges.push_back(topology.edges[edge]);
    }
    edgeOf[h] = number[edge];
  }
  Topology result;
  result.weld = topology.weld;
  result.edgeOf = std::move(edgeOf);
  result.twin = std::move(twin);
  result.edges = std::move(edges);
  result.componentOf = topology.componentOf;
  result.componentClosed = topology.componentClosed;
  return result;
}

void orientEdges(Topology& topology, std::span<const std::uint32_t> callerVertex) {
  std::vector<std::uint32_t> least(callerVertex.size(), kNone);
  for (std::size_t v = 0; v < callerVertex.size(); ++v) {
    std::uint32_t& ofPoint = least[topology.weld[v]];
    ofPoint = std::min(ofPoint, callerVertex[v]);
  }
  std::vector<Topology::Edge> edges(topology.edges.begin(), topology.edges.end());
  for (Topology::Edge& edge : edges) {
    if (least[edge.b] < least[edge.a]) std::swap(edge.a, edge.b);
  }
  topology.edges = std::move(edges);
}

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

double volume6(std::span<const Vec3f> vertices, const Triangle& triangle, const Vec3f& center) {
  const Vec3d origin{center.x, center.y, center.z};
  const Vec3d a = relativeTo(vertices[triangle.v[0]], origin);
  const Vec3d b = relativeTo(vertices[triangle.v[1]], origin);
  const Vec3d c = relativeTo(vertices[triangle.v[2]], origin);
  return otgDot(a, otgCross(b, c));
}

std::vector<double> componentVolumes(const Topology& topology, std::span<const Vec3f> vertices,
                                     std::span<const Triangle> triangles, const Vec3f& center) {
  std::vector<BlockSum> sums(topology.componentCount());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (topology.componentOf[t] != kNone) sums[topology.componentOf[t]].add(volume6(vertices, triangles[t], center));
  }
  std::vector<double> volume(sums.size());
  for (std::size_t c = 0; c < sums.size(); ++c) volume[c] = sums[c].total() / 6;
  return volume;
}

Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  return buildTopology(vertices, triangles, weldByPosition(vertices));
}

Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                       std::vector<std::uint32_t>&& weld) {
  const std::vector<Triangle> welded = weldedTriangles(triangles, weld);
  return assemble(vertices, triangles, welded, pairByEnds(welded, vertices.size()), std::move(weld));
}

Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                       std::vector<std::uint32_t>&& weld, std::vector<std::uint32_t>&& twin) {
  Pairs pairs;
  for (std::uint32_t h = 0; h < twin.size(); ++h) pairs.first.push_back(std::min(h, twin[h]));
  pairs.twin = std::move(twin);
  pairs.edgeCount = pairs.twin.size() / 2;
  return assemble(vertices, triangles, weldedTriangles(triangles, weld), std::move(pairs), std::move(weld));
}

}  // namespace otg
