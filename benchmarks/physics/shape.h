// SPDX-License-Identifier: BSD-3-Clause
// What a body is made of: a mesh, and ODE's own geoms that are the same body where there are any.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "scenes/generated_meshes.h"

namespace otg::physics {

using Vec = Eigen::Vector3d;
using Rotation = Eigen::Quaterniond;

/// ODE's own geom (lengths for size 1), placed in the frame of the shape.
struct NativeGeom {
  enum class Kind {
    kBox,       ///< size
    kSphere,    ///< size.x is the radius
    kCylinder,  ///< size.x is the radius, size.z the length
    kCapsule,   ///< likewise; the length is that of the axis
    kPlane,     ///< z = 0, infinite
    kTriMesh,   ///< the shape's own mesh as dTriMesh: only right against primitives
  };
  Kind kind = Kind::kBox;
  Vec size{1, 1, 1};
  Vec center{0, 0, 0};
  Rotation rotation = Rotation::Identity();
};

struct Shape {
  scenes::MeshArrays mesh;         ///< centre of mass at the origin unless the shape only ever stands still
  std::vector<NativeGeom> native;  ///< empty: there is none
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();  ///< of 1 kg about the origin, kg m^2
  double extent = 1;                                      ///< diagonal of the bounds, what depths are compared with
};

using ShapePointer = std::shared_ptr<const Shape>;

/// Moves the mesh so that its centre of mass is the origin; inertia and extent from the mesh. `shift` receives the old
/// centre of mass.
ShapePointer makeShape(scenes::MeshArrays mesh, std::vector<NativeGeom> native = {}, Vec* shift = nullptr);
/// The mesh stays where it is: for things that stand still.
ShapePointer makeStaticShape(scenes::MeshArrays mesh, std::vector<NativeGeom> native = {});

/// Box of full side lengths `size`; each side of the mesh is divided into n x n x 2 triangles.
ShapePointer boxShape(const Vec& size, int n = 1);
/// Slab with its top at z = 0, divided into n x n x 2 triangles.
ShapePointer groundShape(double size, double thickness, int n);
/// scenes::makeGear; native: the flanks of its teeth as boxes.
ShapePointer gearShape(int teeth, double pitchRadius, double toothDepth, double width, double boreRadius);

Rotation about(const Vec& axis, double degrees);

}  // namespace otg::physics
