// SPDX-License-Identifier: BSD-3-Clause
// Making convex shapes with their meshes, and keeping them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <list>
#include <map>
#include <mutex>
#include <span>

#include "base/vectors.h"
#include "primitives/convex_hull.h"
#include "primitives/convex_shape.h"

namespace otg {
namespace {

// Facets around curved shapes. They decide where an overlap is looked for, not what its contacts are.
constexpr int kCylinderSegments = 24, kCapsuleSegments = 32, kCapsuleRings = 8;
constexpr std::size_t kMostKept = 256;
constexpr double kLargest = 1e15;  // coordinates beyond take the filters of single precision to their limits

/// Looked for as it stands, without a vector of its own. Any order will do: by length, then by bytes.
using Key = std::vector<double>;
using KeyView = std::span<const double>;
struct KeyOrder {
  using is_transparent = void;
  bool operator()(const KeyView& x, const KeyView& y) const {
    if (x.size() != y.size()) return x.size() < y.size();
    return std::memcmp(x.data(), y.data(), x.size_bytes()) < 0;  // NOLINT(bugprone-suspicious-memory-comparison)
  }
};

class Cache {
 public:
  std::shared_ptr<const ConvexShape> find(const KeyView& key) {
    const std::lock_guard lock(mutex_);
    const auto it = index_.find(key);
    if (it == index_.end()) return nullptr;
    order_.splice(order_.begin(), order_, it->second);
    return it->second->second;
  }
  void store(const KeyView& key, std::shared_ptr<const ConvexShape> shape) {
    const std::lock_guard lock(mutex_);
    if (index_.find(key) != index_.end()) return;
    order_.emplace_front(Key(key.begin(), key.end()), std::move(shape));
    index_.emplace(order_.front().first, order_.begin());
    if (order_.size() > kMostKept) {
      index_.erase(order_.back().first);
      order_.pop_back();
    }
  }

 private:
  std::mutex mutex_;
  std::list<std::pair<Key, std::shared_ptr<const ConvexShape>>> order_;  ///< requested last comes first
  std::map<Key, decltype(order_)::iterator, KeyOrder> index_;
};

Cache& cache() {
  static Cache instance;
  return instance;
}

struct Arrays {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  std::uint32_t add(double x, double y, double z) {
    vertices.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  std::shared_ptr<const CollisionMesh> build() const {
    MeshInput input;
    input.vertices = vertices.data();
    input.vertexCount = vertices.size();
    input.indices = triangles.data();
    input.triangleCount = triangles.size();
    const MeshResult result = buildTriMesh(input);
    if (!result.mesh || result.mesh->meshClass() != MeshClass::kSolid) return nullptr;
    return std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah);
  }
};

/// A surface of rotation about z: rings from the lowest to the highest, each of `segments` points, between two poles.
struct Ring {
  double radius, z;
};
Arrays revolve(const std::vector<Ring>& rings, int segments, double bottom, double top) {
  Arrays out;
  const auto n = static_cast<std::uint32_t>(segments);
  for (const Ring& ring : rings) {
    for (int j = 0; j < segments; ++j) {
      const double angle = 2 * M_PI * j / segments;
      out.add(ring.radius * std::cos(angle), ring.radius * std::sin(angle), ring.z);
    }
  }
  const std::uint32_t low = out.add(0, 0, bottom), high = out.add(0, 0, top);
  const auto last = static_cast<std::uint32_t>(rings.size() - 1) * n;
  for (std::uint32_t j = 0; j < n; ++j) {
    const std::uint32_t k = (j + 1) % n;
    out.triangles.push_back({{low, k, j}});
    out.triangles.push_back({{high, last + j, last + k}});
    for (std::uint32_t row = 0; row < last; row += n) {
      out.triangles.push_back({{row + j, row + k, row + n + k}});
      out.triangles.push_back({{row + j, row + n + k, row + n + j}});
    }
  }
  return out;
}

Arrays aroundCylinder(double radius, double length) {
  const double outer = radius / std::cos(M_PI / kCylinderSegments);
  return revolve({{outer, -length}, {outer, length}}, kCylinderSegments, -length, length);
}

Arrays aroundCapsule(double radius, double length) {
  // Facets between rings of latitude have cos(half a step), along a meridian and along a parallel, of the distance to
  // the cap's middle at least.
  const double step = 0.5 * M_PI / kCapsuleRings;
  const double outer = radius / (std::cos(0.5 * step) * std::cos(M_PI / kCapsuleSegments));
  std::vector<Ring> rings;
  for (int half = 0; half < 2; ++half) {
    for (int i = 0; i < kCapsuleRings; ++i) {
      const double latitude = (half == 0 ? i + 1 - kCapsuleRings : i) * step;
      rings.push_back({outer * std::cos(latitude), outer * std::sin(latitude) + (half == 0 ? -length : length)});
    }
  }
  if (!(length > 0)) rings.erase(rings.begin() + kCapsuleRings);  // a sphere has one equator
  return revolve(rings, kCapsuleSegments, -length - outer, length + outer);
}

bool isUsable(double x) {
  return x > 0 && x < kLargest;
}

/// Directions and normals of a polyhedron from the triangles of its surface.
void describe(ConvexShape& shape, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  constexpr double kSame = 1 - 1e-10;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3d> normalOfEdge;
  for (const auto& t : triangles) {
    const Vec3d n =
        unit(otgCross(shape.vertices[t[1]] - shape.vertices[t[0]], shape.vertices[t[2]] - shape.vertices[t[0]]));
    for (std::size_t k = 0; k < 3; ++k) normalOfEdge[{t[k], t[(k + 1) % 3]}] = n;
    const bool known = std::any_of(shape.faceNormals.begin(), shape.faceNormals.end(),
                                   [&](const Vec3d& other) { return otgDot(other, n) > kSame; });
    if (known) continue;
    shape.faceNormals.push_back(n);
    shape.faceOffsets.push_back(otgDot(n, shape.support(n)));
  }
  for (const auto& [edge, n] : normalOfEdge) {
    if (edge.first > edge.second) continue;
    const auto other = normalOfEdge.find({edge.second, edge.first});
    if (other != normalOfEdge.end() && otgDot(n, other->second) > kSame) continue;
    const Vec3d d = unit(shape.vertices[edge.second] - shape.vertices[edge.first]);
    const bool known = std::any_of(shape.edgeDirections.begin(), shape.edgeDirections.end(),
                                   [&](const Vec3d& e) { return std::fabs(otgDot(e, d)) > kSame; });
    if (!known) shape.edgeDirections.push_back(d);
  }
}

/// A curved shape's mesh is around it.
void bound(ConvexShape& shape) {
  if (!shape.isCurved()) return shape.bound();
  const Vec3f &low = shape.mesh->mesh().boundsMin(), &high = shape.mesh->mesh().boundsMax();
  shape.low = {low.x, low.y, low.z};
  shape.high = {high.x, high.y, high.z};
  shape.reach = norm(shape.high);
}

/// The shape of a key: kept, or made and kept. `make` fills all but the mesh and returns the arrays of that.
template <class Make>
std::shared_ptr<const ConvexShape> keep(const KeyView& key, const Make& make) {
  if (std::shared_ptr<const ConvexShape> known = cache().find(key)) return known;
  const auto shape = std::make_shared<ConvexShape>();
  shape->mesh = make(*shape).build();
  if (!shape->mesh) return nullptr;
  bound(*shape);
  cache().store(key, shape);
  return shape;
}

std::shared_ptr<const ConvexShape> hullShape(const KeyView& key, std::span<const Vec3d> points, ConvexShape::Kind kind,
                                             const Vec3d& half) {
  if (std::shared_ptr<const ConvexShape> known = cache().find(key)) return known;
  const auto triangles = convexHull(points);
  if (triangles.empty()) return nullptr;
  return keep(key, [&](ConvexShape& shape) {
    shape.kind = kind;
    shape.half = half;
    std::vector<std::uint32_t> number(points.size(), kNone);
    std::vector<std::array<std::uint32_t, 3>> used;
    Arrays arrays;
    for (const auto& t : triangles) {
      std::array<std::uint32_t, 3>& u = used.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& p = points[t[k]];
        if (number[t[k]] == kNone) {
          number[t[k]] = arrays.add(p.x, p.y, p.z);
          shape.vertices.push_back(p);
        }
        u[k] = number[t[k]];
      }
      arrays.triangles.push_back({{u[0], u[1], u[2]}});
    }
    describe(shape, used);
    return arrays;
  });
}

}  // namespace

