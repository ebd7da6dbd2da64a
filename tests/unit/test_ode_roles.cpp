// SPDX-License-Identifier: BSD-3-Clause
// One geometry has one answer: contacts depend neither on the order of creation nor on how vertices came, and a pair
// that remembers keeps its roles.
#include <memory>

#include "base/vectors.h"
#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

void useHistory(dGeomID g, int history) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.history = history;
  REQUIRE(dGeomGpuTriMeshSetParams(g, &params) == dGPUTRIMESH_OK);
}

/// The same places, depths, normals and triangles, and geoms where they belong, to the last bit.
bool same(const std::vector<dContactGeom>& a, dGeomID firstOfA, const std::vector<dContactGeom>& b, dGeomID firstOfB) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].g1 != firstOfA || b[i].g1 != firstOfB || a[i].depth != b[i].depth) return false;
    if (a[i].side1 != b[i].side1 || a[i].side2 != b[i].side2) return false;
    for (int k = 0; k < 3; ++k) {
      if (a[i].pos[k] != b[i].pos[k] || a[i].normal[k] != b[i].normal[k]) return false;
    }
  }
  return true;
}

struct Body {
  const char* what;
  scenes::MeshArrays first, second;
};

std::vector<Body> bodies() {
  scenes::MeshArrays turned = scenes::makeLump(1, 2, 0.3, 5);
  for (Vec3f& v : turned.vertices) v = {-v.y, v.x, v.z};
  return {{"a box in a lump", scenes::makeLump(1, 2, 0.3, 5), scenes::makeBox({1, 1, 1}, 2)},
          {"lumps of as many triangles", scenes::makeLump(1, 2, 0.3, 5), scenes::makeLump(1, 2, 0.3, 6)},
          {"a lump and itself turned", scenes::makeLump(1, 2, 0.3, 5), turned},
          {"equal boxes", scenes::makeBox({1, 1, 1}), scenes::makeBox({1, 1, 1})}};
}

/// A geom of a mesh, built with it or moved to it, scaled or not.
struct Made {
  Made(const scenes::MeshArrays& mesh, bool byUpdate, double scale) {
    scenes::MeshArrays before = mesh;
    if (byUpdate) {
      for (Vec3f& v : before.vertices) v = {0.4F * v.x - 0.9F * v.y, 0.9F * v.x + 0.4F * v.y, 2 * v.z};
    }
    data = std::make_unique<Data>(before);
    if (byUpdate) {
      REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(data->id, mesh.vertices.data(), sizeof(Vec3f),
                                                  static_cast<int>(mesh.vertices.size())) == dGPUTRIMESH_OK);
    }
    geom = std::make_unique<Geom>(*data);
    useHistory(geom->id, dGPUTRIMESH_HISTORY_OFF);
    REQUIRE(dGeomGpuTriMeshSetScale(geom->id, scale, scale, scale) == dGPUTRIMESH_OK);
  }
  std::unique_ptr<Data> data;
  std::unique_ptr<Geom> geom;
};

/// Whether the geom that remembers the pair is mesh A of it, as the saved history has it.
bool isHolderA(dGeomID g, dGeomID h) {
  const dGeomID geoms[] = {g, h};
  std::vector<unsigned char> bytes(dGpuTriMeshHistorySave(geoms, 2, nullptr, 0));
  REQUIRE(dGpuTriMeshHistorySave(geoms, 2, bytes.data(), bytes.size()) == bytes.size());
  REQUIRE(bytes[16] == 1);  // one pair
  return bytes[32] == 1;
}

}  // namespace

TEST_CASE("contacts don't depend on which geom was created first, nor on whether vertices came by an update") {
  const OdeSession session;
  for (const Body& body : bodies()) {
    for (const double scale : {1.0, 0.75}) {
      const Made first(body.first, false, scale), second(body.second, false, 1);
      const Made laterFirst(body.first, true, scale);  // created after its partner
      std::mt19937 random(3);
      int contacts = 0, different = 0;
      for (int i = 0; i < 40; ++i) {
        setRandomPose(first.geom->id, random, 0.5);
        setRandomPose(second.geom->id, random, 0.5);
        dGeomSetRotation(laterFirst.geom->id, dGeomGetRotation(first.geom->id));
        const dReal* const at = dGeomGetPosition(first.geom->id);
        dGeomSetPosition(laterFirst.geom->id, at[0], at[1], at[2]);
        const auto x = collide(first.geom->id, second.geom->id);
        const auto y = collide(laterFirst.geom->id, second.geom->id);
        contacts += static_cast<int>(x.size());
        different += !same(x, first.geom->id, y, laterFirst.geom->id);
        CHECK(sameContacts(collide(second.geom->id, laterFirst.geom->id), mirrored(y)));
      }
      INFO(body.what << ", scale " << scale);
      CHECK(contacts > 100);
      CHECK(different == 0);
    }
  }
}

TEST_CASE("a pair that remembers keeps its roles, and one that has parted gets new ones") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom older(box), younger(box);
  const auto at = [&](double x) {
    dGeomSetPosition(younger.id, x, 0.1, 0.05);
    return collide(older.id, younger.id).size();
  };
  REQUIRE(at(0.9) > 0);
  CHECK_FALSE(isHolderA(older.id, younger.id));  // the older one lies before the other
  for (double x = 0.8; x > -0.95; x -= 0.05) {   // through the other and out again, in small steps
    REQUIRE(at(x) > 0);
    CHECK_FALSE(isHolderA(older.id, younger.id));
  }
  CHECK(at(-1.5) == 0);
  REQUIRE(at(-0.9) > 0);
  CHECK(isHolderA(older.id, younger.id));
}
