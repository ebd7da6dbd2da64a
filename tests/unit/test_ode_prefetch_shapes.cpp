// SPDX-License-Identifier: BSD-3-Clause
// Prefetching pairs of a mesh and a geom of ODE's own: the same bytes as without, and what differs is computed.
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "scenes/convex_geom.h"
#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

scenes::MeshArrays tetrahedron() {
  return scenes::makeTetrahedron({0.5, 0.5, 0.5}, {-0.5, -0.5, 0.5}, {-0.5, 0.5, -0.5}, {0.5, -0.5, -0.5});
}

enum class Kind { kSphere, kBox, kCapsule, kCylinder, kConvex, kPlane };
constexpr Kind kKinds[] = {Kind::kSphere, Kind::kBox, Kind::kCapsule, Kind::kCylinder, Kind::kConvex, Kind::kPlane};

dGeomID makeShape(Kind kind, dSpaceID space, const scenes::ConvexData& convex) {
  switch (kind) {
    case Kind::kSphere:
      return dCreateSphere(space, 0.3);
    case Kind::kBox:
      return dCreateBox(space, 0.5, 0.4, 0.6);
    case Kind::kCapsule:
      return dCreateCapsule(space, 0.2, 0.4);
    case Kind::kCylinder:
      return dCreateCylinder(space, 0.25, 0.4);
    case Kind::kConvex:
      return convex.makeGeom(space);
    default:
      return dCreatePlane(space, 0, 0, 1, -1.2);
  }
}

scenes::MeshArrays hills() {
  scenes::MeshArrays ground =
      scenes::makeGround(8, 1, 24, [](double x, double y) { return 0.25 * std::cos(1.7 * x) * std::cos(1.3 * y); });
  return ground;
}

/// Shapes and two meshes that fall on hills, which are a mesh, with a plane below; geoms with offsets among them.
class ShapeWorld {
 public:
  struct Choices {
    int spaceClass = dHashSpaceClass;
    int places = 24;
    bool nested = false, pairwise = false, history = true;
  };
  explicit ShapeWorld(const Choices& choices) : choices_(choices) {
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, 1e-5);
    const dVector3 center{0, 0, 0, 0}, extents{8, 8, 8, 0};
    space_ = choices.spaceClass == dSimpleSpaceClass          ? dSimpleSpaceCreate(nullptr)
             : choices.spaceClass == dSweepAndPruneSpaceClass ? dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ)
             : choices.spaceClass == dQuadTreeSpaceClass      ? dQuadTreeSpaceCreate(nullptr, center, extents, 4)
                                                              : dHashSpaceCreate(nullptr);
    inner_ = choices.nested ? dSimpleSpaceCreate(space_) : nullptr;
    geoms_.push_back(dCreateGpuTriMesh(space_, ground_.id));
    geoms_.push_back(makeShape(Kind::kPlane, space_, convex_));
    std::mt19937 random(7);
    for (int i = 0; i < 14; ++i) {
      const dSpaceID space = choices.nested && i % 2 == 1 ? inner_ : space_;
      const dGeomID geom = i % 7 < 5 ? makeShape(kKinds[i % 7], space, convex_)
                                     : dCreateGpuTriMesh(space, i % 7 == 5 ? lump_.id : box_.id);
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      dMassSetBoxTotal(&mass, 1, 0.5, 0.5, 0.5);
      dBodySetMass(body, &mass);
      dGeomSetBody(geom, body);
      if (i % 3 == 1) dGeomSetOffsetPosition(geom, 0.05, 0, 0.02);
      dBodySetPosition(body, 0.6 * (i % 4) - 0.9, 0.6 * (i / 4) - 0.9, 0.6 + 0.05 * (i % 3));
      dMatrix3 turn;
      randomRotation(turn, random);
      dBodySetRotation(body, turn);
      dBodySetAngularVel(body, 1, -0.5 * (i % 3), 0.2);
      geoms_.push_back(geom);
    }
    for (const dGeomID geom : geoms_) {
      if (dGeomGetClass(geom) != dGpuTriMeshGetClass()) continue;
      dGpuTriMeshParams params;
      dGpuTriMeshParamsInit(&params);
      if (choices.pairwise) params.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE;
      if (!choices.history) params.history = dGPUTRIMESH_HISTORY_OFF;
      dGeomGpuTriMeshSetParams(geom, &params);
    }
  }
  ~ShapeWorld() {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  ShapeWorld(const ShapeWorld&) = delete;
  ShapeWorld& operator=(const ShapeWorld&) = delete;

  void step(const std::function<void()>& before = {}) {
    if (before) before();
    dSpaceCollide(space_, this, &ShapeWorld::near);
    if (inner_ != nullptr) dSpaceCollide(inner_, this, &ShapeWorld::near);
    dWorldStep(world_, 0.005);
    dJointGroupEmpty(joints_);
  }
  /// Everything that a step depends on, and the contacts so far.
  std::vector<unsigned char> bytes() {
    std::vector<unsigned char> all = contacts_, state = stateOf(geoms_);
    all.insert(all.end(), state.begin(), state.end());
    return all;
  }
  dGpuTriMeshStats groundStats() const { return statsOf(geoms_[0]); }
  dSpaceID space() const { return space_; }
  int collisions() const { return collisions_; }

 private:
  static void near(void* self, dGeomID o1, dGeomID o2) {
    auto& world = *static_cast<ShapeWorld*>(self);
    if (dGeomIsSpace(o1) || dGeomIsSpace(o2)) {
      dSpaceCollide2(o1, o2, self, &ShapeWorld::near);
      return;
    }
    ++world.collisions_;
    appendPositions(joinContacts(world.world_, world.joints_, o1, o2, world.choices_.places), world.contacts_);
  }
  Choices choices_;
  scenes::ConvexData convex_{tetrahedron()};
  Data ground_{hills()}, lump_{scenes::makeLump(0.4, 2, 0.3, 2)}, box_{scenes::makeBox({0.5, 0.4, 0.6}, 2)};
  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = nullptr, inner_ = nullptr;
  dJointGroupID joints_ = dJointGroupCreate(0);
  std::vector<dGeomID> geoms_;
  std::vector<unsigned char> contacts_;
  int collisions_ = 0;
};

