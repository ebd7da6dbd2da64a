// SPDX-License-Identifier: BSD-3-Clause
// ConvexPatch for regions of very many triangles: a plane for each, and only what lies around the best is searched.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "primitives/convex_patch.h"

namespace otg {
namespace {

constexpr std::size_t kMostTriangles = 4096;  // more take longer than they are worth
constexpr std::size_t kSampledPoints = 48;    // that are compared with every plane
constexpr std::size_t kBestFaces = 24;        // whose edges and corners are tried
constexpr double kLargeTriangle = 0.25;       // of the region's diagonal

Vec3d vertexOf(const TriMesh& mesh, std::uint32_t v) {
  const Vec3f& p = mesh.vertices()[v];
  return {p.x, p.y, p.z};
}

}  // namespace

bool ConvexPatch::readDense(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                            const PlacedShape& shape) {
  const bool isCounted = region.cellBegin == region.cellEnd && region.pieceEnd - region.pieceBegin <= kMostPieces;
  if (isCounted) return false;
  planes_.clear();
  edges_.clear();
  triangles_.clear();
  vertices_.clear();
  origin_ = all.origin;
  tolerance_ = toleranceOf(meshes, region);
  dense_ = &meshes.tree(0);
  const TriMesh& mesh = dense_->mesh();
  Transformd frame{{1, 0, 0, 0, 1, 0, 0, 0, 1}, origin_ + (region.lo + region.hi) * 0.5};
  searchWide(dense_->wide(), BoxQuery(*dense_, frame, (region.hi - region.lo) * 0.5), [&](std::uint32_t t) {
    if (mesh.isDegenerate(t) || triangles_.size() > kMostTriangles) return;
    Vec3d p[3];
    bool isInside = false;
    double longest = 0;
    for (int k = 0; k < 3; ++k) p[k] = vertexOf(mesh, mesh.triangles()[t].v[k]) - origin_;
    for (int k = 0; k < 3; ++k) {
      isInside = isInside || shape.exitDistance(p[k], {0, 0, 1}) >= 0;
      longest = std::max(longest, norm(p[(k + 1) % 3] - p[k]));
    }
    if (isInside || longest > kLargeTriangle * region.diagonal) triangles_.push_back(t);
  });
  if (triangles_.empty() || triangles_.size() > kMostTriangles) {
    dense_ = nullptr;
    return false;
  }
  std::sort(triangles_.begin(), triangles_.end());
  for (const std::uint32_t t : triangles_) {
    const Vec3d& n = dense_->adjacency().normal[t];
    planes_.push_back({n, otgDot(n, vertexOf(mesh, mesh.triangles()[t].v[0]) - origin_)});
    for (const std::uint32_t v : mesh.triangles()[t].v) vertices_.push_back(mesh.topology().weld[v]);
  }
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  anyTriangle_ = triangles_.front();
  if (isConvexDense()) return true;
  dense_ = nullptr;
  return false;
}

/// Its number among the patch's, or kNone.
std::uint32_t ConvexPatch::keptNumber(std::uint32_t triangle) const {
  const auto it = std::lower_bound(triangles_.begin(), triangles_.end(), triangle);
  return it == triangles_.end() || *it != triangle ? kNone : static_cast<std::uint32_t>(it - triangles_.begin());
}

/// Along all edges, and for points spread over the patch.
bool ConvexPatch::isConvexDense() const {
  const TriMesh& mesh = dense_->mesh();
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (std::uint32_t half = 3 * triangles_[i]; half < 3 * triangles_[i] + 3; ++half) {
      const std::uint32_t twin = mesh.topology().twin[half];
      if (twin == kNone || twin < half || keptNumber(twin / 3) == kNone) continue;
      const Vec3d opposite = vertexOf(mesh, mesh.triangles()[twin / 3].v[(twin + 2) % 3]) - origin_;
      if (otgDot(planes_[i].normal, opposite) > planes_[i].offset + tolerance_) return false;
    }
  }
  const std::size_t stride = std::max<std::size_t>(1, vertices_.size() / kSampledPoints);
  for (std::size_t k = 0; k < vertices_.size(); k += stride) {
    const Vec3d p = vertexOf(mesh, vertices_[k]) - origin_;
    for (const Plane& plane : planes_) {
      if (otgDot(plane.normal, p) > plane.offset + tolerance_) return false;
    }
  }
  return true;
}

