// SPDX-License-Identifier: BSD-3-Clause
#include "support/pile_world.h"

#include "support/catch.h"

namespace otg::test {
namespace {

dSpaceID makeSpace(int spaceClass, dSpaceID parent) {
  const dVector3 center{0, 0, 2, 0}, extents{8, 8, 8, 0};
  switch (spaceClass) {
    case dSimpleSpaceClass:
      return dSimpleSpaceCreate(parent);
    case dSweepAndPruneSpaceClass:
      return dSweepAndPruneSpaceCreate(parent, dSAP_AXES_XYZ);
    case dQuadTreeSpaceClass:
      return dQuadTreeSpaceCreate(parent, center, extents, 4);
    default:
      return dHashSpaceCreate(parent);
  }
}

}  // namespace

PileWorld::PileWorld(const Choices& choices)
    : choices_(choices),
      world_(dWorldCreate()),
      space_(makeSpace(choices.spaceClass, nullptr)),
      joints_(dJointGroupCreate(0)) {
  dWorldSetGravity(world_, 0, 0, -9.81);
  dWorldSetERP(world_, 0.2);
  dWorldSetCFM(world_, 1e-5);
  dWorldSetContactMaxCorrectingVel(world_, 1);
  if (choices.nested) inner_ = dSimpleSpaceCreate(space_);
  data_.push_back(new Data(scenes::makeGround(8, 1, 4)));
  data_.push_back(new Data(scenes::makeLump(0.45, 2, 0.4, choices.seed)));
  data_.push_back(new Data(scenes::makeBox({0.6, 0.5, 0.7}, 2)));
  data_.push_back(new Data(scenes::makeTorus(0.4, 0.15, 14, 8)));
  geoms_.push_back(dCreateGpuTriMesh(space_, data_[0]->id));
  std::mt19937 random(choices.seed);
  for (int i = 0; i < choices.bodies; ++i) {
    const Data& mesh = *data_[1 + static_cast<std::size_t>(i % 3)];
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetGpuTriMeshDataTotal(&mass, 1, mesh.id);
    dMassTranslate(&mass, -mass.c[0], -mass.c[1], -mass.c[2]);
    dBodySetMass(body, &mass);
    const dGeomID geom = dCreateGpuTriMesh(choices.nested && i % 2 == 1 ? inner_ : space_, mesh.id);
    dGeomSetBody(geom, body);
    dBodySetPosition(body, 0.5 * (i % 3) - 0.5, 0.5 * (i / 3 % 3) - 0.5, 0.5 + 0.55 * (i / 9));
    dMatrix3 turn;
    randomRotation(turn, random);
    dBodySetRotation(body, turn);
    geoms_.push_back(geom);
  }
  for (const dGeomID geom : geoms_) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    if (choices.pairwise) params.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE;
    if (!choices.history) params.history = dGPUTRIMESH_HISTORY_OFF;
    dGeomGpuTriMeshSetParams(geom, &params);
  }
  if (choices.withShapes) addShapes();
}

PileWorld::~PileWorld() {
  dJointGroupDestroy(joints_);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
  for (const Data* data : data_) delete data;
}

void PileWorld::near(void* self, dGeomID o1, dGeomID o2) {
  auto& world = *static_cast<PileWorld*>(self);
  if (dGeomIsSpace(o1) || dGeomIsSpace(o2)) {
    dSpaceCollide2(o1, o2, self, &PileWorld::near);
    return;
  }
  ++world.collisions_;
  const auto contacts = joinContacts(world.world_, world.joints_, o1, o2, world.choices_.places);
  world.contacts_ += static_cast<int>(contacts.size());
}

void PileWorld::addShapes() {
  dCreatePlane(space_, 0, 0, 1, 0.05);
  for (const bool isBall : {false, true}) {
    const dBodyID body = dBodyCreate(world_);
    dGeomSetBody(isBall ? dCreateSphere(space_, 0.3) : dCreateBox(space_, 0.5, 0.4, 0.6), body);
    dBodySetPosition(body, isBall ? 0.2 : -0.3, 0.1, isBall ? 2 : 2.8);
  }
}

void PileWorld::collideAsArray() {
  std::vector<dContact> found(4000);
  const int count = dGpuTriMeshCollideSpace(space_, choices_.places, nullptr, nullptr, &found[0].geom, sizeof(dContact),
                                            static_cast<int>(found.size()));
  REQUIRE(count >= 0);
  REQUIRE(count < static_cast<int>(found.size()));
  for (int k = 0; k < count; ++k) joinContact(world_, joints_, found[static_cast<std::size_t>(k)].geom);
  contacts_ += count;
}

void PileWorld::step(int count, const std::function<void()>& before) {
  for (int i = 0; i < count; ++i) {
    if (before) before();
    if (choices_.asArray) {
      collideAsArray();
    } else {
      dSpaceCollide(space_, this, &PileWorld::near);
      if (inner_ != nullptr) dSpaceCollide(inner_, this, &PileWorld::near);
    }
    dWorldStep(world_, 0.005);
    dJointGroupEmpty(joints_);
  }
}

std::vector<unsigned char> PileWorld::bytes() const {
  return stateOf(geoms_);
}

dGpuTriMeshStats PileWorld::stats() const {
  dGpuTriMeshStats sum;
  dGpuTriMeshStatsInit(&sum);
  for (const dGeomID geom : geoms_) {
    dGpuTriMeshStats s;
    dGpuTriMeshStatsInit(&s);
    dGeomGpuTriMeshGetStats(geom, &s);
    sum.queries += s.queries;
    sum.failed_queries += s.failed_queries;
    sum.box_tests += s.box_tests;
    sum.candidate_pairs += s.candidate_pairs;
    sum.intersecting_pairs += s.intersecting_pairs;
    sum.decided_by_double += s.decided_by_double;
    sum.decided_exactly += s.decided_exactly;
    sum.contacts_before_reduction += s.contacts_before_reduction;
    sum.contacts += s.contacts;
    sum.prefetched += s.prefetched;
    sum.on_device += s.on_device;
    sum.device_failures += s.device_failures;
  }
  return sum;
}

}  // namespace otg::test
