// SPDX-License-Identifier: BSD-3-Clause
// The C API by which a program describes the heights of ODE's heightfields.
#include "ode_trimesh_gpu/heightfield.h"

#include <cmath>

#include "ode/base/status.h"
#include "ode/shapes/height_samples.h"

namespace otg {
namespace {

int checkField(const dGpuTriMeshHeightfield* field) {
  if (!isCurrentSize(field)) return dGPUTRIMESH_ERROR_ARGUMENT;
  const dGpuTriMeshHeightfield& f = *field;
  const bool asks = f.type == dGPUTRIMESH_HEIGHTS_CALLBACK;
  const bool good = f.type >= dGPUTRIMESH_HEIGHTS_CALLBACK && f.type <= dGPUTRIMESH_HEIGHTS_DOUBLE &&
                    (asks ? f.callback != nullptr : f.heights != nullptr) && f.width > 0 && f.depth > 0 &&
                    std::isfinite(f.width) && std::isfinite(f.depth) && f.width_samples >= 2 && f.depth_samples >= 2 &&
                    std::isfinite(f.scale) && std::isfinite(f.offset) && std::isfinite(f.thickness);
  return good ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_ARGUMENT;
}

/// The grid of a field, as all of ODE's functions take it.
struct Grid {
  dReal width, depth;
  int widthSamples, depthSamples;
  dReal scale, offset, thickness;
  int wrap;
};

/// Checks, has ODE build, and remembers.
template <class Build>
int buildAndDescribe(dHeightfieldDataID data, dGpuTriMeshHeightfield& field, const Grid& grid, const Build& build) {
  field.width = grid.width;
  field.depth = grid.depth;
  field.width_samples = grid.widthSamples;
  field.depth_samples = grid.depthSamples;
  field.scale = grid.scale;
  field.offset = grid.offset;
  field.thickness = grid.thickness;
  field.wrap = grid.wrap;
  return guarded([&] {
    if (data == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (const int status = checkField(&field)) return status;
    build();
    return describeHeights(data, field);
  });
}

dGpuTriMeshHeightfield ofArray(int type, const void* heights, int copy) {
  dGpuTriMeshHeightfield field;
  dGpuTriMeshHeightfieldInit(&field);
  field.type = type;
  field.heights = heights;
  field.copy = copy;
  return field;
}

}  // namespace
}  // namespace otg

void dGpuTriMeshHeightfieldInit(dGpuTriMeshHeightfield* field) {
  if (field == nullptr) return;
  *field = dGpuTriMeshHeightfield{};
  field->size = sizeof(dGpuTriMeshHeightfield);
  field->scale = 1;
}

int dGpuTriMeshHeightfieldDataDescribe(dHeightfieldDataID data, const dGpuTriMeshHeightfield* field) {
  return otg::guarded([&] {
    if (data == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (const int status = otg::checkField(field)) return status;
    return otg::describeHeights(data, *field);
  });
}

void dGpuTriMeshHeightfieldDataForget(dHeightfieldDataID data) {
  otg::forgetHeights(data);
}

int dGpuTriMeshHeightfieldDataBuildCallback(dHeightfieldDataID d, void* pUserData, dHeightfieldGetHeight* pCallback,
                                            dReal width, dReal depth, int widthSamples, int depthSamples, dReal scale,
                                            dReal offset, dReal thickness, int bWrap) {
  dGpuTriMeshHeightfield field;
  dGpuTriMeshHeightfieldInit(&field);
  field.callback = pCallback;
  field.user_data = pUserData;
  const otg::Grid grid{width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap};
  return otg::buildAndDescribe(d, field, grid, [&] {
    dGeomHeightfieldDataBuildCallback(d, pUserData, pCallback, width, depth, widthSamples, depthSamples, scale, offset,
                                      thickness, bWrap);
  });
}

int dGpuTriMeshHeightfieldDataBuildByte(dHeightfieldDataID d, const unsigned char* pHeightData, int bCopyHeightData,
                                        dReal width, dReal depth, int widthSamples, int depthSamples, dReal scale,
                                        dReal offset, dReal thickness, int bWrap) {
  dGpuTriMeshHeightfield field = otg::ofArray(dGPUTRIMESH_HEIGHTS_BYTE, pHeightData, bCopyHeightData);
  const otg::Grid grid{width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap};
  return otg::buildAndDescribe(d, field, grid, [&] {
    dGeomHeightfieldDataBuildByte(d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
                                  offset, thickness, bWrap);
  });
}

int dGpuTriMeshHeightfieldDataBuildShort(dHeightfieldDataID d, const short* pHeightData, int bCopyHeightData,
                                         dReal width, dReal depth, int widthSamples, int depthSamples, dReal scale,
                                         dReal offset, dReal thickness, int bWrap) {
  dGpuTriMeshHeightfield field = otg::ofArray(dGPUTRIMESH_HEIGHTS_SHORT, pHeightData, bCopyHeightData);
  const otg::Grid grid{width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap};
  return otg::buildAndDescribe(d, field, grid, [&] {
    dGeomHeightfieldDataBuildShort(d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
                                   offset, thickness, bWrap);
  });
}

int dGpuTriMeshHeightfieldDataBuildSingle(dHeightfieldDataID d, const float* pHeightData, int bCopyHeightData,
                                          dReal width, dReal depth, int widthSamples, int depthSamples, dReal scale,
                                          dReal offset, dReal thickness, int bWrap) {
  dGpuTriMeshHeightfield field = otg::ofArray(dGPUTRIMESH_HEIGHTS_SINGLE, pHeightData, bCopyHeightData);
  const otg::Grid grid{width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap};
  return otg::buildAndDescribe(d, field, grid, [&] {
    dGeomHeightfieldDataBuildSingle(d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
                                    offset, thickness, bWrap);
  });
}

int dGpuTriMeshHeightfieldDataBuildDouble(dHeightfieldDataID d, const double* pHeightData, int bCopyHeightData,
                                          dReal width, dReal depth, int widthSamples, int depthSamples, dReal scale,
                                          dReal offset, dReal thickness, int bWrap) {
  dGpuTriMeshHeightfield field = otg::ofArray(dGPUTRIMESH_HEIGHTS_DOUBLE, pHeightData, bCopyHeightData);
  const otg::Grid grid{width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap};
  return otg::buildAndDescribe(d, field, grid, [&] {
    dGeomHeightfieldDataBuildDouble(d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
                                    offset, thickness, bWrap);
  });
}

void dGpuTriMeshHeightfieldDataDestroy(dHeightfieldDataID d) {
  if (d == nullptr) return;
  otg::forgetHeights(d);
  dGeomHeightfieldDataDestroy(d);
}