/// Whether all triangles of the vertex are the patch's.
bool ConvexPatch::isWhole(std::uint32_t vertex) const {
  const Adjacency& adjacency = dense_->adjacency();
  for (std::uint32_t i = adjacency.first[vertex]; i < adjacency.first[vertex + 1]; ++i) {
    if (keptNumber(adjacency.halfEdges[i] / 3) == kNone) return false;
  }
  return true;
}

/// Whether the patch is nowhere farther along d than at the vertex: no neighbour of it is, and the patch is convex.
bool ConvexPatch::isSupport(std::uint32_t vertex, const Vec3d& d) const {
  const Adjacency& adjacency = dense_->adjacency();
  const Vec3d p = vertexOf(dense_->mesh(), vertex);
  for (std::uint32_t i = adjacency.first[vertex]; i < adjacency.first[vertex + 1]; ++i) {
    const Vec3d way = vertexOf(dense_->mesh(), adjacency.spokes[i].vertex) - p;
    if (otgDot(way, d) > 1e-9 * norm(way)) return false;
  }
  return isWhole(vertex);
}

/// The edges and corners of a triangle.
void ConvexPatch::tryAround(const PlacedShape& shape, std::uint32_t number, const Vec3d& out, WayOut& best) const {
  const TriMesh& mesh = dense_->mesh();
  const std::uint32_t t = triangles_[number];
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.topology().weld[mesh.triangles()[t].v[k]];
    const Vec3d a = vertexOf(mesh, v) - origin_;
    const std::uint32_t twin = mesh.topology().twin[3 * t + k];
    const std::uint32_t other = twin == kNone ? kNone : keptNumber(twin / 3);
    if (other != kNone && otgDot(planes_[number].normal, planes_[other].normal) < kFlatEdge) {
      const Vec3d b = vertexOf(mesh, mesh.triangles()[t].v[(k + 1) % 3]) - origin_;
      tryEdge(shape, {a, unit(b - a), planes_[number].normal, planes_[other].normal}, best);
    }
    if (!shape.shape().isCurved()) continue;
    const Vec3d d = wayToRoundSide(shape, a);
    if (otgDot(d, d) > 0 && otgDot(d, out) >= 0 && isSupport(v, d)) offer(shape, d, otgDot(d, a), 1.0, best);
  }
}

WayOut ConvexPatch::leaveDense(const PlacedShape& shape, const Vec3d& out) const {
  WayOut best;
  best.depth = std::numeric_limits<double>::infinity();
  std::pmr::vector<std::pair<double, std::uint32_t>> ways(memory_);
  for (std::uint32_t i = 0; i < planes_.size(); ++i) {
    const Plane& plane = planes_[i];
    if (!(otgDot(plane.normal, out) >= 0)) continue;
    ways.emplace_back(plane.offset - shape.rearAlong(plane.normal), i);
    offer(shape, plane.normal, plane.offset, 1.0, best);
  }
  for (const Vec3d& local : shape.shape().faceNormals) {
    const Vec3d d = shape.direction(local) * -1.0;
    if (!(otgDot(d, out) >= 0)) continue;
    std::uint32_t farthest = vertices_.front();
    double height = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : vertices_) {
      const double h = otgDot(d, vertexOf(dense_->mesh(), v) - origin_);
      if (h > height) {
        height = h;
        farthest = v;
      }
    }
    if (isSupport(farthest, d)) offer(shape, d, height, 1.0, best);
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(ways.size(), kBestFaces));
  std::partial_sort(ways.begin(), ways.begin() + count, ways.end());
  for (auto it = ways.begin(); it != ways.begin() + count; ++it) tryAround(shape, it->second, out, best);
  return best;
}

}  // namespace otg