/// A mesh and a shape in a space, and a second such pair that nobody prefetches.
struct Twins {
  Data lump{scenes::makeLump(0.5, 3, 0.4, 4)};
  scenes::ConvexData convex{tetrahedron()};
  dSpaceID space = dSimpleSpaceCreate(nullptr);
  dWorldID world = dWorldCreate();
  Kind kind;
  dGeomID mesh[2], shape[2];
  dBodyID body[2] = {};
  explicit Twins(Kind k) : kind(k) {
    for (int i = 0; i < 2; ++i) {
      mesh[i] = dCreateGpuTriMesh(i == 0 ? space : nullptr, lump.id);
      shape[i] = makeShape(kind, i == 0 ? space : nullptr, convex);
      if (kind == Kind::kPlane) {
        dGeomPlaneSetParams(shape[i], 0, 0, 1, -0.2);
        continue;
      }
      body[i] = dBodyCreate(world);
      dGeomSetBody(shape[i], body[i]);
      dBodySetPosition(body[i], 0.3, 0.2, 0.25);
    }
  }
  ~Twins() {
    dGeomDestroy(mesh[1]);
    dGeomDestroy(shape[1]);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  Twins(const Twins&) = delete;
  Twins& operator=(const Twins&) = delete;

  void both(const std::function<void(int)>& change) {
    change(0);
    change(1);
  }
  /// Collides both pairs, which must give the same, and says whether the first one's contacts were ready.
  bool taken(int capacity = 64) {
    const duint64 before = statsOf(mesh[0]).prefetched;
    std::vector<dContactGeom> ahead = test::collide(mesh[0], shape[0], capacity);
    std::vector<dContactGeom> plain = test::collide(mesh[1], shape[1], capacity);
    for (dContactGeom& c : plain) {
      c.g1 = mesh[0];
      c.g2 = shape[0];
    }
    CHECK(!ahead.empty());
    CHECK(sameContacts(ahead, plain));
    CHECK(statsOf(mesh[0]).contacts == statsOf(mesh[1]).contacts);
    CHECK(statsOf(mesh[0]).queries == statsOf(mesh[1]).queries);
    return statsOf(mesh[0]).prefetched == before + 1;
  }
};

}  // namespace

TEST_CASE("a world of shapes with and without prefetch gives the same bytes") {
  const OdeSession session;
  std::vector<ShapeWorld::Choices> all(7);
  all[1].spaceClass = dSimpleSpaceClass;
  all[2].spaceClass = dSweepAndPruneSpaceClass;
  all[3].spaceClass = dQuadTreeSpaceClass;
  all[4].nested = true;
  all[5].pairwise = true;
  all[5].places = 5;
  all[6].history = false;
  all[6].places = 3;  // what is ready has to be cut
  for (std::size_t i = 0; i < all.size(); ++i) {
    INFO("choice " << i);
    ShapeWorld plain(all[i]), ahead(all[i]);
    for (int step = 0; step < 100; ++step) {
      CHECK(dGpuTriMeshSetThreadCount(1 + step % 3) == dGPUTRIMESH_OK);
      plain.step();
      ahead.step([&] { CHECK(dGpuTriMeshPrefetch(ahead.space()) > 0); });
      if (step % 20 != 19) continue;
      const bool same = ahead.bytes() == plain.bytes();
      REQUIRE(same);
    }
    const dGpuTriMeshStats x = ahead.groundStats(), y = plain.groundStats();
    CHECK(x.queries == y.queries);
    CHECK(x.contacts == y.contacts);
    CHECK(x.contacts > (all[i].places < 24 ? 150u : 500u));
    CHECK(y.prefetched == 0);
    // Every collision of the ground found its contacts ready, but for those that had to be cut the first time.
    CHECK(x.prefetched + (all[i].places < 24 ? 40 : 0) >= x.queries);
  }
  CHECK(dGpuTriMeshSetThreadCount(0) == dGPUTRIMESH_OK);
}

