// SPDX-License-Identifier: BSD-3-Clause
// Welding, dropping and orienting, in this order: each step sees the result of the one before.
#include "mesh/repair.h"

#include <algorithm>
#include <utility>

#include "mesh/bounds.h"
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

/// Removes flagged triangles, answers how many.
std::size_t drop(std::vector<Triangle>& triangles, const std::vector<std::uint8_t>& flags) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (!flags[t]) triangles[kept++] = triangles[t];
  const std::size_t dropped = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

/// Makes neighbours agree across edges with two triangles. Within each patch that hangs together through such edges the
/// smaller part is flipped. One flag for each triangle.
std::vector<std::uint8_t> agreeWithNeighbours(const std::vector<Triangle>& triangles, const Topology& topology) {
  // The two half-edges of each edge with exactly two uses.
  struct Pair {
    std::uint32_t first = kNone, second = kNone;
    bool manifold = true;
  };
  std::vector<Pair> pairs(topology.edgeCount());
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    Pair& pair = pairs[topology.edgeOf[h]];
    if (pair.first == kNone)
      pair.first = h;
    else if (pair.second == kNone)
      pair.second = h;
    else
      pair.manifold = false;
  }
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
        const Pair& pair = pairs[topology.edgeOf[h]];
        if (!pair.manifold || pair.second == kNone) continue;
        const std::uint32_t other = (pair.first == h ? pair.second : pair.first) / 3;
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
  if (options.dropDegenerate) {
    const Vec3d middle = boundsOf(vertices, triangles).middle();
    const Vec3f center{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)};
    report.droppedDegenerate = drop(triangles, findDegenerate(vertices, triangles, center));
    say(report, report.droppedDegenerate, "zero-area triangle was dropped.", "zero-area triangles were dropped.");
  }
  if (options.dropDuplicates) {
    report.droppedDuplicates = drop(triangles, findDuplicates(buildTopology(vertices, triangles), triangles));
    say(report, report.droppedDuplicates, "duplicate triangle was dropped.", "duplicate triangles were dropped.");
  }
  if (options.orientConsistently) orient(vertices, triangles, report);
}

}  // namespace otg
