// SPDX-License-Identifier: BSD-3-Clause
// Mass and visible surface of a body of a scene.
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"

namespace otg::scenes {
namespace {

void meshMass(const BodyDescription& body, dMass& mass, Vec3d& center) {
  const TriMesh& mesh = *body.mesh;
  const MassProperties& properties = mesh.massProperties();
  if (mesh.meshClass() == MeshClass::kSolid && properties.volume > 0) {
    const double density = body.mass ? *body.mass / properties.volume : body.density;
    const Eigen::Matrix3d inertia = density * properties.inertia;
    center = {properties.centerOfMass.x(), properties.centerOfMass.y(), properties.centerOfMass.z()};
    dMassSetParameters(&mass, density * properties.volume, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2),
                       inertia(0, 1), inertia(0, 2), inertia(1, 2));
    return;
  }
  const Vec3f lo = mesh.boundsMin(), hi = mesh.boundsMax();
  center = {0.5 * (double(lo.x) + hi.x), 0.5 * (double(lo.y) + hi.y), 0.5 * (double(lo.z) + hi.z)};
  const Vec3d size{double(hi.x) - lo.x, double(hi.y) - lo.y, double(hi.z) - lo.z};
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) {
    throw SceneError("body '" + body.name + "': a flat mesh has no mass; make the body static or thicker");
  }
  if (body.mass)
    dMassSetBoxTotal(&mass, *body.mass, size.x, size.y, size.z);
  else
    dMassSetBox(&mass, body.density, size.x, size.y, size.z);
}

}  // namespace

void bodyMass(const BodyDescription& body, dMass& mass, Vec3d& center) {
  center = {0, 0, 0};
  dMassSetZero(&mass);
  if (body.collider != Collider::kPrimitive) {
    meshMass(body, mass, center);
  } else {
    const Vec3d& s = body.size;
    constexpr int kAlongZ = 3;
    if (body.shape == ShapeKind::kBox)
      dMassSetBox(&mass, body.density, s.x, s.y, s.z);
    else if (body.shape == ShapeKind::kSphere)
      dMassSetSphere(&mass, body.density, s.x);
    else if (body.shape == ShapeKind::kCylinder)
      dMassSetCylinder(&mass, body.density, kAlongZ, s.x, s.y);
    else
      dMassSetCapsule(&mass, body.density, kAlongZ, s.x, s.y);
    if (body.mass) dMassAdjust(&mass, *body.mass);
  }
  // dBodySetMass aborts on a mass that is not positive or whose inertia is not positive definite.
  if (!(mass.mass > 0) || !dMassCheck(&mass)) {
    throw SceneError("body '" + body.name + "': its volume and density make no positive mass and inertia");
  }
}

std::shared_ptr<const TriMesh> surfaceOf(const BodyDescription& body) {
  if (body.mesh) return body.mesh;
  if (body.heights) return build(sheetOf(*body.heights));
  const Vec3d& s = body.size;
  if (body.shape == ShapeKind::kBox) return build(makeBox(s));
  if (body.shape == ShapeKind::kSphere) return build(makeSphere(s.x, 3));
  if (body.shape == ShapeKind::kCylinder) return build(makeCylinder(s.x, s.y, 32));
  Transformd up{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0.5 * s.y}}, down = up;
  down.t.z = -0.5 * s.y;
  const MeshArrays ball = makeSphere(s.x, 3);
  return build(merge({makeCylinder(s.x, s.y, 32), transformed(ball, up), transformed(ball, down)}));
}

}  // namespace otg::scenes
