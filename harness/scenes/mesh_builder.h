// SPDX-License-Identifier: BSD-3-Clause
// A helper for writing meshes by formula: triangles by their corners, welded at the end.
#pragma once

#include "scenes/mesh_arrays.h"

namespace otg::scenes {

/// Collects triangles and quads given by positions. Corners whose formulas give the same float position become one
/// vertex, so neighbouring patches only have to use the same expression for a shared point.
class MeshBuilder {
 public:
  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
  /// a, b, c, d in order around the quad, counter-clockwise seen from outside; split along a-c.
  void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  MeshArrays finish() const;

 private:
  std::vector<Vec3f> corners_;
};

/// Calls point(ring, segment) for a surface of `rings` + 1 closed rings of `segments` points each and joins
/// neighbouring rings. Outside is where ring x segment direction points.
template <class Point>
void addTube(MeshBuilder& builder, int rings, int segments, const Point& point) {
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < segments; ++j) {
      const int k = (j + 1) % segments;
      builder.quad(point(i, j), point(i + 1, j), point(i + 1, k), point(i, k));
    }
  }
}

/// A disc that closes a ring of points towards +normal; `point(j)` runs counter-clockwise seen from outside.
template <class Point>
void addFan(MeshBuilder& builder, const Vec3d& center, int segments, const Point& point) {
  for (int j = 0; j < segments; ++j) builder.triangle(center, point(j), point((j + 1) % segments));
}

}  // namespace otg::scenes