std::shared_ptr<const ConvexShape> boxShape(const Vec3d& half) {
  if (!isUsable(half.x) || !isUsable(half.y) || !isUsable(half.z)) return nullptr;
  std::array<Vec3d, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = {i & 4 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 1 ? half.z : -half.z};
  }
  return hullShape(std::array{0.0, half.x, half.y, half.z}, corners, ConvexShape::Kind::kBox, half);
}

std::shared_ptr<const ConvexShape> capsuleShape(double radius, double halfLength) {
  if (!isUsable(radius) || !(halfLength >= 0) || halfLength >= kLargest) return nullptr;
  return keep(std::array{1.0, radius, halfLength}, [&](ConvexShape& shape) {
    shape.kind = ConvexShape::Kind::kCapsule;
    shape.radius = radius;
    shape.length = halfLength;
    return aroundCapsule(radius, halfLength);
  });
}

std::shared_ptr<const ConvexShape> cylinderShape(double radius, double halfHeight) {
  if (!isUsable(radius) || !isUsable(halfHeight)) return nullptr;
  return keep(std::array{2.0, radius, halfHeight}, [&](ConvexShape& shape) {
    shape.kind = ConvexShape::Kind::kCylinder;
    shape.radius = radius;
    shape.length = halfHeight;
    shape.faceNormals = {{0, 0, 1}, {0, 0, -1}};
    shape.faceOffsets = {halfHeight, halfHeight};
    return aroundCylinder(radius, halfHeight);
  });
}

std::shared_ptr<const ConvexShape> polyhedronShape(std::span<const Vec3d> points) {
  Key key(1 + 3 * points.size());
  auto next = key.begin();
  *next++ = 3;
  for (const Vec3d& p : points) {
    for (const double x : {p.x, p.y, p.z}) {
      if (!(std::fabs(x) < kLargest)) return nullptr;
      *next++ = x;
    }
  }
  return hullShape(key, points, ConvexShape::Kind::kPolyhedron, {0, 0, 0});
}

}  // namespace otg
