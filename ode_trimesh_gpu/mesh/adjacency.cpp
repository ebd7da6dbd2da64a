// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/adjacency.h"

#include <cmath>
#include <numbers>

namespace otg {

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
  out.neighbour.resize(out.halfEdges.size());
  for (std::uint32_t h = 0; h < 3 * n; ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    const std::uint32_t at = cursor[originOf(h)]++;
    out.halfEdges[at] = h;
    out.neighbour[at] = originOf(h - h % 3 + (h % 3 + 1) % 3);
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
