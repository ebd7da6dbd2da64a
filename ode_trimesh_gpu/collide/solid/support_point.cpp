// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/support_point.h"

#include <algorithm>

#include "base/vectors.h"

namespace otg {
namespace {

/// A half-edge as the caller numbers triangles: it does not depend on how the mesh was sorted.
std::uint32_t halfEdgeOfCaller(const TriMesh& mesh, std::uint32_t half) {
  return 3 * mesh.callerTriangle(half / 3) + half % 3;
}

}  // namespace

std::uint32_t rankOfVertex(const PlacedMeshes& meshes, int mesh, std::uint32_t vertex) {
  const Adjacency& adjacency = meshes.adjacency(mesh);
  std::uint32_t rank = kNone;
  for (std::uint32_t h = adjacency.first[vertex]; h < adjacency.first[vertex + 1]; ++h) {
    rank = std::min(rank, halfEdgeOfCaller(meshes.mesh(mesh), adjacency.halfEdges[h]));
  }
  return rank;
}

SupportPoint supportPoint(const PlacedMeshes& meshes, const Contour& contour, const PointSeed& seed) {
  const bool isCrossing = seed.kind == PointKind::kCrossing;
  return supportPoint(meshes, seed, isCrossing ? contour.crossings[seed.crossing].triangle : kNone);
}

SupportPoint supportPoint(const PlacedMeshes& meshes, const PointSeed& seed, std::uint32_t triangle) {
  const int m = seed.mesh;
  const TriMesh& mesh = meshes.mesh(m);
  const Adjacency& adjacency = meshes.adjacency(m);
  SupportPoint p{};
  p.position = seed.position;
  p.region = seed.region;
  p.mesh = seed.mesh;
  p.kind = seed.kind;
  p.feature = seed.feature;
  p.ordinal = seed.ordinal;
  p.flat = seed.flat;
  p.reach = norm(seed.span);
  p.along = unit(seed.span);
  p.triangleA = p.triangleB = kNone;
  p.rank = kNone;
  std::uint32_t& own = m == 0 ? p.triangleA : p.triangleB;
  Vec3d normal{0, 0, 0};
  if (seed.kind == PointKind::kVertex) {
    for (std::uint32_t h = adjacency.first[seed.feature]; h < adjacency.first[seed.feature + 1]; ++h) {
      normal = normal + adjacency.normal[adjacency.halfEdges[h] / 3];
      p.rank = std::min(p.rank, halfEdgeOfCaller(mesh, adjacency.halfEdges[h]));
    }
    own = adjacency.halfEdges[adjacency.first[seed.feature]] / 3;
  } else {
    const std::uint32_t half = adjacency.halfEdgeOf[seed.feature];
    normal = adjacency.normal[half / 3];
    const std::uint32_t twin = mesh.topology().twin[half];
    p.rank = halfEdgeOfCaller(mesh, half);
    if (twin != kNone) {
      normal = normal + adjacency.normal[twin / 3];
      p.rank = std::min(p.rank, halfEdgeOfCaller(mesh, twin));
    }
    own = half / 3;
  }
  p.surfaceNormal = meshes.directionFromLocal(m, unit(normal));
  if (seed.kind == PointKind::kCrossing) {
    (m == 0 ? p.triangleB : p.triangleA) = triangle;
    p.faceNormal = meshes.normal(1 - m, triangle);
  }
  return p;
}

ContactFeature featureOf(const SupportPoint& p) {
  switch (p.kind) {
    case PointKind::kVertex:
      return p.mesh == 0 ? ContactFeature::kVertexA : ContactFeature::kVertexB;
    case PointKind::kCrossing:
      return p.mesh == 0 ? ContactFeature::kCrossingA : ContactFeature::kCrossingB;
    default:
      return p.mesh == 0 ? ContactFeature::kMiddleA : ContactFeature::kMiddleB;
  }
}

}  // namespace otg
