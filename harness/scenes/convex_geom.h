// SPDX-License-Identifier: BSD-3-Clause
// A dConvex of ODE's, made of a convex mesh.
#pragma once

#include <ode/ode.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "base/vectors.h"
#include "scenes/generated_meshes.h"
#include "shared/math/vec3.h"

namespace otg::scenes {

/// ODE keeps pointers to these arrays: they have to outlive the geoms that are made of them. Each triangle is a polygon
/// of its own.
class ConvexData {
 public:
  explicit ConvexData(const MeshArrays& mesh) {
    for (const Vec3f& v : mesh.vertices)
      points_.insert(points_.end(), {static_cast<dReal>(v.x), static_cast<dReal>(v.y), static_cast<dReal>(v.z)});
    for (const Triangle& t : mesh.triangles) {
      const auto corner = [&](int k) {
        const Vec3f& v = mesh.vertices[t.v[k]];
        return Vec3d{v.x, v.y, v.z};
      };
      const Vec3d n = otgCross(corner(1) - corner(0), corner(2) - corner(0));
      const Vec3d unit = n * (1 / norm(n));
      for (const double x : {unit.x, unit.y, unit.z, otgDot(unit, corner(0))}) {
        planes_.push_back(static_cast<dReal>(x));
      }
      polygons_.insert(polygons_.end(), {3, t.v[0], t.v[1], t.v[2]});
    }
  }
  ConvexData(const ConvexData&) = delete;
  ConvexData& operator=(const ConvexData&) = delete;
  dGeomID makeGeom(dSpaceID space) const {
    return dCreateConvex(space, planes_.data(), static_cast<unsigned>(planes_.size() / 4), points_.data(),
                         static_cast<unsigned>(points_.size() / 3), polygons_.data());
  }

  /// Its corners, three numbers each. ODE does not notice when they are changed in place.
  dReal* points() { return points_.data(); }

 private:
  std::vector<dReal> planes_, points_;
  std::vector<unsigned int> polygons_;
};

}  // namespace otg::scenes
