// SPDX-License-Identifier: BSD-3-Clause
// Fills ODE's dMass from the exact integrals of a mesh.
#include "ode_trimesh_gpu/mass.h"

#include <ode/collision.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "ode/base/status.h"
#include "ode/data/mesh_data.h"
#include "ode/geom/geom_class.h"

namespace otg {
namespace {

/// In the mesh's own frame. `m` is written only if the status is not negative.
int massOfMesh(dMass* m, dReal density, const CollisionMesh* mesh) {
  if (m == nullptr || !std::isfinite(density) || density <= 0) return dGPUTRIMESH_ERROR_ARGUMENT;
  if (mesh == nullptr) return dGPUTRIMESH_ERROR_MASS;
  const MassProperties& from = mesh->mesh().massProperties();
  const double mass = static_cast<double>(density) * from.volume;
  if (!(from.volume > 0) || !std::isfinite(mass)) return dGPUTRIMESH_ERROR_MASS;
  // A signed sum over an open mesh may come out as anything; dBodySetMass aborts on what is not positive definite.
  const Eigen::Matrix3d central = static_cast<double>(density) * from.inertia;
  if (!central.allFinite() || Eigen::LLT<Eigen::Matrix3d>(central).info() != Eigen::Success) {
    return dGPUTRIMESH_ERROR_MASS;
  }
  // dMass has the inertia about the origin of the frame, not about the centre of mass.
  const Eigen::Vector3d& c = from.centerOfMass;
  const Eigen::Matrix3d about =
      central + mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose()).eval();
  const auto real = [](double x) { return static_cast<dReal>(x); };
  dMass result;
  dMassSetParameters(&result, real(mass), real(c.x()), real(c.y()), real(c.z()), real(about(0, 0)), real(about(1, 1)),
                     real(about(2, 2)), real(about(0, 1)), real(about(0, 2)), real(about(1, 2)));
  *m = result;
  return mesh->mesh().meshClass() == MeshClass::kSolid ? dGPUTRIMESH_OK : dGPUTRIMESH_NOT_SOLID;
}

int massOfData(dMass* m, dReal density, dGpuTriMeshDataID data) {
  const UseHold use(&data->uses);
  return use.good() ? massOfMesh(m, density, data->mesh()) : dGPUTRIMESH_ERROR_BUSY;
}

/// In the frame of the geom's body, or of the world if it has none.
int massOfGeom(dMass* m, dReal density, dGeomID g) {
  GeomObject* const object = liveObjectOf(g);
  if (object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
  const GeomUse use(object);
  if (!use.good()) return dGPUTRIMESH_ERROR_BUSY;
  dMass own;
  const int status = massOfMesh(m == nullptr ? nullptr : &own, density, object->mesh());
  if (status < 0) return status;
  const bool onBody = dGeomGetBody(g) != nullptr;
  const dReal* const x = onBody ? dGeomGetOffsetPosition(g) : dGeomGetPosition(g);
  const dReal* const r = onBody ? dGeomGetOffsetRotation(g) : dGeomGetRotation(g);
  for (int i = 0; i < 12; ++i) {
    if (i % 4 != 3 && !std::isfinite(r[i])) return dGPUTRIMESH_ERROR_MASS;
    if (i < 3 && !std::isfinite(x[i])) return dGPUTRIMESH_ERROR_MASS;
  }
  dMassRotate(&own, r);
  dMassTranslate(&own, x[0], x[1], x[2]);
  *m = own;
  return status;
}

/// Scales what `fill` makes at density 1.
template <class Fill>
int totalMass(dMass* m, dReal total, Fill fill) {
  if (m == nullptr || !std::isfinite(total) || total <= 0) return dGPUTRIMESH_ERROR_ARGUMENT;
  dMass unit;
  const int status = fill(&unit);
  if (status < 0) return status;
  dMassAdjust(&unit, total);
  *m = unit;
  return status;
}

}  // namespace
}  // namespace otg

int dMassSetGpuTriMeshData(dMass* m, dReal density, dGpuTriMeshDataID data) {
  if (!dxGpuTriMeshData::isLive(data)) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  return otg::noteStatus(otg::massOfData(m, density, data));
}

int dMassSetGpuTriMeshDataTotal(dMass* m, dReal total_mass, dGpuTriMeshDataID data) {
  if (!dxGpuTriMeshData::isLive(data)) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  return otg::noteStatus(otg::totalMass(m, total_mass, [&](dMass* unit) { return otg::massOfData(unit, 1, data); }));
}

int dMassSetGpuTriMesh(dMass* m, dReal density, dGeomID g) {
  return otg::noteStatus(otg::massOfGeom(m, density, g));
}

int dMassSetGpuTriMeshTotal(dMass* m, dReal total_mass, dGeomID g) {
  return otg::noteStatus(otg::totalMass(m, total_mass, [&](dMass* unit) { return otg::massOfGeom(unit, 1, g); }));
}
