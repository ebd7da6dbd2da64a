// SPDX-License-Identifier: BSD-3-Clause
// A box mesh where the ground has a concave kink: it lies on one side of a valley, and its edge reaches into the other.
// Two contacts of the box in one region of overlap, of which the one has the area and the other the depth.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "support/catch.h"
#include "support/mesh_samples.h"
#include "support/ode_world.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kSide = 0.6, kSize = 8;
constexpr int kSamples = 33;

/// A valley along y, z up, that falls towards x = 0 from both sides.
struct Valley {
  double left, right;  ///< rises
  double heightAt(double x) const { return x > 0 ? right * x : -left * x; }
  Vec3d normalAt(double x) const {
    const double slope = x > 0 ? right : -left, length = std::sqrt(1 + slope * slope);
    return {-slope / length, 0, 1 / length};
  }
};

/// As ODE's heightfield, or a closed mesh of two triangles for each side.
class Ground {
 public:
  Ground(const Valley& valley, bool isMesh) {
    if (isMesh) {
      data_ = std::make_unique<Data>(samples::makeValley(valley.left, valley.right, kSize, 4));
      geom = dCreateGpuTriMesh(nullptr, data_->id);
      return;
    }
    for (int j = 0; j < kSamples; ++j) {
      for (int i = 0; i < kSamples; ++i) heights_.push_back(valley.heightAt(kSize * (i / (kSamples - 1.0) - 0.5)));
    }
    field_ = dGeomHeightfieldDataCreate();
    REQUIRE(dGpuTriMeshHeightfieldDataBuildDouble(field_, heights_.data(), 0, kSize, kSize, kSamples, kSamples, 1, 0, 1,
                                                  0) == dGPUTRIMESH_OK);
    geom = dCreateHeightfield(nullptr, field_, 1);
    dMatrix3 upright;
    dRFromAxisAndAngle(upright, 1, 0, 0, M_PI / 2);
    dGeomSetRotation(geom, upright);
  }
  ~Ground() {
    dGeomDestroy(geom);
    if (field_ != nullptr) dGpuTriMeshHeightfieldDataDestroy(field_);
  }
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;
  dGeomID geom;

 private:
  std::unique_ptr<Data> data_;
  std::vector<double> heights_;
  dHeightfieldDataID field_ = nullptr;
};

/// Puts a box on the right side, `lifted` above it, with its leading lower edge `ahead` beyond the kink.
void layDown(dGeomID box, const Valley& valley, double ahead, double lifted) {
  const double angle = std::atan(valley.right);
  const Vec3d along{std::cos(angle), 0, std::sin(angle)}, up = valley.normalAt(1);
  dMatrix3 r;
  dRFromAxisAndAngle(r, 0, 1, 0, -angle);
  dGeomSetRotation(box, r);
  const double a = kSide / 2 - ahead, u = kSide / 2 + lifted;
  dGeomSetPosition(box, a * along.x + u * up.x, 0, a * along.z + u * up.z);
}

/// How deep the lowest corner is in the ground.
double sunk(dGeomID box, const Valley& valley) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    dVector3 p;
    dGeomGetRelPointPos(box, (corner & 1 ? 0.5 : -0.5) * kSide, (corner & 2 ? 0.5 : -0.5) * kSide,
                        (corner & 4 ? 0.5 : -0.5) * kSide, p);
    most = std::max(most, (valley.heightAt(p[0]) - p[2]) * valley.normalAt(p[0]).z);
  }
  return most;
}

/// How deep a box sinks that slides down the right side without friction, from `from` metres up, until it is out again:
/// then it hops, and how it lands is chance.
double deepestSlide(const Valley& valley, bool onMesh, bool isMesh, const Data& data, double from) {
  StepWorld world(0);
  const Ground ground(valley, onMesh);
  dSpaceAdd(world.space(), ground.geom);
  const dGeomID box =
      isMesh ? dCreateGpuTriMesh(world.space(), data.id) : dCreateBox(world.space(), kSide, kSide, kSide);
  dMass mass;
  dMassSetBox(&mass, 1, kSide, kSide, kSide);
  world.addBody(box, mass);
  layDown(box, valley, -from, 0);
  double most = 0;
  for (int i = 0; i < 300; ++i) {
    world.step(1);
    const double now = sunk(box, valley);
    most = std::max(most, now);
    if (most > 1e-3 && now < 1e-4) break;
  }
  dSpaceRemove(world.space(), ground.geom);
  return most;
}

}  // namespace

TEST_CASE("an edge that reaches into the other side of a valley leaves it through that side") {
  const OdeSession session;
  const Data coarse(scenes::makeBox({kSide, kSide, kSide})), fine(scenes::makeBox({kSide, kSide, kSide}, 4));
  for (const bool isMesh : {false, true}) {
    for (const Valley valley : {Valley{0.5, 0.5}, Valley{1, 0.3}, Valley{0.4, 1}}) {
      const Ground ground(valley, isMesh);
      for (const Data* data : {&coarse, &fine}) {
        const Geom box(*data);
        for (const double ahead : {0.002, 0.005, 0.01, 0.02}) {
          for (const double lifted : {-1e-4, -1e-5}) {
            layDown(box.id, valley, ahead, lifted);
            dGeomGpuTriMeshForgetHistory(box.id);
            const auto contacts = test::collide(box.id, ground.geom);
            INFO("mesh " << isMesh << " valley " << valley.left << " " << valley.right << " ahead " << ahead
                         << " lifted " << lifted);
            REQUIRE(!contacts.empty());
            const dContactGeom& deepest =
                *std::max_element(contacts.begin(), contacts.end(),
                                  [](const dContactGeom& a, const dContactGeom& b) { return a.depth < b.depth; });
            const Vec3d n = valley.normalAt(-1);
            CHECK(deepest.depth == Approx(sunk(box.id, valley)).epsilon(1e-3));
            CHECK(deepest.normal[0] * n.x + deepest.normal[2] * n.z > 0.9999);
            CHECK(sameContacts(mirrored(test::collide(ground.geom, box.id)), contacts));
          }
        }
      }
    }
  }
}

TEST_CASE("a box mesh that slides over a concave kink sinks no deeper than ODE's box") {
  const OdeSession session;
  const Data box(scenes::makeBox({kSide, kSide, kSide}));
  for (const Valley valley : {Valley{0.5, 0.5}, Valley{0.5, 0.2}, Valley{1, 0.5}}) {
    for (const double from : {0.3, 1.7}) {
      const double native = deepestSlide(valley, false, false, box, from);
      const double ours = deepestSlide(valley, false, true, box, from);
      const double onMesh = deepestSlide(valley, true, true, box, from);
      INFO("valley " << valley.left << " " << valley.right << " from " << from << ": dBox " << native << " field "
                     << ours << " mesh " << onMesh);
      CHECK(native > 0.001);
      CHECK(ours < 1.01 * native);
      CHECK(onMesh < 1.01 * native);
    }
  }
}
