// SPDX-License-Identifier: BSD-3-Clause
// libode_trimesh_gpu_preload.so: dGpuTriMeshOverrideTriMesh() for a program that is not recompiled.
//
//   LD_PRELOAD=libode_trimesh_gpu_preload.so program
//
// The functions of ODE below are found here before they are found in libode: each calls ODE's own and then notes what
// happened. That also shows what ODE does not expose: when data change and when geoms and data are destroyed. It works
// for programs, plug-ins and scripting languages that use libode as a shared library. It prints
// nothing unless requested, but where the environment has a value that is not allowed.
#include <dlfcn.h>
#include <ode/ode.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>

#include "base/environment.h"
#include "ode/base/environment_report.h"
#include "ode/data/trimesh_cache.h"
#include "ode/geom/mesh_side.h"
#include "ode/override/checked_arrays.h"
#include "ode/override/flat_pairs.h"
#include "ode/override/join_still.h"
#include "ode/pairs/left_pairs.h"
#include "ode/shapes/height_samples.h"
#include "ode_trimesh_gpu/ode_trimesh_gpu.h"

#define OTG_INTERPOSED extern "C" __attribute__((visibility("default")))

namespace {

/// ODE's own function. The program has been linked with it, so that there is one.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
#define OTG_NEXT(name)                                     \
  (*[] {                                                   \
    static const auto found = next<decltype(name)>(#name); \
    return found;                                          \
  }())

/// Read once, when it is first requested.
const otg::Environment& settings() {
  static const otg::Environment read = otg::readEnvironment();
  return read;
}
bool isOff() {
  return !settings().preload;
}
bool isVerbose() {
  return settings().preloadVerbose;
}

void chooseParams() {
  using Contacts = otg::Environment::Contacts;
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  if (settings().preloadContacts == Contacts::kPairwise) params.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE;
  if (settings().preloadContacts == Contacts::kSolid) params.contact_model = dGPUTRIMESH_CONTACTS_SOLID;
  params.max_contacts = settings().preloadMaxContacts.value_or(params.max_contacts);
  params.contacts_per_region = settings().preloadContactsPerRegion.value_or(params.contacts_per_region);
  dGpuTriMeshOverrideSetParams(&params);
}

void sayWhatWasDone() {
  dGpuTriMeshOverrideStats stats;
  dGpuTriMeshOverrideStatsInit(&stats);
  dGpuTriMeshOverrideGetStats(&stats);
  std::fprintf(
      stderr, "ode_trimesh_gpu: %llu pairs of dTriMesh collided with %llu contacts; %llu meshes built, %llu refitted\n",
      static_cast<unsigned long long>(stats.queries), static_cast<unsigned long long>(stats.contacts),
      static_cast<unsigned long long>(stats.builds), static_cast<unsigned long long>(stats.refits));
}

/// The classes that OTG_PRELOAD_PRIMITIVES names, each with its number.
void takeOverPrimitives() {
  static constexpr int kClasses[] = {dGPUTRIMESH_OVERRIDE_ALL, dSphereClass, dBoxClass, dCapsuleClass,
                                     dCylinderClass,           dPlaneClass,  dRayClass, dConvexClass,
                                     dHeightfieldClass};
  static_assert(std::size(kClasses) == std::size(otg::kPreloadPrimitives));
  for (const std::string& name : settings().preloadPrimitives) {
    for (std::size_t i = 0; i < std::size(kClasses); ++i) {
      if (name == otg::kPreloadPrimitives[i]) dGpuTriMeshOverrideTriMeshWith(kClasses[i]);
    }
  }
}

/// After every initialisation of ODE, which clears what was set before.
void takeOver() {
  otg::reportEnvironment();
  if (isOff()) return;
  const int status = dGpuTriMeshOverrideTriMesh();
  takeOverPrimitives();
  static std::atomic<bool> first{true};
  if (first.exchange(false)) {
    chooseParams();
    otg::noteMargin();
    if (isVerbose()) std::atexit(&sayWhatWasDone);
    if (isVerbose() && status == dGPUTRIMESH_OK) {
      std::fprintf(stderr, "ode_trimesh_gpu: pairs of dTriMesh collide through this library\n");
    }
  }
  if (isVerbose() && status != dGPUTRIMESH_OK) {
    std::fprintf(stderr, "ode_trimesh_gpu: %s\n", dGpuTriMeshErrorString(status));
  }
}

void forgetAll() {
  otg::forgetTrimeshes();
  otg::clearTrimeshCache();
  otg::forgetAllHeights();
  otg::dropAllStill();
  otg::forgetFlatness();
}

void dataChanged(dTriMeshDataID data) {
  otg::trimeshDataChanged(data);
  otg::forgetFlatness();
}

bool joins() {
  return settings().preloadJoin && otg::isAnyTrimesh();
}

/// What a program builds data from.
struct GivenArrays {
  const void* vertices;
  int vertexCount;
  const void* indices;
  int indexCount, stride;
};

/// ODE's own functions call each other, and are found here then.
thread_local bool isBuilding = false;

/// Calls ODE's function with indices that it can take, or not at all where there are no triangles.
template <class Build>
void build(dTriMeshDataID data, const char* function, const GivenArrays& given, const Build& ofOde) {
  if (isOff() || isBuilding) {
    ofOde({given.indices, given.indexCount, given.stride, false});
    return;
  }
  isBuilding = true;
  try {
    const bool first = otg::staysUnbuilt(data);
    const otg::CheckedIndices checked = otg::checkIndices(data, function, given.vertices, given.vertexCount,
                                                          given.indices, given.indexCount, given.stride);
    if (!checked.isEmpty) {
      ofOde(checked);
    } else if (!first) {
      const otg::NoTriangles& none = otg::noTriangles();
      OTG_NEXT(dGeomTriMeshDataBuildSingle)(data, none.vertices, 12, 1, none.indices, 6, 12);
    }
  } catch (...) {  // no memory for it: as the program said
    ofOde({given.indices, given.indexCount, given.stride, false});
  }
  isBuilding = false;
  dataChanged(data);
}

/// What the heightfield was built from, for meshes to collide with.
template <class Samples>
void describe(dHeightfieldDataID data, int type, const Samples* heights, int copy, dReal width, dReal depth,
              int widthSamples, int depthSamples, dReal scale, dReal offset, dReal thickness, int wrap,
              dHeightfieldGetHeight* callback = nullptr, void* userData = nullptr) {
  dGpuTriMeshHeightfield field;
  dGpuTriMeshHeightfieldInit(&field);
  field.type = type;
  field.heights = heights;
  field.copy = copy;
  field.callback = callback;
  field.user_data = userData;
  field.width = width;
  field.depth = depth;
  field.width_samples = widthSamples;
  field.depth_samples = depthSamples;
  field.scale = scale;
  field.offset = offset;
  field.thickness = thickness;
  field.wrap = wrap;
  dGpuTriMeshHeightfieldDataDescribe(data, &field);
}

}  // namespace

OTG_INTERPOSED void dInitODE(void) {
  OTG_NEXT(dInitODE)();
  takeOver();
}

OTG_INTERPOSED int dInitODE2(unsigned int uiInitFlags) {
  const int done = OTG_NEXT(dInitODE2)(uiInitFlags);
  if (done != 0) takeOver();
  return done;
}

OTG_INTERPOSED void dCloseODE(void) {
  OTG_NEXT(dCloseODE)();
  forgetAll();
}

/// The order of creation is the order of geoms, whatever collides first.
OTG_INTERPOSED dGeomID dCreateTriMesh(dSpaceID space, dTriMeshDataID Data, dTriCallback* Callback,
                                      dTriArrayCallback* ArrayCallback, dTriRayCallback* RayCallback) {
  const dGeomID geom = OTG_NEXT(dCreateTriMesh)(space, Data, Callback, ArrayCallback, RayCallback);
  if (geom == nullptr || otg::isReadingTrimesh()) return geom;
  try {
    otg::objectOfTrimesh(geom);
    otg::noteTrimesh();
  } catch (...) {  // no memory for it: it gets its place when it collides
  }
  return geom;
}

OTG_INTERPOSED void dGeomDestroy(dGeomID geom) {
  if (geom != nullptr && !otg::isReadingTrimesh() && dGeomGetClass(geom) == dTriMeshClass) {
    otg::forgetTrimesh(geom);
    otg::dropStill(geom);
  }
  OTG_NEXT(dGeomDestroy)(geom);
}

OTG_INTERPOSED void dSpaceCollide(dSpaceID space, void* data, dNearCallback* callback) {
  if (!isOff() && joins() && space != nullptr) {
    try {
      otg::joinStill(space);
    } catch (...) {  // no memory for it: each collides by itself
    }
  }
  OTG_NEXT(dSpaceCollide)(space, data, callback);
  if (!isOff() && space != nullptr && callback != nullptr) otg::askAboutFlats(space, data, callback);
}

OTG_INTERPOSED void dSpaceCollide2(dGeomID space1, dGeomID space2, void* data, dNearCallback* callback) {
  OTG_NEXT(dSpaceCollide2)(space1, space2, data, callback);
  if (!isOff() && callback != nullptr) otg::askAboutFlats(space1, space2, data, callback);
}

OTG_INTERPOSED void dGeomTriMeshSetLastTransform(dGeomID g, const dMatrix4 last_trans) {
  OTG_NEXT(dGeomTriMeshSetLastTransform)(g, last_trans);
  dGeomGpuTriMeshSetLastTransform(g, last_trans);
}

OTG_INTERPOSED void dGeomTriMeshDataDestroy(dTriMeshDataID g) {
  otg::forgetTrimeshData(g);
  otg::forgetIndices(g);
  otg::forgetFlatness();
  OTG_NEXT(dGeomTriMeshDataDestroy)(g);
}

/// Data without triangles may never have been built.
OTG_INTERPOSED void dGeomTriMeshDataUpdate(dTriMeshDataID g) {
  if (isOff() || !otg::hasNoTriangles(g)) OTG_NEXT(dGeomTriMeshDataUpdate)(g);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSingle(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                int VertexCount, const void* Indices, int IndexCount, int TriStride) {
  dGeomTriMeshDataBuildSingle1(g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride, nullptr);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSingle1(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                 int VertexCount, const void* Indices, int IndexCount, int TriStride,
                                                 const void* Normals) {
  build(g, "dGeomTriMeshDataBuildSingle", {Vertices, VertexCount, Indices, IndexCount, TriStride},
        [&](const otg::CheckedIndices& use) {
          OTG_NEXT(dGeomTriMeshDataBuildSingle1)
          (g, Vertices, VertexStride, VertexCount, use.indices, use.count, use.stride, Normals);
        });
}

OTG_INTERPOSED void dGeomTriMeshDataBuildDouble(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                int VertexCount, const void* Indices, int IndexCount, int TriStride) {
  dGeomTriMeshDataBuildDouble1(g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride, nullptr);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildDouble1(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                 int VertexCount, const void* Indices, int IndexCount, int TriStride,
                                                 const void* Normals) {
  build(g, "dGeomTriMeshDataBuildDouble", {Vertices, VertexCount, Indices, IndexCount, TriStride},
        [&](const otg::CheckedIndices& use) {
          OTG_NEXT(dGeomTriMeshDataBuildDouble1)
          (g, Vertices, VertexStride, VertexCount, use.indices, use.count, use.stride, Normals);
        });
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSimple(dTriMeshDataID g, const dReal* Vertices, int VertexCount,
                                                const dTriIndex* Indices, int IndexCount) {
  dGeomTriMeshDataBuildSimple1(g, Vertices, VertexCount, Indices, IndexCount, nullptr);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSimple1(dTriMeshDataID g, const dReal* Vertices, int VertexCount,
                                                 const dTriIndex* Indices, int IndexCount, const int* Normals) {
  static_assert(sizeof(dTriIndex) == sizeof(std::uint32_t));
  build(g, "dGeomTriMeshDataBuildSimple",
        {Vertices, VertexCount, Indices, IndexCount, static_cast<int>(3 * sizeof(dTriIndex))},
        [&](const otg::CheckedIndices& use) {
          OTG_NEXT(dGeomTriMeshDataBuildSimple1)
          (g, Vertices, VertexCount, static_cast<const dTriIndex*>(use.indices), use.count, Normals);
        });
}

/// As many as the program gave, and of a geom without data none.
OTG_INTERPOSED int dGeomTriMeshGetTriangleCount(dGeomID g) {
  if (!isOff() && otg::hasNoTriangles(dGeomTriMeshGetData(g))) return 0;
  return OTG_NEXT(dGeomTriMeshGetTriangleCount)(g);
}

OTG_INTERPOSED int dCollide(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) {
  if (isOff()) return OTG_NEXT(dCollide)(o1, o2, flags, contact, skip);
  const int allowed = otg::allowedFlags(flags);
  const bool nothing = allowed == 0 || otg::isEmptyTrimesh(o1) || otg::isEmptyTrimesh(o2);
  return nothing ? 0 : OTG_NEXT(dCollide)(o1, o2, allowed, contact, skip);
}

OTG_INTERPOSED void dGeomHeightfieldDataDestroy(dHeightfieldDataID d) {
  otg::forgetHeights(d);
  OTG_NEXT(dGeomHeightfieldDataDestroy)(d);
}

OTG_INTERPOSED void dGeomHeightfieldDataBuildCallback(dHeightfieldDataID d, void* pUserData,
                                                      dHeightfieldGetHeight* pCallback, dReal width, dReal depth,
                                                      int widthSamples, int depthSamples, dReal scale, dReal offset,
                                                      dReal thickness, int bWrap) {
  OTG_NEXT(dGeomHeightfieldDataBuildCallback)
  (d, pUserData, pCallback, width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap);
  describe<void>(d, dGPUTRIMESH_HEIGHTS_CALLBACK, nullptr, 0, width, depth, widthSamples, depthSamples, scale, offset,
                 thickness, bWrap, pCallback, pUserData);
}

OTG_INTERPOSED void dGeomHeightfieldDataBuildByte(dHeightfieldDataID d, const unsigned char* pHeightData,
                                                  int bCopyHeightData, dReal width, dReal depth, int widthSamples,
                                                  int depthSamples, dReal scale, dReal offset, dReal thickness,
                                                  int bWrap) {
  OTG_NEXT(dGeomHeightfieldDataBuildByte)
  (d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap);
  describe(d, dGPUTRIMESH_HEIGHTS_BYTE, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
           offset, thickness, bWrap);
}

OTG_INTERPOSED void dGeomHeightfieldDataBuildShort(dHeightfieldDataID d, const short* pHeightData, int bCopyHeightData,
                                                   dReal width, dReal depth, int widthSamples, int depthSamples,
                                                   dReal scale, dReal offset, dReal thickness, int bWrap) {
  OTG_NEXT(dGeomHeightfieldDataBuildShort)
  (d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap);
  describe(d, dGPUTRIMESH_HEIGHTS_SHORT, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
           offset, thickness, bWrap);
}

OTG_INTERPOSED void dGeomHeightfieldDataBuildSingle(dHeightfieldDataID d, const float* pHeightData, int bCopyHeightData,
                                                    dReal width, dReal depth, int widthSamples, int depthSamples,
                                                    dReal scale, dReal offset, dReal thickness, int bWrap) {
  OTG_NEXT(dGeomHeightfieldDataBuildSingle)
  (d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap);
  describe(d, dGPUTRIMESH_HEIGHTS_SINGLE, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
           offset, thickness, bWrap);
}

OTG_INTERPOSED void dGeomHeightfieldDataBuildDouble(dHeightfieldDataID d, const double* pHeightData,
                                                    int bCopyHeightData, dReal width, dReal depth, int widthSamples,
                                                    int depthSamples, dReal scale, dReal offset, dReal thickness,
                                                    int bWrap) {
  OTG_NEXT(dGeomHeightfieldDataBuildDouble)
  (d, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale, offset, thickness, bWrap);
  describe(d, dGPUTRIMESH_HEIGHTS_DOUBLE, pHeightData, bCopyHeightData, width, depth, widthSamples, depthSamples, scale,
           offset, thickness, bWrap);
}
