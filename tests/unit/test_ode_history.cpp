// SPDX-License-Identifier: BSD-3-Clause
// A simulation that is saved with its history and reloaded continues with the same bytes; bytes that are not what was
// saved are refused.
#include <array>
#include <cstring>

#include "base/hash.h"
#include "scenes/height_grid.h"
#include "support/catch.h"
#include "support/ode_world.h"
#include "support/part_of.h"

using namespace otg;
using namespace otg::test;

namespace {

struct BodyState {
  std::array<dReal, 3> position, velocity, spin;
  std::array<dReal, 4> rotation;
};

/// Lumps that begin entangled, pressed together by gravity on a ground: escapes and clamps are at work for a long time.
class World {
 public:
  /// With geoms of ODE's own: the ground a heightfield, and a box and a cylinder among the lumps.
  explicit World(bool withOde = false)
      : world_(dWorldCreate()),
        joints_(dJointGroupCreate(0)),
        ground_(scenes::makeGround(6, 1, 2)),
        lump_(scenes::makeLump(0.5, 3, 0.5, 4)) {
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, 1e-5);
    dWorldSetContactMaxCorrectingVel(world_, 0.2);  // they shall take their time
    if (withOde) {
      field_ = dGeomHeightfieldDataCreate();
      REQUIRE(dGpuTriMeshHeightfieldDataBuildSingle(field_, heights_, 1, 6, 6, 3, 3, 1, 0, 1, 0) == dGPUTRIMESH_OK);
      geoms.push_back(dCreateHeightfield(nullptr, field_, 1));
      dMatrix3 upright;
      dRFromAxisAndAngle(upright, 1, 0, 0, M_PI / 2);
      dGeomSetRotation(geoms.back(), upright);
      for (const bool round : {false, true}) {
        const dBodyID body = dBodyCreate(world_);
        dMass mass;
        dMassSetBoxTotal(&mass, 1, 0.5, 0.5, 0.5);
        dBodySetMass(body, &mass);
        geoms.push_back(round ? dCreateCylinder(nullptr, 0.3, 0.6) : dCreateBox(nullptr, 0.6, 0.5, 0.4));
        dGeomSetBody(geoms.back(), body);
        dBodySetPosition(body, round ? 0.2 : -0.1, round ? 0.1 : -0.15, round ? 0.8 : 0.5);
      }
    } else {
      geoms.push_back(dCreateGpuTriMesh(nullptr, ground_.id));
    }
    for (int i = 0; i < 3; ++i) {
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      dMassSetGpuTriMeshDataTotal(&mass, 1, lump_.id);
      dMassTranslate(&mass, -mass.c[0], -mass.c[1], -mass.c[2]);
      dBodySetMass(body, &mass);
      geoms.push_back(dCreateGpuTriMesh(nullptr, lump_.id));
      dGeomSetBody(geoms.back(), body);
      dBodySetPosition(body, 0.1 * i, 0.05 * i, 0.55 + 0.3 * i);
      dMatrix3 turn;
      dRFromAxisAndAngle(turn, 1, 2, 3, 0.7 * i);
      dBodySetRotation(body, turn);
    }
  }
  ~World() {
    dJointGroupDestroy(joints_);
    for (const dGeomID geom : geoms) dGeomDestroy(geom);
    dGpuTriMeshHeightfieldDataDestroy(field_);
    dWorldDestroy(world_);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void step(int count) {
    for (int s = 0; s < count; ++s) {
      dJointGroupEmpty(joints_);
      for (std::size_t i = 0; i < geoms.size(); ++i) {
        for (std::size_t k = i + 1; k < geoms.size(); ++k) {
          for (const dContactGeom& geom : test::collide(geoms[i], geoms[k], 32)) {
            dContact contact{};
            contact.surface.mode = dContactApprox1;
            contact.surface.mu = 0.5;
            contact.geom = geom;
            dJointAttach(dJointCreateContact(world_, joints_, &contact), dGeomGetBody(geom.g1), dGeomGetBody(geom.g2));
          }
        }
      }
      dWorldStep(world_, 0.005);
    }
  }
  std::vector<BodyState> save() const {
    std::vector<BodyState> states;
    for (std::size_t i = 1; i < geoms.size(); ++i) {
      const dBodyID b = dGeomGetBody(geoms[i]);
      BodyState& s = states.emplace_back();
      std::copy_n(dBodyGetPosition(b), 3, s.position.begin());
      std::copy_n(dBodyGetLinearVel(b), 3, s.velocity.begin());
      std::copy_n(dBodyGetAngularVel(b), 3, s.spin.begin());
      std::copy_n(dBodyGetQuaternion(b), 4, s.rotation.begin());
    }
    return states;
  }
  void load(const std::vector<BodyState>& states) {
    for (std::size_t i = 1; i < geoms.size(); ++i) {
      const dBodyID b = dGeomGetBody(geoms[i]);
      const BodyState& s = states[i - 1];
      dBodySetPosition(b, s.position[0], s.position[1], s.position[2]);
      dBodySetQuaternion(b, s.rotation.data());
      dBodySetLinearVel(b, s.velocity[0], s.velocity[1], s.velocity[2]);
      dBodySetAngularVel(b, s.spin[0], s.spin[1], s.spin[2]);
    }
  }
  std::vector<unsigned char> history() const {
    std::vector<unsigned char> bytes(dGpuTriMeshHistorySave(geoms.data(), count(), nullptr, 0));
    CHECK(dGpuTriMeshHistorySave(geoms.data(), count(), bytes.data(), bytes.size()) == bytes.size());
    return bytes;
  }
  int loadHistory(const std::vector<unsigned char>& bytes) const {
    return dGpuTriMeshHistoryLoad(geoms.data(), count(), bytes.data(), bytes.size());
  }
  int count() const { return static_cast<int>(geoms.size()); }

  std::vector<dGeomID> geoms;

 private:
  dWorldID world_;
  dJointGroupID joints_;
  Data ground_, lump_;
  const float heights_[9] = {0, 0, 0, 0, -0.2f, 0, 0, 0, 0};
  dHeightfieldDataID field_ = nullptr;
};

bool same(const std::vector<BodyState>& a, const std::vector<BodyState>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(BodyState)) == 0;
}

}  // namespace

