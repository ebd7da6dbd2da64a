// SPDX-License-Identifier: BSD-3-Clause
// Solids that share faces, in random poses: contacts, overlap, distance and points inside never contradict each other.
#include "support/catch.h"
#include "support/flush_pairs.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr int kPoses = 40;

int inside(dGeomID g, const dVector3& point) {
  unsigned char answer = 0;
  REQUIRE(dGeomGpuTriMeshPointsInside(g, point, sizeof(dVector3), 1, &answer) >= 0);
  return answer;
}

double distanceOf(dGeomID g, dGeomID h) {
  dGpuTriMeshDistance found;
  REQUIRE(dGpuTriMeshGetDistance(g, h, dInfinity, &found) == dGPUTRIMESH_OK);
  return found.distance;
}

/// What is wrong with the answers about one pair.
struct Faults {
  int none = 0, overlap = 0, distance = 0, points = 0, tooDeep = 0;
};

void check(const FlushPair& pair, dGeomID first, dGeomID second, const dVector3& point, Faults& faults) {
  const auto contacts = collide(first, second, 64);
  const int overlap = dGpuTriMeshOverlap(first, second);
  const double distance = distanceOf(first, second);
  REQUIRE(overlap >= 0);
  if (pair.nested) {
    faults.none += contacts.empty();
    faults.overlap += overlap != 1;
    faults.distance += distance != 0;
    faults.points += inside(first, point) != 1;
  } else {
    faults.overlap += !contacts.empty() && overlap != 1;
    faults.distance += overlap == 1 ? distance != 0 : !(distance < 1e-12);
    faults.points += inside(first, point) != 0;
    // Round a corner rounding makes a region of no thickness on two walls: only one face says how deep it is.
    for (const dContactGeom& c : contacts) faults.tooDeep += pair.onOneFace && c.depth > 1e-9;
  }
  faults.overlap += dGpuTriMeshOverlap(second, first) != overlap;
  faults.distance += distanceOf(second, first) != distance;
  faults.points += inside(second, point) != 1;
}

}  // namespace

TEST_CASE("answers about solids that share faces agree in any pose and order of creation") {
  const OdeSession session;
  std::mt19937 random(17);
  int poses = 0;
  for (const FlushPair& pair : flushPairs()) {
    // Half of the time the second body has an origin of its own, and its pose is rounded.
    const Vec3d origin{0.5, -0.25, 0.125};
    const Data dataOfFirst(pair.first), dataOfSecond(pair.second), shifted(moved(pair.second, otgScale(origin, -1.0)));
    Faults faults;
    for (const bool secondFirst : {false, true, false, true}) {
      const bool isShifted = poses % (4 * kPoses) >= 2 * kPoses;
      const Data& ofSecond = isShifted ? shifted : dataOfSecond;
      const Geom older(secondFirst ? ofSecond : dataOfFirst), younger(secondFirst ? dataOfFirst : ofSecond);
      const dGeomID first = secondFirst ? younger.id : older.id, second = secondFirst ? older.id : younger.id;
      for (const dGeomID g : {first, second}) {
        dGpuTriMeshParams params;
        dGpuTriMeshParamsInit(&params);
        params.history = dGPUTRIMESH_HISTORY_OFF;
        REQUIRE(dGeomGpuTriMeshSetParams(g, &params) == dGPUTRIMESH_OK);
      }
      for (int i = 0; i < kPoses; ++i, ++poses) {
        setRandomPose(first, random, i % 3 == 0 ? 1000 : 2);
        if (i == 0) {  // aligned exactly
          dMatrix3 none;
          dRSetIdentity(none);
          dGeomSetRotation(first, none);
          dGeomSetPosition(first, 0, 0, 0);
        }
        dGeomSetRotation(second, dGeomGetRotation(first));
        dVector3 point;
        const Vec3d from = isShifted ? origin : Vec3d{0, 0, 0};
        dGeomGetRelPointPos(first, from.x, from.y, from.z, point);
        dGeomSetPosition(second, point[0], point[1], point[2]);
        dGeomGetRelPointPos(first, pair.point.x, pair.point.y, pair.point.z, point);
        check(pair, first, second, point, faults);
      }
    }
    INFO(pair.what);
    CHECK(faults.none == 0);
    CHECK(faults.overlap == 0);
    CHECK(faults.distance == 0);
    CHECK(faults.points == 0);
    CHECK(faults.tooDeep == 0);
  }
  CHECK(poses >= 1000);
}
