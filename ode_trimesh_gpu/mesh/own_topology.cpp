// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/own_topology.h"

#include <algorithm>
#include <array>

namespace otg {
namespace {

bool isIdentity(std::span<const std::uint32_t> weld) {
  for (std::uint32_t v = 0; v < weld.size(); ++v) {
    if (weld[v] != v) return false;
  }
  return true;
}

/// Whether some vertices that triangles use lie at the same place, and three triangles or more meet at each: a quick no
/// for triangles without neighbours.
bool mayTouchItself(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  std::vector<std::uint32_t> uses(weld.size(), 0), users(weld.size(), 0);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t.v) ++uses[v];
  }
  for (std::uint32_t v = 0; v < weld.size(); ++v) users[weld[v]] += uses[v] != 0;
  return std::all_of(uses.begin(), uses.end(), [](std::uint32_t count) { return count == 0 || count > 2; }) &&
         std::any_of(users.begin(), users.end(), [](std::uint32_t count) { return count > 1; });
}

/// Whether two triangles have the same points in the same turn, or one has a point twice.
bool hasDoubledTriangles(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  std::vector<std::array<std::uint32_t, 3>> points;
  points.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    std::array<std::uint32_t, 3> p{weld[t.v[0]], weld[t.v[1]], weld[t.v[2]]};
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) return true;
    std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
    points.push_back(p);
  }
  std::sort(points.begin(), points.end());
  return std::adjacent_find(points.begin(), points.end()) != points.end();
}

}  // namespace

std::optional<Topology> ownTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                    std::span<const std::uint32_t> weld) {
  if (triangles.empty() || isIdentity(weld) || !mayTouchItself(triangles, weld)) return {};
  std::vector<std::uint32_t> each(vertices.size());
  for (std::uint32_t v = 0; v < each.size(); ++v) each[v] = v;
  Topology own = buildTopology(vertices, triangles, std::move(each));
  if (std::find(own.twin.begin(), own.twin.end(), kNone) != own.twin.end()) return {};
  if (hasDoubledTriangles(triangles, weld)) return {};
  return own;
}

}  // namespace otg