TEST_CASE("a run that is saved and reloaded continues with the same bytes") {
  const OdeSession session;
  const bool withOde = GENERATE(false, true);
  INFO("with geoms of ODE's own: " << withOde);
  World first(withOde);
  const int steps = partOf(200);
  first.step(withOde ? 20 : steps);
  const std::vector<BodyState> saved = first.save();
  const std::vector<unsigned char> history = first.history();
  first.load(saved);  // dBodySetQuaternion may change the last bit
  first.step(steps);
  const std::vector<BodyState> end = first.save();

  World second(withOde);
  second.load(saved);
  REQUIRE(second.loadHistory(history) == dGPUTRIMESH_OK);
  CHECK(second.history() == history);
  second.step(steps);
  CHECK(same(second.save(), end));
  CHECK(second.history() == first.history());

  // That the history mattered: without it the same states go on differently.
  World without(withOde);
  without.load(saved);
  without.step(steps);
  CHECK_FALSE(same(without.save(), end));

  // And forgetting is the same as never having known.
  for (const dGeomID geom : second.geoms) {
    const bool isMesh = dGeomGetClass(geom) == dGpuTriMeshGetClass();
    REQUIRE(dGeomGpuTriMeshForgetHistory(geom) == (isMesh ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_CLASS));
  }
  second.load(saved);
  second.step(steps);
  CHECK(same(second.save(), without.save()));
}

