// SPDX-License-Identifier: BSD-3-Clause
// dCollide of two meshes: ODE's own geom class, and this library's in the same ODE.
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <cstdarg>
#include <stdexcept>

#include "peers/peer.h"

namespace otg::peers {
namespace {

/// ODE prints a message for every overflow of its contact table, thousands in one query; the time of a terminal is not
/// what is measured here.
void swallowMessage(int, const char*, va_list) {}

class OdePeer : public Peer {
 public:
  explicit OdePeer(int maxContacts) : contacts_(static_cast<std::size_t>(maxContacts)) {
    dSetMessageHandler(&swallowMessage);
  }
  ~OdePeer() override {
    destroyGeoms();
    dSetMessageHandler(nullptr);
  }
  void query() override {
    found_ = dCollide(a_, b_, static_cast<int>(contacts_.size()), contacts_.data(), sizeof(dContactGeom));
  }
  std::size_t resultCount() const override { return static_cast<std::size_t>(found_); }
  std::vector<double> resultNumbers() const override {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < resultCount(); ++i) {
      const dContactGeom& c = contacts_[i];
      for (const dReal x : {c.pos[0], c.pos[1], c.pos[2], c.normal[0], c.normal[1], c.normal[2], c.depth}) {
        numbers.push_back(x);
      }
    }
    return numbers;
  }
  std::vector<PeerContact> contacts() const override {
    std::vector<PeerContact> all;
    for (std::size_t i = 0; i < resultCount(); ++i) {
      const dContactGeom& c = contacts_[i];
      all.push_back({{c.pos[0], c.pos[1], c.pos[2]}, {c.normal[0], c.normal[1], c.normal[2]}, c.depth});
    }
    return all;
  }

 protected:
  void place(dGeomID a, dGeomID b, const Transformd& bInA) {
    a_ = a;
    b_ = b;
    const double* r = bInA.r;
    const dMatrix3 rotation{r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0};
    dGeomSetRotation(b_, rotation);
    dGeomSetPosition(b_, bInA.t.x, bInA.t.y, bInA.t.z);
  }

  void destroyGeoms() {
    for (dGeomID* geom : {&a_, &b_}) {
      if (*geom != nullptr) dGeomDestroy(*geom);
      *geom = nullptr;
    }
  }

 private:
  dGeomID a_ = nullptr, b_ = nullptr;
  std::vector<dContactGeom> contacts_;
  int found_ = 0;
};

class StockOdePeer final : public OdePeer {
 public:
  StockOdePeer(const PeerScene& scene, int maxContacts) : OdePeer(maxContacts) {
    const dGeomID a = makeGeom(*scene.a, data_[0]);
    place(a, makeGeom(*scene.b, data_[1]), scene.bInA);
  }
  ~StockOdePeer() override {
    destroyGeoms();  // before their data
    for (const dTriMeshDataID data : data_) dGeomTriMeshDataDestroy(data);
  }

 private:
  static dGeomID makeGeom(const TriMesh& mesh, dTriMeshDataID& data) {
    data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildSingle(data, mesh.vertices().data(), sizeof(Vec3f), static_cast<int>(mesh.vertices().size()),
                                mesh.triangles().data(), static_cast<int>(3 * mesh.triangleCount()), sizeof(Triangle));
    return dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  }
  dTriMeshDataID data_[2] = {nullptr, nullptr};
};

class GpuTriMeshPeer final : public OdePeer {
 public:
  GpuTriMeshPeer(const PeerScene& scene, int maxContacts, int contactModel) : OdePeer(maxContacts) {
    const dGeomID a = makeGeom(*scene.a, contactModel);
    place(a, makeGeom(*scene.b, contactModel), scene.bInA);
  }

 private:
  static dGeomID makeGeom(const TriMesh& mesh, int contactModel) {
    const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
    dGpuTriMeshDataBuildSingle(data, mesh.vertices().data(), sizeof(Vec3f), static_cast<int>(mesh.vertices().size()),
                               mesh.triangles().data(), static_cast<int>(3 * mesh.triangleCount()), sizeof(Triangle));
    const dGeomID geom = dCreateGpuTriMesh(nullptr, data);
    dGpuTriMeshDataDestroy(data);  // the geom keeps the mesh
    if (geom == nullptr) throw std::runtime_error("the geom class is not registered");
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.contact_model = contactModel;
    params.history = dGPUTRIMESH_HISTORY_OFF;  // with it, the result of a pair that stays where it is would be kept
    dGeomGpuTriMeshSetParams(geom, &params);
    return geom;
  }
};

}  // namespace

std::unique_ptr<Peer> makeStockOdePeer(const PeerScene& scene, int maxContacts) {
  return std::make_unique<StockOdePeer>(scene, maxContacts);
}

std::unique_ptr<Peer> makeGpuTriMeshPeer(const PeerScene& scene, int maxContacts, int contactModel) {
  return std::make_unique<GpuTriMeshPeer>(scene, maxContacts, contactModel);
}

}  // namespace otg::peers
