// SPDX-License-Identifier: BSD-3-Clause
// Sequences of calls of the C API, histories among them: each byte is a call, what follows its arguments.
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <cmath>
#include <cstdio>

#include "fuzz/fuzz_target.h"

using namespace otg;

namespace {

constexpr float kVertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
constexpr unsigned kTriangles[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 1, 2, 4};

/// A few of everything, made and lost as the input says.
class Calls {
 public:
  Calls() {
    for (dGpuTriMeshDataID& data : data_) build(data = dGpuTriMeshDataCreate(), 4);
    for (std::size_t i = 0; i < 4; ++i) geoms_[i] = dCreateGpuTriMesh(nullptr, data_[i % 2]);
  }
  ~Calls() {
    for (const dGeomID geom : geoms_) dGeomDestroy(geom);
    for (const dGpuTriMeshDataID data : data_) dGpuTriMeshDataDestroy(data);
  }
  Calls(const Calls&) = delete;
  Calls& operator=(const Calls&) = delete;

  void one(fuzz::Taker& taker) {
    const dGeomID geom = geoms_[taker.byte() % 4], other = geoms_[taker.byte() % 4];
    const dGpuTriMeshDataID data = data_[taker.byte() % 2];
    switch (taker.byte() % 12) {
      case 0:
        dGeomSetPosition(geom, taker.small(), taker.small(), taker.small());
        break;
      case 1:
        collide(geom, other, taker.byte());
        break;
      case 2: {
        float moved[12];
        for (float& x : moved) x = taker.number<float>();
        dGpuTriMeshDataUpdateRangeSingle(data, moved, 0, taker.byte() % 8 - 1, taker.byte() % 6 - 1);
        break;
      }
      case 3:
        build(data, taker.byte() % 6);
        break;
      case 4:
        dGeomGpuTriMeshSetScale(geom, taker.small(), taker.small(), taker.number<double>());
        break;
      case 5:
        dGeomGpuTriMeshSetData(geom, taker.byte() % 8 == 0 ? nullptr : data);
        break;
      case 6: {
        dGpuTriMeshParams params;
        dGpuTriMeshParamsInit(&params);
        params.contact_model = taker.byte() % 4;
        params.max_contacts = taker.number<int>();
        params.contacts_per_region = taker.byte();
        params.history = taker.byte() % 4;
        dGeomGpuTriMeshSetParams(geom, &params);
        break;
      }
      case 7: {
        buffer_.resize(dGpuTriMeshHistorySave(geoms_, 4, nullptr, 0));
        if (!buffer_.empty()) dGpuTriMeshHistorySave(geoms_, 4, buffer_.data(), buffer_.size());
        break;
      }
      case 8:
        for (int i = taker.byte() % 8; i > 0 && !buffer_.empty(); --i) {
          buffer_[taker.number<std::uint16_t>() % buffer_.size()] = taker.byte();
        }
        if (taker.byte() % 8 == 0) buffer_.resize(taker.byte());
        dGpuTriMeshHistoryLoad(geoms_, 4, buffer_.data(), buffer_.size());
        break;
      case 9: {
        dMatrix3 r;
        dRFromEulerAngles(r, taker.small(), taker.small(), taker.small());
        dGeomSetRotation(geom, r);
        break;
      }
      case 10: {
        const dVector3 point = {taker.number<double>(), taker.small(), taker.small(), 0};
        dGpuTriMeshClosestPoint nearest;
        dGeomGpuTriMeshClosestPoint(geom, point, &nearest);
        break;
      }
      default: {
        const dGeomID shape = taker.byte() % 2 == 0 ? dCreateSphere(nullptr, 0.4) : dCreateBox(nullptr, 0.5, 1, 0.3);
        dGeomSetPosition(shape, taker.small(), taker.small(), taker.small());
        collide(geom, shape, 20);
        dGeomDestroy(shape);
      }
    }
  }

 private:
  static void build(dGpuTriMeshDataID data, int triangles) {
    dGpuTriMeshDataBuildSingle(data, kVertices, 12, 5, kTriangles, 3 * triangles, 12);
  }
  static void collide(dGeomID a, dGeomID b, int places) {
    if (a == b || places == 0) return;
    dContactGeom contacts[256];
    const int count = dCollide(a, b, places, contacts, sizeof contacts[0]);
    fuzz::require(count >= 0 && count <= places);
    for (int i = 0; i < count; ++i) {
      const dContactGeom& c = contacts[i];
      bool finite = std::isfinite(c.depth);
      for (int k = 0; k < 3; ++k) finite = finite && std::isfinite(c.pos[k]) && std::isfinite(c.normal[k]);
      fuzz::require(finite);
    }
  }

  dGpuTriMeshDataID data_[2];
  dGeomID geoms_[4];
  std::vector<unsigned char> buffer_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool ready = [] {
    dInitODE2(0);
    return dGpuTriMeshInit() != 0;
  }();
  fuzz::require(ready);
  Calls calls;
  fuzz::Taker taker(data, size);
  while (!taker.isEmpty()) calls.one(taker);
  return 0;
}

std::vector<fuzz::Input> fuzz::seeds() {
  std::vector<Input> all;
  for (std::uint8_t call = 0; call < 12; ++call) {
    Input input;
    for (std::uint8_t round = 0; round < 4; ++round) {
      const std::uint8_t bytes[] = {0, 1, round, call, 20, 3, 7, round, 9, 1, 4, 1, 0, 1, 0, 1, 20};
      input.insert(input.end(), bytes, bytes + sizeof bytes);
    }
    all.push_back(input);
  }
  return all;
}