TEST_CASE("how deep a box was in a sheet is saved and loaded") {
  const OdeSession session;
  scenes::HeightGrid grid;
  grid.sizeX = grid.sizeY = 4;
  grid.columns = grid.rows = 3;
  scenes::setHeights(grid, [](double, double) { return 0.0; });
  const Data sheet(scenes::sheetOf(grid)), box(scenes::makeBox({1, 1, 1}, 1));
  const Geom a(sheet), b(box);
  const dGeomID geoms[] = {a.id, b.id};
  const auto saved = [&] {
    std::vector<unsigned char> bytes(dGpuTriMeshHistorySave(geoms, 2, nullptr, 0));
    REQUIRE(dGpuTriMeshHistorySave(geoms, 2, bytes.data(), bytes.size()) == bytes.size());
    return bytes;
  };
  dGeomSetPosition(b.id, 0.1, 0.2, 0.4995);
  const std::vector<dContactGeom> contacts = test::collide(a.id, b.id, 16);
  REQUIRE_FALSE(contacts.empty());
  double deepest = 0;  // before the hash, and the content of the two meshes
  const std::vector<unsigned char> bytes = saved();
  std::memcpy(&deepest, bytes.data() + bytes.size() - 8 - 8 - sizeof deepest, sizeof deepest);
  CHECK(deepest > 0.0004);
  CHECK(deepest < 0.0006);
  REQUIRE(dGeomGpuTriMeshForgetHistory(b.id) == dGPUTRIMESH_OK);
  REQUIRE(saved() != bytes);
  REQUIRE(dGpuTriMeshHistoryLoad(geoms, 2, bytes.data(), bytes.size()) == dGPUTRIMESH_OK);
  CHECK(saved() == bytes);
}

TEST_CASE("the bytes do not depend on the machine") {
  const OdeSession session;
  const Data small(scenes::makeBox({1, 1, 1}, 1)), large(scenes::makeBox({4, 4, 4}, 2));
  const Geom a(small), b(large);
  dGeomSetPosition(b.id, 1, 0.25, 0.125);
  REQUIRE_FALSE(test::collide(a.id, b.id, 16).empty());
  const dGeomID geoms[] = {b.id, a.id};
  unsigned char bytes[512];
  const dsizeint size = dGpuTriMeshHistorySave(geoms, 2, bytes, sizeof bytes);
  REQUIRE(size == 8 + 4 + 4 + 4 + 8 + 4 + 4 + 24 + 2 * (24 + 4 + 4 + 24 + 96 + 4 + 4 + 4 + 24 + 8 + 8) + 8);
  const unsigned char head[] = {'O', 'T', 'G', 'H', 'I', 'S', 'T', 0, 6, 0, 0, 0, 2, 0, 0, 0,
                                1,   0,   0,   0,   0,   0,   0,   0, 1, 0, 0, 0, 0, 0, 0, 0};
  CHECK(std::memcmp(bytes, head, sizeof head) == 0);
  // The current state ends with the pose of the large box, (1, 0.25, 0.125), hasPose, not jammed, and no side of a
  // shell: 0, written as 1, and a point at the origin. Of two solids no depth is kept, -1, for no content.
  const unsigned char tail[] = {0, 0, 0, 0, 0,    0,    0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0xd0, 0x3f, 0, 0,
                                0, 0, 0, 0, 0xc0, 0x3f, 1,    0,    0, 0, 0, 0, 0, 0, 1,    0,    0, 0};
  CHECK(std::memcmp(bytes + size - 8 - 16 - 24 - sizeof tail, tail, sizeof tail) == 0);
  const unsigned char last[24 + 16] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,    0,
                                       0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0xbf};
  CHECK(std::memcmp(bytes + size - 8 - sizeof last, last, sizeof last) == 0);
}

