// SPDX-License-Identifier: BSD-3-Clause
// Volume, centre of mass and inertia of the polyhedron that a mesh bounds.
#pragma once

#include <Eigen/Core>
#include <span>

#include "mesh/topology.h"
#include "shared/math/vec3.h"

namespace otg {

/// At density 1. Lengths in the mesh's units, in the mesh's own frame.
struct MassProperties {
  double volume = 0;  ///< signed: negative for inward winding
  double area = 0;
  Eigen::Vector3d centerOfMass = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre of mass
};

/// Exact integrals over the polyhedron (up to the rounding of double arithmetic). By the divergence theorem over signed
/// tetrahedra, with the centre of the bounds as the reference point. Source of the method: D. Eberly, "Polyhedral Mass
/// Properties (Revisited)", 2002; C. Zhang and T. Chen, "Efficient feature extraction for 2D/3D objects", 2001.
MassProperties computeMassProperties(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);

}  // namespace otg
