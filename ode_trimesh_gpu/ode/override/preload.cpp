// SPDX-License-Identifier: BSD-3-Clause
// libode_trimesh_gpu_preload.so: dGpuTriMeshOverrideTriMesh() for a program that nobody recompiles.
//
//   LD_PRELOAD=libode_trimesh_gpu_preload.so program
//
// The functions of ODE below are found here before they are found in libode: each calls ODE's own and then notes what
// happened. That also tells what ODE tells nobody, when data change and when geoms and data are destroyed. It works
// for programs, plug-ins and scripting languages that use libode as a shared library. It prints nothing unless asked.
#include <dlfcn.h>
#include <ode/ode.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "ode/data/trimesh_cache.h"
#include "ode/geom/mesh_side.h"
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

bool isSet(const char* name, const char* value) {
  const char* const found = std::getenv(name);
  return found != nullptr && std::strcmp(found, value) == 0;
}
bool isVerbose() {
  return isSet("OTG_PRELOAD_VERBOSE", "1");
}

/// A number between `least` and `most` of the environment, or `otherwise`.
int numberOf(const char* name, int least, int most, int otherwise) {
  const char* const found = std::getenv(name);
  if (found == nullptr) return otherwise;
  char* end = nullptr;
  const long number = std::strtol(found, &end, 10);
  return end != found && *end == '\0' && number >= least && number <= most ? static_cast<int>(number) : otherwise;
}

void chooseParams() {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  if (isSet("OTG_PRELOAD_CONTACTS", "pairwise")) params.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE;
  if (isSet("OTG_PRELOAD_CONTACTS", "solid")) params.contact_model = dGPUTRIMESH_CONTACTS_SOLID;
  params.max_contacts = numberOf("OTG_PRELOAD_MAX_CONTACTS", 1, 65535, params.max_contacts);
  params.contacts_per_region = numberOf("OTG_PRELOAD_CONTACTS_PER_REGION", 1, 64, params.contacts_per_region);
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

/// The classes that OTG_PRELOAD_PRIMITIVES names: "all", or names with commas between them. Names that are none are
/// passed over, with a line if that is wanted.
void takeOverPrimitives() {
  static constexpr struct {
    const char* name;
    int geomClass;
  } kNames[] = {
      {"all", dGPUTRIMESH_OVERRIDE_ALL}, {"sphere", dSphereClass}, {"box", dBoxClass}, {"capsule", dCapsuleClass},
      {"cylinder", dCylinderClass},      {"plane", dPlaneClass},   {"ray", dRayClass}, {"convex", dConvexClass},
      {"heightfield", dHeightfieldClass}};
  const char* const list = std::getenv("OTG_PRELOAD_PRIMITIVES");
  if (list == nullptr) return;
  for (const char* at = list; *at != '\0';) {
    const std::size_t length = std::strcspn(at, ",");
    const auto known = std::find_if(std::begin(kNames), std::end(kNames), [&](const auto& entry) {
      return std::strlen(entry.name) == length && std::strncmp(entry.name, at, length) == 0;
    });
    if (known != std::end(kNames)) {
      dGpuTriMeshOverrideTriMeshWith(known->geomClass);
    } else if (length > 0 && isVerbose()) {
      std::fprintf(stderr, "ode_trimesh_gpu: OTG_PRELOAD_PRIMITIVES knows no %.*s\n", static_cast<int>(length), at);
    }
    at += length;
    if (*at == ',') ++at;
  }
}

/// After every initialisation of ODE, which clears what was set before.
void takeOver() {
  if (isSet("OTG_PRELOAD", "off")) return;
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
  static const bool wanted = !isSet("OTG_PRELOAD_JOIN", "off");
  return wanted && otg::isAnyTrimesh();
}

bool isOff() {
  static const bool off = isSet("OTG_PRELOAD", "off");
  return off;
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
  } catch (...) {  // for want of memory: it gets its place when it collides
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
    } catch (...) {  // for want of memory: each collides by itself
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
  otg::forgetFlatness();
  OTG_NEXT(dGeomTriMeshDataDestroy)(g);
}

OTG_INTERPOSED void dGeomTriMeshDataUpdate(dTriMeshDataID g) {
  OTG_NEXT(dGeomTriMeshDataUpdate)(g);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSingle(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                int VertexCount, const void* Indices, int IndexCount, int TriStride) {
  OTG_NEXT(dGeomTriMeshDataBuildSingle)(g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSingle1(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                 int VertexCount, const void* Indices, int IndexCount, int TriStride,
                                                 const void* Normals) {
  OTG_NEXT(dGeomTriMeshDataBuildSingle1)
  (g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride, Normals);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildDouble(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                int VertexCount, const void* Indices, int IndexCount, int TriStride) {
  OTG_NEXT(dGeomTriMeshDataBuildDouble)(g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildDouble1(dTriMeshDataID g, const void* Vertices, int VertexStride,
                                                 int VertexCount, const void* Indices, int IndexCount, int TriStride,
                                                 const void* Normals) {
  OTG_NEXT(dGeomTriMeshDataBuildDouble1)
  (g, Vertices, VertexStride, VertexCount, Indices, IndexCount, TriStride, Normals);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSimple(dTriMeshDataID g, const dReal* Vertices, int VertexCount,
                                                const dTriIndex* Indices, int IndexCount) {
  OTG_NEXT(dGeomTriMeshDataBuildSimple)(g, Vertices, VertexCount, Indices, IndexCount);
  dataChanged(g);
}

OTG_INTERPOSED void dGeomTriMeshDataBuildSimple1(dTriMeshDataID g, const dReal* Vertices, int VertexCount,
                                                 const dTriIndex* Indices, int IndexCount, const int* Normals) {
  OTG_NEXT(dGeomTriMeshDataBuildSimple1)(g, Vertices, VertexCount, Indices, IndexCount, Normals);
  dataChanged(g);
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
