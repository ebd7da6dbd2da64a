// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/kink.h"

#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cli/progress.h"
#include "scenes/generated_meshes.h"
#include "scenes/heightfield_geom.h"

namespace otg::cli {
namespace {

constexpr double kKinkBox = 0.6, kKinkStep = 1.0 / 200, kKinkFrom = 0.5;
constexpr int kKinkSteps = 400;

/// Along y, z up, falling towards x = 0 from both sides.
struct KinkValley {
  double left, right;  ///< rises
  double heightAt(double x) const { return x > 0 ? right * x : -left * x; }
  double uprightAt(double x) const { return 1 / std::hypot(1, x > 0 ? right : left); }
};

/// A world with a valley and one body in it.
class KinkWorld {
 public:
  KinkWorld(const KinkValley& valley, double friction, const TriMesh* mesh) : valley_(valley), friction_(friction) {
    scenes::HeightGrid grid;
    grid.columns = grid.rows = 33;
    grid.sizeX = grid.sizeY = 8;
    scenes::setHeights(grid, [&](double x, double) { return valley.heightAt(x); });
    field_ = std::make_unique<scenes::HeightfieldData>(grid);
    world_ = dWorldCreate();
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, 1e-5);
    space_ = dSimpleSpaceCreate(nullptr);
    joints_ = dJointGroupCreate(0);
    field_->makeGeom(space_, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
    if (mesh != nullptr) {
      data_ = dGpuTriMeshDataCreate();
      dGpuTriMeshDataBuildSingle(data_, mesh->vertices().data(), 0, static_cast<int>(mesh->vertices().size()),
                                 mesh->triangles().data(), static_cast<int>(3 * mesh->triangleCount()), 0);
      body_ = dCreateGpuTriMesh(space_, data_);
    } else {
      body_ = dCreateBox(space_, kKinkBox, kKinkBox, kKinkBox);
    }
    dMass mass;
    dMassSetBox(&mass, 1, kKinkBox, kKinkBox, kKinkBox);
    const dBodyID body = dBodyCreate(world_);
    dBodySetMass(body, &mass);
    dGeomSetBody(body_, body);
  }
  ~KinkWorld() {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    if (data_ != nullptr) dGpuTriMeshDataDestroy(data_);
  }
  KinkWorld(const KinkWorld&) = delete;
  KinkWorld& operator=(const KinkWorld&) = delete;

  /// The greatest depth of a corner while the box slides for two seconds. It comes from the right side, on which it
  /// lies, turned about that side's normal.
  double deepest(double turned) {
    const double angle = std::atan(valley_.right), reach = kKinkFrom + kKinkBox;
    dMatrix3 lie, turn, both;
    dRFromAxisAndAngle(lie, 0, 1, 0, -angle);
    dRFromAxisAndAngle(turn, 0, 0, 1, turned);
    dMultiply0(both, lie, turn, 3, 3, 3);
    for (int row = 0; row < 3; ++row) both[4 * row + 3] = 0;
    dGeomSetRotation(body_, both);
    const double c = std::cos(angle), s = std::sin(angle), u = kKinkBox / 2;
    dGeomSetPosition(body_, reach * c - u * s, 0, reach * s + u * c);
    double most = 0;
    for (int i = 0; i < kKinkSteps; ++i) {
      dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) { static_cast<KinkWorld*>(self)->join(a, b); });
      dWorldStep(world_, kKinkStep);
      dJointGroupEmpty(joints_);
      most = std::max(most, sunk());
    }
    return most;
  }

 private:
  void join(dGeomID a, dGeomID b) {
    constexpr int kPlaces = 32;
    dContact contacts[kPlaces];
    const int count = dCollide(a, b, kPlaces, &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      contacts[i].surface = {};
      contacts[i].surface.mode = dContactApprox1;
      contacts[i].surface.mu = friction_;
      dJointAttach(dJointCreateContact(world_, joints_, &contacts[i]), dGeomGetBody(contacts[i].geom.g1),
                   dGeomGetBody(contacts[i].geom.g2));
    }
  }
  double sunk() const {
    double most = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const auto side = [&](int bit) { return (corner & bit) != 0 ? kKinkBox / 2 : -kKinkBox / 2; };
      dVector3 p;
      dGeomGetRelPointPos(body_, side(1), side(2), side(4), p);
      most = std::max(most, (valley_.heightAt(p[0]) - p[2]) * valley_.uprightAt(p[0]));
    }
    return most;
  }

  const KinkValley valley_;
  const double friction_;
  std::unique_ptr<scenes::HeightfieldData> field_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID joints_;
  dGpuTriMeshDataID data_ = nullptr;
  dGeomID body_;
};

/// Depths of both bodies in the same slides.
struct KinkSlides {
  std::vector<double> own, mesh;
  void add(const KinkSlides& more) {
    own.insert(own.end(), more.own.begin(), more.own.end());
    mesh.insert(mesh.end(), more.mesh.begin(), more.mesh.end());
  }
  static double geometricMean(const std::vector<double>& depths) {
    double sum = 0;
    for (const double depth : depths) sum += std::log(depth);
    return std::exp(sum / static_cast<double>(depths.size()));
  }
  Json row(Json left, Json right) const {
    double most = 0;
    for (std::size_t i = 0; i < own.size(); ++i) most = std::max(most, mesh[i] / own[i]);
    return {{"rise_left", std::move(left)},
            {"rise_right", std::move(right)},
            {"slides", own.size()},
            {"depth_mm", 1e3 * geometricMean(mesh)},
            {"depth_of_own_mm", 1e3 * geometricMean(own)},
            {"most_times_own", most}};
  }
};

}  // namespace

Json kinkRows() {
  const std::shared_ptr<const TriMesh> box = scenes::build(scenes::makeBox({kKinkBox, kKinkBox, kKinkBox}));
  Json rows = Json::array();
  KinkSlides all;
  constexpr double kRight[] = {0.2, 0.5, 1.0}, kLeft[] = {0.0, 0.2, 0.5, 0.8};
  Progress parts(std::size(kRight) * std::size(kLeft));
  for (const double right : kRight) {
    for (const double left : kLeft) {  // with 1 and 1 the box would stick in a slot of its own shape
      KinkSlides slides;
      for (const double friction : {0.0, 0.1}) {
        for (const double turned : {0.0, 0.4}) {
          slides.own.push_back(KinkWorld({left, right}, friction, nullptr).deepest(turned));
          slides.mesh.push_back(KinkWorld({left, right}, friction, box.get()).deepest(turned));
        }
      }
      rows.push_back(slides.row(left, right));
      all.add(slides);
      parts.step();
    }
  }
  rows.push_back(all.row("all", "all"));
  return rows;
}

}  // namespace otg::cli