TEST_CASE("whatever differs from a prefetched shape is computed") {
  const OdeSession session;
  for (const Kind kind : kKinds) {
    INFO("kind " << static_cast<int>(kind));
    Twins pair(kind);
    const auto prefetch = [&] { CHECK(dGpuTriMeshPrefetch(pair.space) == 1); };
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
    CHECK(pair.taken());  // as often as it is asked for
    for (const int capacity : {1, 2, 3, 5, 8}) {
      if (kind == Kind::kSphere || kind == Kind::kPlane) CHECK(pair.taken(capacity));
      pair.taken(capacity);  // others are cut as they are computed, and are computed for as many the next time
      prefetch();
      CHECK(pair.taken(capacity));
    }
    pair.taken(64);
    prefetch();
    CHECK(sameContacts(test::collide(pair.shape[0], pair.mesh[0], 64),
                       mirrored(test::collide(pair.mesh[0], pair.shape[0], 64))));
    test::collide(pair.shape[1], pair.mesh[1], 64);
    test::collide(pair.shape[1], pair.mesh[1], 64);
    prefetch();  // nothing has moved: what is there is kept
    CHECK(pair.taken());
    // One bit of a pose or of the plane, and the mesh's pose.
    pair.both([&](int i) {
      if (kind == Kind::kPlane)
        dGeomPlaneSetParams(pair.shape[i], 0, 0, 1, std::nextafter(-0.2, 1));
      else
        dBodySetPosition(pair.body[i], std::nextafter(0.3, 1), 0.2, 0.25);
    });
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
    pair.both([&](int i) { dGeomSetPosition(pair.mesh[i], 0, 0, 0.01); });
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
    // The size.
    pair.both([&](int i) {
      if (kind == Kind::kSphere) dGeomSphereSetRadius(pair.shape[i], 0.31);
      if (kind == Kind::kBox) dGeomBoxSetLengths(pair.shape[i], 0.5, 0.41, 0.6);
      if (kind == Kind::kCapsule) dGeomCapsuleSetParams(pair.shape[i], 0.2, 0.41);
      if (kind == Kind::kCylinder) dGeomCylinderSetParams(pair.shape[i], 0.26, 0.4);
      if (kind == Kind::kPlane) dGeomPlaneSetParams(pair.shape[i], 0, 1, 0, -0.2);
    });
    if (kind == Kind::kConvex) pair.convex.points()[0] += 0.01;  // in place, of which ODE is not informed
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
    // Velocities, where contacts depend on them.
    if (kind != Kind::kPlane && kind != Kind::kSphere) {
      pair.both([&](int i) { dBodySetLinearVel(pair.body[i], 0, 0.5, 0); });
      CHECK(!pair.taken());
      prefetch();
      CHECK(pair.taken());
    }
    // Parameters.
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.contacts_per_region = 3;
    pair.both([&](int i) { dGeomGpuTriMeshSetParams(pair.mesh[i], &params); });
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
    params.max_contacts = 2;  // a cut list says nothing of others
    pair.both([&](int i) { dGeomGpuTriMeshSetParams(pair.mesh[i], &params); });
    prefetch();
    CHECK(pair.taken(2));
    pair.taken(1);
    params.max_contacts = 64;
    params.history = dGPUTRIMESH_HISTORY_OFF;
    pair.both([&](int i) { dGeomGpuTriMeshSetParams(pair.mesh[i], &params); });
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
    // The mesh.
    const scenes::MeshArrays moved = scenes::makeLump(0.51, 3, 0.4, 4);
    CHECK(dGpuTriMeshDataUpdateVerticesSingle(pair.lump.id, moved.vertices.data(), 0,
                                              static_cast<int>(moved.vertices.size())) == dGPUTRIMESH_OK);
    CHECK(!pair.taken());
    prefetch();
    CHECK(pair.taken());
  }
}

