// SPDX-License-Identifier: BSD-3-Clause
// Bodies of the physics suite.
#include "physics/shape.h"

#include <numbers>

#include "mesh/mass_properties.h"
#include "mesh/tri_mesh.h"

namespace otg::physics {
namespace {

double extentOf(const scenes::MeshArrays& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3f& p : mesh.vertices) bounds.extend(Vec(p.x, p.y, p.z));
  return bounds.diagonal().norm();
}

Vec3d toVec3d(const Vec& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

ShapePointer makeShape(scenes::MeshArrays mesh, std::vector<NativeGeom> native, Vec* shift) {
  const Vec center = computeMassProperties(mesh.vertices, mesh.triangles).centerOfMass;
  // A centre that is only off by the rounding of the vertices stays: moving would make symmetric meshes asymmetric.
  if (center.norm() > 1e-7 * extentOf(mesh))
    mesh = scenes::transformed(mesh, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, toVec3d(-center)});
  if (shift) *shift = center;
  auto shape = std::make_shared<Shape>();
  const MassProperties mass = computeMassProperties(mesh.vertices, mesh.triangles);
  shape->inertia = mass.inertia / mass.volume;
  shape->extent = extentOf(mesh);
  shape->mesh = std::move(mesh);
  shape->native = std::move(native);
  return shape;
}

ShapePointer makeStaticShape(scenes::MeshArrays mesh, std::vector<NativeGeom> native) {
  auto shape = std::make_shared<Shape>();
  shape->extent = extentOf(mesh);
  shape->mesh = std::move(mesh);
  shape->native = std::move(native);
  return shape;
}

ShapePointer boxShape(const Vec& size, int n) {
  return makeShape(scenes::makeBox(toVec3d(size), n), {{NativeGeom::Kind::kBox, size, Vec::Zero()}});
}

ShapePointer groundShape(double size, double thickness, int n) {
  return makeStaticShape(scenes::makeGround(size, thickness, n),
                         {{NativeGeom::Kind::kBox, Vec(size, size, thickness), Vec(0, 0, -thickness / 2)}});
}

Rotation about(const Vec& axis, double degrees) {
  return Rotation(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

}  // namespace otg::physics