TEST_CASE("bytes that are not what was saved, or for other geoms, are refused and change nothing") {
  const OdeSession session;
  World world;
  world.step(40);
  const std::vector<unsigned char> good = world.history();
  REQUIRE(good.size() > 100);
  World other;
  other.step(20);
  const std::vector<unsigned char> before = other.history();
  REQUIRE(before != good);
  for (std::size_t length = 0; length < good.size(); length += 7) {
    CHECK(other.loadHistory({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)}) ==
          dGPUTRIMESH_ERROR_ARGUMENT);
  }
  for (std::size_t at = 0; at < good.size(); at += 3) {
    std::vector<unsigned char> bad = good;
    bad[at] ^= 0x10;
    CHECK(other.loadHistory(bad) == dGPUTRIMESH_ERROR_ARGUMENT);
  }
  std::vector<unsigned char> longer = good;
  longer.push_back(0);
  CHECK(other.loadHistory(longer) == dGPUTRIMESH_ERROR_ARGUMENT);
  // With the right checksum, too: something behind the pairs, or a pair that ends too soon.
  const auto withChecksum = [](std::vector<unsigned char> content) {
    std::uint64_t sum = fnv1a(content.data(), content.size());
    for (int i = 0; i < 8; ++i, sum >>= 8) content.push_back(static_cast<unsigned char>(sum));
    return content;
  };
  const std::vector<unsigned char> content(good.begin(), good.end() - 8);
  REQUIRE(withChecksum(content) == good);
  for (std::ptrdiff_t cut = 1; cut < 40; ++cut) {
    CHECK(other.loadHistory(withChecksum({content.begin(), content.end() - cut})) == dGPUTRIMESH_ERROR_ARGUMENT);
    std::vector<unsigned char> more = content;
    more.resize(content.size() + static_cast<std::size_t>(cut), 0);
    CHECK(other.loadHistory(withChecksum(more)) == dGPUTRIMESH_ERROR_ARGUMENT);
  }
  CHECK(other.history() == before);

  const auto load = [&](const std::vector<dGeomID>& geoms) {
    return dGpuTriMeshHistoryLoad(geoms.data(), static_cast<int>(geoms.size()), good.data(), good.size());
  };
  std::vector<dGeomID> geoms = other.geoms;
  geoms.pop_back();
  CHECK(load(geoms) == dGPUTRIMESH_ERROR_ARGUMENT);
  geoms = other.geoms;
  std::swap(geoms[1], geoms[2]);  // another one of the pair was created first
  CHECK(load(geoms) == dGPUTRIMESH_ERROR_ARGUMENT);
  geoms = other.geoms;
  geoms[1] = nullptr;
  CHECK(load(geoms) == dGPUTRIMESH_ERROR_ARGUMENT);
  geoms[1] = geoms[2];
  CHECK(load(geoms) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshHistoryLoad(nullptr, 4, good.data(), good.size()) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshHistoryLoad(other.geoms.data(), -1, good.data(), good.size()) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshHistoryLoad(other.geoms.data(), other.count(), nullptr, 0) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(other.history() == before);
  CHECK(load(other.geoms) == dGPUTRIMESH_OK);
  CHECK(other.history() == good);

  // Saving: a list that is none; too small a buffer stays as it is; geoms of other classes are passed over.
  CHECK(dGpuTriMeshHistorySave(nullptr, 1, nullptr, 0) == 0);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshHistorySave(geoms.data(), 4, nullptr, 0) == 0);  // one is listed twice
  std::vector<unsigned char> buffer(good.size() - 1, 0xaa);
  CHECK(dGpuTriMeshHistorySave(world.geoms.data(), world.count(), buffer.data(), buffer.size()) == good.size());
  CHECK(buffer == std::vector<unsigned char>(good.size() - 1, 0xaa));
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  const dGeomID mixed[] = {sphere, nullptr};
  CHECK(dGpuTriMeshHistorySave(mixed, 2, nullptr, 0) == 28);
  CHECK(dGpuTriMeshHistorySave(nullptr, 0, nullptr, 0) == 28);
  CHECK(dGeomGpuTriMeshForgetHistory(sphere) == dGPUTRIMESH_ERROR_CLASS);
  dGeomDestroy(sphere);
}