TEST_CASE("deep shapes on their way out, prefetched and not") {
  const OdeSession session;
  for (const Kind kind : {Kind::kBox, Kind::kCapsule, Kind::kCylinder, Kind::kConvex}) {
    INFO("kind " << static_cast<int>(kind));
    Twins pair(kind);
    for (int step = 0; step < 40; ++step) {
      pair.both([&](int i) {
        dBodySetPosition(pair.body[i], 0.05 + 0.005 * step, 0.02, 0.03);
        dBodySetLinearVel(pair.body[i], 1, 0, 0);
      });
      if (step % 3 != 2) CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
      CHECK(pair.taken() == (step % 3 != 2));
      const dGeomID geoms[2][2] = {{pair.mesh[0], pair.shape[0]}, {pair.mesh[1], pair.shape[1]}};
      std::vector<unsigned char> saved[2];
      for (int i = 0; i < 2; ++i) {
        saved[i].resize(dGpuTriMeshHistorySave(geoms[i], 2, nullptr, 0));
        dGpuTriMeshHistorySave(geoms[i], 2, saved[i].data(), saved[i].size());
      }
      CHECK(saved[0] == saved[1]);
    }
  }
}

TEST_CASE("which shapes are prefetched") {
  const OdeSession session;
  Twins pair(Kind::kBox);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  // Rays are as quick as the look-up, heights may change without a word, and the inside of a transform has no pose of
  // its own.
  dCreateRay(pair.space, 1);
  const float heights[4] = {0, 0, 0, 0};
  const dHeightfieldDataID field = dGeomHeightfieldDataCreate();
  dGpuTriMeshHeightfieldDataBuildSingle(field, heights, 0, 4, 4, 2, 2, 1, 0, 1, 0);
  const dGeomID ground = dCreateHeightfield(pair.space, field, 0);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  const dGeomID transform = dCreateGeomTransform(pair.space);
  dGeomTransformSetCleanup(transform, 1);
  dGeomTransformSetGeom(transform, dCreateSphere(nullptr, 0.3));
#pragma GCC diagnostic pop
  CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  CHECK(pair.taken());
  // Callbacks are asked when the pair is collided.
  dGeomGpuTriMeshSetCallback(pair.mesh[0], [](dGeomID, dGeomID, int) { return 1; });
  CHECK(dGpuTriMeshPrefetch(pair.space) == 0);
  CHECK(!pair.taken());
  dGeomGpuTriMeshSetCallback(pair.mesh[0], nullptr);
  // The filter is asked about them, too.
  int calls = 0;
  const auto refuse = [](void* data, dGeomID, dGeomID) {
    ++*static_cast<int*>(data);
    return 0;
  };
  CHECK(dGpuTriMeshPrefetchSpaces(&pair.space, 1, refuse, &calls) == 0);
  CHECK(calls == 1);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  // A pose that dCollide refuses; nobody has asked for it.
  dGeomSetPosition(pair.mesh[0], std::numeric_limits<dReal>::quiet_NaN(), 0, 0);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 0);
  CHECK(statsOf(pair.mesh[0]).failed_queries == 0);
  dGeomDestroy(ground);
  dGpuTriMeshHeightfieldDataDestroy(field);
}

TEST_CASE("threads find prefetched shapes of one mesh") {
  const OdeSession session;
  const Data ground(hills());
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  const dGeomID mesh = dCreateGpuTriMesh(space, ground.id);
  scenes::ConvexData convex{tetrahedron()};
  std::vector<dGeomID> shapes;
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    const dGeomID shape = makeShape(kKinds[i % 5], space, convex);
    dMatrix3 turn;
    randomRotation(turn, random);
    dGeomSetRotation(shape, turn);
    dGeomSetPosition(shape, 0.1 * (i % 8) * 4 - 1.5, 0.4 * (i / 8) - 1.5, 0.3);
    shapes.push_back(shape);
    dGeomSetCategoryBits(shape, 2);
    dGeomSetCollideBits(shape, 1);
  }
  dGeomSetCategoryBits(mesh, 1);
  std::vector<std::vector<dContactGeom>> plain;
  for (const dGeomID shape : shapes) plain.push_back(test::collide(mesh, shape, 32));
  dGeomGpuTriMeshForgetHistory(mesh);
  CHECK(dGpuTriMeshSetThreadCount(4) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshPrefetch(space) == 60);
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      dAllocateODEDataForThread(dAllocateMaskAll);
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        const std::size_t i = (k + 15 * t) % shapes.size();
        if (!sameContacts(test::collide(mesh, shapes[i], 32), plain[i])) ++wrong[t];
      }
      dCleanupODEAllDataForThread();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : wrong) CHECK(count == 0);
  CHECK(statsOf(mesh).prefetched >= 60);
  CHECK(dGpuTriMeshSetThreadCount(0) == dGPUTRIMESH_OK);
  dSpaceDestroy(space);
}
