// SPDX-License-Identifier: BSD-3-Clause
// Welding, dropping and orienting, in this order: each step sees the result of the one before.
#include "mesh/repair.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "base/bounds.h"
#include "mesh/containment.h"
#include "mesh/inspection.h"

namespace otg {
namespace {

void say(RepairReport& report, std::size_t count, const char* one, const char* many) {
  if (count > 0) report.messages.push_back(std::to_string(count) + " " + (count == 1 ? one : many));
}

void weldVertices(std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles,
                  std::vector<std::uint32_t>& inputVertexOf, RepairReport& report) {
  const std::vector<std::uint32_t> weld = weldByPosition(vertices);
  std::vector<std::uint32_t> newNumber(vertices.size()), kept;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    if (weld[v] == v) {
      newNumber[v] = static_cast<std::uint32_t>(kept.size());
      vertices[kept.size()] = vertices[v];
      kept.push_back(v);
    } else {
      newNumber[v] = newNumber[weld[v]];
    }
  }
  report.weldedVertices = vertices.size() - kept.size();
  if (report.weldedVertices == 0) return;
  vertices.resize(kept.size());
  for (Triangle& triangle : triangles)
    for (std::uint32_t& v : triangle.v) v = newNumber[v];
  inputVertexOf = std::move(kept);
  say(report, report.weldedVertices, "vertex was merged into an earlier one at the same position.",
      "vertices were merged into earlier ones at the same position.");
}

/// Removes flagged triangles, returns how many.
std::size_t drop(std::vector<Triangle>& triangles, const std::vector<std::uint8_t>& flags) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!flags[t]) triangles[kept++] = triangles[t];
  const std::size_t dropped = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

/// The two half-edges of each edge that is used exactly twice, in whatever directions; kNone for other edges.
struct HalfEdgePair {
  std::uint32_t first = kNone, second = kNone;
  std::uint32_t other(std::uint32_t h) const { return first == h ? second : first; }
};

std::vector<HalfEdgePair> pairHalfEdges(const Topology& topology) {
  std::vector<HalfEdgePair> pairs(topology.edgeCount());
  std::vector<std::uint8_t> uses(topology.edgeCount(), 0);
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    HalfEdgePair& pair = pairs[topology.edgeOf[h]];
    std::uint8_t& count = uses[topology.edgeOf[h]];
    if (count == 0) pair.first = h;
    if (count == 1) pair.second = h;
    count = std::min<std::uint8_t>(count + 1, 3);
  }
  for (std::size_t e = 0; e < pairs.size(); ++e)
    if (uses[e] != 2) pairs[e] = {};
  return pairs;
}

/// Zero-area triangles whose longest edge (from p to q) has one neighbour (p, q, d) hide that the middle vertex c lies
/// on that edge: without them the surface would be open there. The neighbour is split at c instead, (p, c, d) and (c,
/// q, d), which does not move the surface. One pass; returns how many, because others may become possible
/// after it.
std::size_t splitNeighboursOnce(const std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles) {
  const std::vector<std::uint8_t> degenerate = findDegenerate(vertices, triangles);
  if (std::find(degenerate.begin(), degenerate.end(), 1) == degenerate.end()) return 0;
  const Topology topology = buildTopology(vertices, triangles);
  const std::vector<HalfEdgePair> pairs = pairHalfEdges(topology);
  const auto edgeKey = [&](std::uint32_t a, std::uint32_t b) {
    a = topology.weld[a];
    b = topology.weld[b];
    return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  };
  std::unordered_set<std::uint64_t> edges;
  for (const Topology::Edge& e : topology.edges) edges.insert(edgeKey(e.a, e.b));

  std::vector<std::uint8_t> touched(triangles.size(), 0);
  std::size_t split = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!degenerate[t] || touched[t] || topology.edgeOf[3 * t] == kNone) continue;
    std::uint32_t longest = 0;
    double longest2 = -1;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3f &a = vertices[triangles[t].v[k]], &b = vertices[triangles[t].v[(k + 1) % 3]];
      const Vec3d d = relativeTo(a, {b.x, b.y, b.z});
      if (otgDot(d, d) > longest2) {
        longest2 = otgDot(d, d);
        longest = k;
      }
    }
    const std::uint32_t across = pairs[topology.edgeOf[3 * t + longest]].other(3 * t + longest);
    if (across == kNone || touched[across / 3]) continue;
    const std::uint32_t(&neighbour)[3] = triangles[across / 3].v;
    const std::uint32_t c = triangles[t].v[(longest + 2) % 3];
    const std::uint32_t p = neighbour[across % 3], q = neighbour[(across + 1) % 3], d = neighbour[(across + 2) % 3];
    const Triangle halves[2] = {{{p, c, d}}, {{c, q, d}}};
    const std::vector<std::uint8_t> bad = findDegenerate(vertices, halves);
    if (bad[0] || bad[1] || !edges.insert(edgeKey(c, d)).second) continue;
    touched[t] = touched[across / 3] = 1;
    triangles[t] = halves[0];
    triangles[across / 3] = halves[1];
    ++split;
  }
  return split;
}

