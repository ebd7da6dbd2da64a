// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/heightfield_geom.h"

#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <cmath>
#include <stdexcept>

namespace otg::scenes {
namespace {

constexpr double kRightAngle = 1e-9;

double settled(double x) {
  const double nearest = std::round(x) + 0.0;  // no -0
  return std::fabs(x - nearest) < kRightAngle ? nearest : x;
}

}  // namespace

HeightfieldData::HeightfieldData(const HeightGrid& grid) : data_(dGeomHeightfieldDataCreate()) {
  const std::vector<float> samples = fieldSamples(grid);
  const int status = dGpuTriMeshHeightfieldDataBuildSingle(data_, samples.data(), 1, static_cast<dReal>(grid.sizeX),
                                                           static_cast<dReal>(grid.sizeY), grid.columns, grid.rows, 1,
                                                           0, static_cast<dReal>(grid.thickness), grid.wraps ? 1 : 0);
  if (status == dGPUTRIMESH_OK) return;
  dGpuTriMeshHeightfieldDataDestroy(data_);
  throw std::runtime_error(dGpuTriMeshErrorString(status));
}

HeightfieldData::~HeightfieldData() {
  dGpuTriMeshHeightfieldDataDestroy(data_);
}

dGeomID HeightfieldData::makeGeom(dSpaceID space, const Transformd& pose) const {
  const dGeomID geom = dCreateHeightfield(space, data_, 1);
  // Columns: where the field's x, y and z axes point, which are the grid's x, z and -y.
  dMatrix3 r{};
  for (int row = 0; row < 3; ++row) {
    const double* const m = pose.r + 3 * row;
    r[4 * row] = settled(m[0]);
    r[4 * row + 1] = settled(m[2]);
    r[4 * row + 2] = settled(-m[1]);
  }
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, static_cast<dReal>(pose.t.x), static_cast<dReal>(pose.t.y), static_cast<dReal>(pose.t.z));
  return geom;
}

bool isOfRightAngles(const double rotation[4]) {
  const dQuaternion q{rotation[0], rotation[1], rotation[2], rotation[3]};
  dMatrix3 r;
  dQtoR(q, r);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (!(std::fabs(r[4 * row + column] - std::round(r[4 * row + column])) < kRightAngle)) return false;
    }
  }
  return true;
}

}  // namespace otg::scenes
