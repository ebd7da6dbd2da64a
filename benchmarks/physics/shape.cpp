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

/// The teeth of makeGear as ODE's own geoms: two boxes to a tooth, inside it, whose outer faces are its flanks and end
/// at its tip. Roots and bore are left out; nothing touches them.
std::vector<NativeGeom> flanksOfGear(int teeth, double pitchRadius, double toothDepth, double width) {
  constexpr double kAtRoot = 0.34, kAtTip = 0.14, kThickness = 0.2;  // as makeGear; thickness in tooth depths
  const double share = 2 * std::numbers::pi / teeth;
  std::vector<NativeGeom> flanks;
  for (int tooth = 0; tooth < teeth; ++tooth) {
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](double radius, double at) {
        const double angle = share * (tooth + side * at);
        return Vec(radius * std::cos(angle), radius * std::sin(angle), 0);
      };
      const Vec root = corner(pitchRadius - toothDepth / 2, kAtRoot),
                tip = corner(pitchRadius + toothDepth / 2, kAtTip);
      const Vec along = (tip - root).normalized(), outward = side * Vec(-along.y(), along.x(), 0);
      NativeGeom box;
      box.size = Vec((tip - root).norm(), kThickness * toothDepth, width);
      box.center = (root + tip) / 2 - outward * (kThickness * toothDepth / 2);
      box.rotation = about(Vec::UnitZ(), std::atan2(along.y(), along.x()) * 180 / std::numbers::pi);
      flanks.push_back(box);
    }
  }
  return flanks;
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

ShapePointer gearShape(int teeth, double pitchRadius, double toothDepth, double width, double boreRadius) {
  return makeShape(scenes::makeGear(teeth, pitchRadius, toothDepth, width, boreRadius),
                   flanksOfGear(teeth, pitchRadius, toothDepth, width));
}

Rotation about(const Vec& axis, double degrees) {
  return Rotation(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

}  // namespace otg::physics