void dropDegenerate(const std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles, RepairReport& report) {
  // Each pass leaves fewer zero-area triangles. Stacks of them take a pass per layer; what is left after many is
  // dropped.
  constexpr int kMaxPasses = 64;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const std::size_t split = splitNeighboursOnce(vertices, triangles);
    if (split == 0) break;
    report.splitDegenerate += split;
  }
  say(report, report.splitDegenerate, "zero-area triangle was removed by splitting its neighbour.",
      "zero-area triangles were removed by splitting their neighbours.");
  report.droppedDegenerate = drop(triangles, findDegenerate(vertices, triangles));
  say(report, report.droppedDegenerate, "zero-area triangle was dropped.", "zero-area triangles were dropped.");
}

/// Makes neighbours agree across edges with two triangles. Within each patch that hangs together through such edges the
/// smaller part is flipped. One flag for each triangle.
std::vector<std::uint8_t> agreeWithNeighbours(const std::vector<Triangle>& triangles, const Topology& topology) {
  const std::vector<HalfEdgePair> pairs = pairHalfEdges(topology);
  std::vector<std::uint8_t> flip(triangles.size(), 0), seen(triangles.size(), 0);
  std::vector<std::uint32_t> patch;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (seen[seed]) continue;
    patch.assign(1, seed);
    seen[seed] = 1;
    std::size_t flipped = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const std::uint32_t t = patch[i];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (topology.edgeOf[h] == kNone) continue;
        const std::uint32_t across = pairs[topology.edgeOf[h]].other(h);
        if (across == kNone) continue;
        const std::uint32_t other = across / 3;
        if (seen[other]) continue;
        seen[other] = 1;
        const bool disagree = topology.twin[h] == kNone;
        flip[other] = flip[t] != static_cast<std::uint8_t>(disagree);
        flipped += flip[other];
        patch.push_back(other);
      }
    }
    if (2 * flipped > patch.size())
      for (const std::uint32_t t : patch) flip[t] ^= 1;
  }
  return flip;
}

void applyFlips(std::vector<Triangle>& triangles, const std::vector<std::uint8_t>& flip) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (flip[t]) std::swap(triangles[t].v[1], triangles[t].v[2]);
}

void orient(std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles, RepairReport& report) {
  std::vector<std::uint8_t> flip = agreeWithNeighbours(triangles, buildTopology(vertices, triangles));
  applyFlips(triangles, flip);
  // Now whole components: which way is outward is known only for closed ones.
  const Topology topology = buildTopology(vertices, triangles);
  const std::vector<std::uint32_t> depths = nestingDepths(topology, vertices, triangles);
  std::vector<std::uint8_t> turn(triangles.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t c = topology.componentOf[t];
    turn[t] =
        c != kNone && topology.componentClosed[c] && expectedVolumeSign(depths[c]) * topology.componentVolume[c] < 0;
    flip[t] ^= turn[t];
  }
  applyFlips(triangles, turn);
  report.flippedTriangles = static_cast<std::size_t>(std::count(flip.begin(), flip.end(), 1));
  say(report, report.flippedTriangles, "triangle was flipped.", "triangles were flipped.");
}

}  // namespace

void repairMesh(const RepairOptions& options, std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles,
                std::vector<std::uint32_t>& inputVertexOf, RepairReport& report) {
  if (options.weldVertices) weldVertices(vertices, triangles, inputVertexOf, report);
  if (options.dropDegenerate) dropDegenerate(vertices, triangles, report);
  if (options.dropDuplicates) {
    report.droppedDuplicates = drop(triangles, findDuplicates(buildTopology(vertices, triangles), triangles));
    say(report, report.droppedDuplicates, "duplicate triangle was dropped.", "duplicate triangles were dropped.");
  }
  if (options.orientConsistently) orient(vertices, triangles, report);
}

}  // namespace otg
