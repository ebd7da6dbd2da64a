// SPDX-License-Identifier: BSD-3-Clause
#include "queries/local_minimum.h"

#include <cmath>

#include "base/vectors.h"

namespace otg {
namespace {

Vec3d vertexOf(const TriMesh& mesh, std::uint32_t v) {
  const Vec3f& p = mesh.vertices()[v];
  return {p.x, p.y, p.z};
}

/// How much a surface may rise towards the centre, squared and times the squared distance.
double riseTolerance(const Vec3d& toCenter, double rounding) {
  return 2 * rounding * norm(toCenter);
}

/// Whether a surface that goes on from a point towards another one comes no nearer to the centre.
bool leadsAway(const Vec3d& from, const Vec3d& to, const Vec3d& toCenter, double tolerance) {
  const Vec3d along = to - from;
  const double rise = otgDot(along, toCenter);
  return rise <= 0 || rise * rise <= tolerance * otgDot(along, along);
}

}  // namespace

bool isMinimumOfEdge(const CollisionMesh& tree, std::uint32_t halfEdge, const Vec3d& point, const Vec3d& toCenter,
                     double rounding) {
  const TriMesh& mesh = tree.mesh();
  const Topology& topology = mesh.topology();
  const double tolerance = riseTolerance(toCenter, rounding);
  const auto leads = [&](std::uint32_t half) {
    return leadsAway(point, vertexOf(mesh, mesh.triangles()[half / 3].v[(half + 2) % 3]), toCenter, tolerance);
  };
  if (!leads(halfEdge)) return false;
  const std::uint32_t twin = topology.twin[halfEdge];
  if (twin != kNone) return leads(twin);
  if (mesh.report().nonManifoldEdges == 0 && mesh.report().inconsistentEdges == 0) return true;  // a rim
  // Any number of triangles may share it.
  const Adjacency& adjacency = tree.adjacency();
  const std::uint32_t edge = topology.edgeOf[halfEdge], v = topology.edges[edge].a;
  for (std::uint32_t i = adjacency.first[v]; i < adjacency.first[v + 1]; ++i) {
    const std::uint32_t first = adjacency.halfEdges[i] - adjacency.halfEdges[i] % 3;
    for (std::uint32_t half = first; half < first + 3; ++half) {
      if (topology.edgeOf[half] == edge && !leads(half)) return false;
    }
  }
  return true;
}

bool isMinimumOfVertex(const CollisionMesh& tree, std::uint32_t vertex, const Vec3d& toCenter, double rounding) {
  const TriMesh& mesh = tree.mesh();
  const Adjacency& adjacency = tree.adjacency();
  const Vec3d point = vertexOf(mesh, vertex);
  const double tolerance = riseTolerance(toCenter, rounding);
  for (std::uint32_t i = adjacency.first[vertex]; i < adjacency.first[vertex + 1]; ++i) {
    // The directions of a triangle at its corner lie between its two edges there.
    const std::uint32_t half = adjacency.halfEdges[i];
    const Triangle& t = mesh.triangles()[half / 3];
    for (const std::uint32_t step : {1u, 2u}) {
      if (!leadsAway(point, vertexOf(mesh, t.v[(half + step) % 3]), toCenter, tolerance)) return false;
    }
  }
  return true;
}

bool isMinimum(const CollisionMesh& tree, const SurfacePoint& p, const Vec3d& center, double rounding) {
  if (p.part == TrianglePart::kFace) return true;
  const Vec3d toCenter = center - p.point;
  const auto number = static_cast<std::uint32_t>(p.part);
  if (p.part <= TrianglePart::kEdge2) {
    const std::uint32_t k = number - static_cast<std::uint32_t>(TrianglePart::kEdge0);
    return isMinimumOfEdge(tree, 3 * p.triangle + k, p.point, toCenter, rounding);
  }
  const std::uint32_t k = number - static_cast<std::uint32_t>(TrianglePart::kCorner0);
  const TriMesh& mesh = tree.mesh();
  return isMinimumOfVertex(tree, mesh.topology().weld[mesh.triangles()[p.triangle].v[k]], toCenter, rounding);
}

}  // namespace otg
