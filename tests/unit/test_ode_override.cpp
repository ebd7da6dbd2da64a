// SPDX-License-Identifier: BSD-3-Clause
// ODE's own triangle meshes through this library: the same contacts as geoms of our class, also after the program has
// changed, rebuilt or destroyed its data, with its callbacks asked.
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>

#include "ode/data/trimesh_cache.h"
#include "support/catch.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Counts {
  dGpuTriMeshOverrideStats stats;
  duint64 builds, refits, kept;
  Counts() {
    dGpuTriMeshOverrideStatsInit(&stats);
    REQUIRE(dGpuTriMeshOverrideGetStats(&stats) == dGPUTRIMESH_OK);
    builds = stats.builds;
    refits = stats.refits;
    kept = stats.kept;
  }
};

/// But for the geoms, which are others.
bool sameButGeoms(std::vector<dContactGeom> a, const std::vector<dContactGeom>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i].g1 = b[i].g1;
    a[i].g2 = b[i].g2;
  }
  return sameContacts(a, b);
}

/// Of meshes whose inner numbering may differ: a vertex may be named by another one of its triangles.
bool alike(const std::vector<dContactGeom>& a, const std::vector<dContactGeom>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (std::abs(a[i].pos[k] - b[i].pos[k]) > 1e-9 || std::abs(a[i].normal[k] - b[i].normal[k]) > 1e-9) return false;
    }
    if (std::abs(a[i].depth - b[i].depth) > 1e-9) return false;
  }
  return true;
}

/// What geoms of our class with these arrays and poses have. `first` is the older one.
std::vector<dContactGeom> expected(const scenes::MeshArrays& first, const scenes::MeshArrays& second, dGeomID like1,
                                   dGeomID like2, bool pairwise = false) {
  const Data data1(first), data2(second);
  const Geom g1(data1), g2(data2);
  if (pairwise) usePairwise(g1.id);
  dGeomSetPosition(g1.id, dGeomGetPosition(like1)[0], dGeomGetPosition(like1)[1], dGeomGetPosition(like1)[2]);
  dGeomSetRotation(g1.id, dGeomGetRotation(like1));
  dGeomSetPosition(g2.id, dGeomGetPosition(like2)[0], dGeomGetPosition(like2)[1], dGeomGetPosition(like2)[2]);
  dGeomSetRotation(g2.id, dGeomGetRotation(like2));
  return test::collide(g1.id, g2.id);
}

/// The same of data that were built and updated in the same way.
std::vector<dContactGeom> expectedOf(const Data& first, const Data& second, dGeomID like2) {
  const Geom g1(first), g2(second);
  dGeomSetPosition(g2.id, dGeomGetPosition(like2)[0], dGeomGetPosition(like2)[1], dGeomGetPosition(like2)[2]);
  return test::collide(g1.id, g2.id);
}

/// Sees each geom once, so that g1 is the older one of a pair.
void settleOrder(dGeomID g1, dGeomID g2) {
  REQUIRE(dGpuTriMeshOverridePrepare(g1) == dGPUTRIMESH_OK);
  REQUIRE(dGpuTriMeshOverridePrepare(g2) == dGPUTRIMESH_OK);
}

/// The contacts of a pair of which nothing is remembered, so that they depend on the moment alone.
std::vector<dContactGeom> collideAnew(dGeomID g1, dGeomID g2) {
  for (const dGeomID g : {g1, g2}) dGpuTriMeshOverrideForgetGeom(g);
  settleOrder(g1, g2);
  return test::collide(g1, g2);
}

std::vector<std::pair<dGeomID, int>> asked;
std::set<int> rejected;
int askTriangle(dGeomID g, dGeomID, int triangle) {
  asked.emplace_back(g, triangle);
  return rejected.count(triangle) == 0;
}
std::vector<std::vector<int>> lists;
void tellTriangles(dGeomID, dGeomID, const int* triangles, int count) {
  lists.emplace_back(triangles, triangles + count);
}

}  // namespace

TEST_CASE("overriding needs an initialised ODE, and may be repeated") {
  CHECK(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_ERROR_ODE);
  for (int round = 0; round < 2; ++round) {
    const OdeSession session;
    CHECK(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
    const OdeMesh box(scenes::makeBox({1, 1, 1}));
    const OdeGeom a(box), b(box);
    dGeomSetPosition(b.id, 0, 0, 0.9);
    const auto contacts = test::collide(a.id, b.id);
    REQUIRE(contacts.size() == 4);
    for (const dContactGeom& c : contacts) {
      CHECK(c.g1 == a.id);
      CHECK(c.depth == Approx(0.1));
      CHECK(c.normal[2] == Approx(-1));
    }
  }
}

TEST_CASE("dTriMesh geoms get the contacts of our geoms, in both orders, from single and double arrays") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  const OdeMesh lump(scenes::makeLump(0.5, 3, 0.2, 4)), gear(scenes::makeGear(12, 0.5, 0.12, 0.3, 0.2));
  const OdeGeom a(lump), b(gear);
  settleOrder(a.id, b.id);
  // ODE's "simple" arrays: four dReal a vertex.
  std::vector<dReal> wide;
  for (const Vec3f& v : gear.arrays.vertices) wide.insert(wide.end(), {v.x, v.y, v.z, 7});
  std::vector<dTriIndex> indices;
  for (const Triangle& t : gear.arrays.triangles) indices.insert(indices.end(), std::begin(t.v), std::end(t.v));
  const dTriMeshDataID simple = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSimple(simple, wide.data(), static_cast<int>(gear.arrays.vertices.size()), indices.data(),
                              static_cast<int>(indices.size()));
  dGpuTriMeshOverrideForgetData(simple);
  const dGeomID c = dCreateTriMesh(nullptr, simple, nullptr, nullptr, nullptr);
  std::mt19937 random(11);
  int touching = 0;
  for (int i = 0; i < 40; ++i) {
    setRandomPose(a.id, random, 0.3);
    setRandomPose(b.id, random, 0.3);
    dGeomSetPosition(c, dGeomGetPosition(b.id)[0], dGeomGetPosition(b.id)[1], dGeomGetPosition(b.id)[2]);
    dGeomSetRotation(c, dGeomGetRotation(b.id));
    dGpuTriMeshOverrideForgetGeom(a.id);  // and with them what is remembered of the pair: the queries are single ones
    dGpuTriMeshOverrideForgetGeom(b.id);
    dGpuTriMeshOverrideForgetGeom(c);
    settleOrder(a.id, b.id);
    const auto wanted = expected(lump.arrays, gear.arrays, a.id, b.id);
    const auto found = test::collide(a.id, b.id);
    CHECK(sameButGeoms(found, wanted));
    CHECK(sameContacts(mirrored(test::collide(b.id, a.id)), found));
    CHECK(sameButGeoms(test::collide(a.id, c), wanted));
    touching += !found.empty();
  }
  CHECK(touching > 20);
  dGeomDestroy(c);
  dGeomTriMeshDataDestroy(simple);
}

TEST_CASE("a mesh is read once, refitted when its vertices move, and built when its triangles change") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  OdeMesh ground(scenes::makeGround(4, 0.5, 16)), ball(scenes::makeLump(0.5, 3, 0.1, 9));
  const OdeGeom floor(ground), other(ball), twin(ball);
  settleOrder(floor.id, other.id);
  dGeomSetPosition(other.id, 0, 0, 0.45);
  const Data groundData(ground.arrays), ballData(ball.arrays);
  const auto update = [&] {
    dGeomTriMeshDataUpdate(ball.id);
    REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(ballData.id, ball.arrays.vertices.data(), 0,
                                                static_cast<int>(ball.arrays.vertices.size())) == dGPUTRIMESH_OK);
  };
  const Counts before;
  const auto first = test::collide(floor.id, other.id);
  CHECK(!first.empty());
  CHECK(sameContacts(test::collide(floor.id, other.id), first));
  CHECK(!test::collide(twin.id, other.id).empty());  // shares the data
  CHECK(Counts().builds == before.builds);
  CHECK(Counts().refits == before.refits);

  // All vertices move, and nothing is said.
  for (Vec3f& v : ball.arrays.vertices) v.z *= 1.5f;
  update();
  CHECK(alike(collideAnew(floor.id, other.id), expectedOf(groundData, ballData, other.id)));
  CHECK(Counts().refits == before.refits + 1);
  CHECK(Counts().builds == before.builds);

  // One vertex moves: found in time, or at once if it is announced.
  const auto highest = std::max_element(ball.arrays.vertices.begin(), ball.arrays.vertices.end(),
                                        [](const Vec3f& x, const Vec3f& y) { return x.z > y.z; });  // the lowest
  highest->z -= 0.05f;
  update();
  dGpuTriMeshOverrideDataChanged(ball.id);
  const auto announced = expectedOf(groundData, ballData, other.id);
  CHECK(alike(collideAnew(floor.id, other.id), announced));
  CHECK(Counts().refits == before.refits + 2);
  highest->z -= 0.05f;
  update();
  const auto late = expectedOf(groundData, ballData, other.id);
  CHECK(late[0].depth > announced[0].depth + 0.01);
  std::size_t questions = 0;
  while (questions <= ball.arrays.triangles.size() && !alike(collideAnew(floor.id, other.id), late)) {
    ++questions;
  }
  CHECK(questions <= ball.arrays.triangles.size());
  CHECK(Counts().refits == before.refits + 3);

  // Other triangles in the same data.
  ball.arrays = scenes::makeBox({1, 1, 1}, 2);
  ball.build();
  CHECK(alike(collideAnew(floor.id, other.id), expected(ground.arrays, ball.arrays, floor.id, other.id)));
  CHECK(Counts().builds == before.builds + 1);
  // A seam opens: corners that were one place are two.
  ball.arrays = scenes::makeBox({1, 1, 1}, 2);
  scenes::MeshArrays apart;
  for (const Triangle& t : ball.arrays.triangles) {
    const auto n = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t v : t.v) apart.vertices.push_back(ball.arrays.vertices[v]);
    apart.triangles.push_back({{n, n + 1, n + 2}});
  }
  ball.arrays = apart;
  ball.build();
  CHECK(!test::collide(floor.id, other.id).empty());
  for (std::size_t v = 0; v < 3; ++v) ball.arrays.vertices[v].x += 0.25f;
  dGpuTriMeshOverrideDataChanged(ball.id);
  CHECK(alike(collideAnew(floor.id, other.id), expected(ground.arrays, ball.arrays, floor.id, other.id)));
}

TEST_CASE("data may be forgotten, destroyed, broken and empty") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  clearTrimeshCache();
  OdeMesh box(scenes::makeBox({1, 1, 1}));
  const OdeGeom a(box), b(box);
  dGeomSetPosition(b.id, 0, 0, 0.9);
  const auto contacts = test::collide(a.id, b.id);
  CHECK(Counts().kept == 1);
  dGpuTriMeshOverrideForgetData(box.id);
  dGpuTriMeshOverrideForgetData(nullptr);
  CHECK(Counts().kept == 0);
  CHECK(sameContacts(test::collide(a.id, b.id), contacts));
  // The same address for other data: what ODE's allocator does as a rule, done here for sure.
  box.arrays = scenes::makeBox({2, 2, 2});
  box.build();
  CHECK(test::collide(a.id, b.id)[0].depth == Approx(1.1));
  // Vertices that are no numbers touch nothing, until they are numbers.
  const scenes::MeshArrays good = box.arrays;
  box.arrays.vertices[3].y = std::nanf("");
  CHECK(test::collide(a.id, b.id).empty());
  CHECK(dGpuTriMeshOverridePrepare(a.id) == dGPUTRIMESH_ERROR_MESH);
  box.arrays.vertices[3] = good.vertices[3];
  CHECK(test::collide(a.id, b.id)[0].depth == Approx(1.1));
  // No data, and no geom of the class.
  dGeomTriMeshSetData(a.id, nullptr);
  CHECK(test::collide(a.id, b.id).empty());
  CHECK(dGpuTriMeshOverridePrepare(nullptr) == dGPUTRIMESH_ERROR_CLASS);
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  CHECK(dGpuTriMeshOverridePrepare(sphere) == dGPUTRIMESH_ERROR_CLASS);
  dGeomDestroy(sphere);
}

TEST_CASE("parameters and statistics of dTriMesh geoms") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  const OdeMesh ball(scenes::makeLump(0.5, 3, 0.1, 9));
  const OdeGeom a(ball), b(ball);
  dGeomSetPosition(b.id, 0.2, 0.1, 0.8);
  dGpuTriMeshParams params, found;
  dGpuTriMeshParamsInit(&params);
  dGpuTriMeshParamsInit(&found);
  params.max_contacts = 3;
  REQUIRE(dGpuTriMeshOverrideSetParams(&params) == dGPUTRIMESH_OK);
  const Counts before;
  CHECK(test::collide(a.id, b.id).size() == 3);
  CHECK(Counts().stats.queries == before.stats.queries + 1);
  CHECK(Counts().stats.contacts == before.stats.contacts + 3);
  CHECK(dGpuTriMeshOverrideGetStats(nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  REQUIRE(dGpuTriMeshOverrideGetParams(&found) == dGPUTRIMESH_OK);
  CHECK(found.max_contacts == 3);
  params.max_contacts = 2;
  REQUIRE(dGeomGpuTriMeshSetParams(a.id, &params) == dGPUTRIMESH_OK);
  CHECK(test::collide(a.id, b.id).size() == 2);
  dGpuTriMeshStats stats;
  dGpuTriMeshStatsInit(&stats);
  REQUIRE(dGeomGpuTriMeshGetStats(a.id, &stats) == dGPUTRIMESH_OK);
  CHECK(stats.queries == 2);
  CHECK(stats.contacts == 5);
  params.max_contacts = 0;
  CHECK(dGpuTriMeshOverrideSetParams(&params) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshOverrideSetParams(nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshOverrideGetParams(nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshParamsInit(&params);
  REQUIRE(dGpuTriMeshOverrideSetParams(&params) == dGPUTRIMESH_OK);
}

TEST_CASE("callbacks of dTriMesh geoms are asked about the triangles that intersect") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  const OdeMesh ground(scenes::makeGround(4, 0.5, 8)), box(scenes::makeBox({1, 1, 1}));
  const OdeGeom floor(ground), other(box);
  settleOrder(floor.id, other.id);
  dGeomSetPosition(other.id, 0.1, 0.2, 0.45);
  const auto plain = test::collide(floor.id, other.id);
  REQUIRE(!plain.empty());
  dGeomTriMeshSetCallback(floor.id, &askTriangle);
  dGeomTriMeshSetArrayCallback(floor.id, &tellTriangles);
  asked.clear();
  lists.clear();
  rejected.clear();
  CHECK(sameContacts(test::collide(floor.id, other.id), plain));  // none was rejected
  REQUIRE(lists.size() == 1);
  CHECK(std::is_sorted(lists[0].begin(), lists[0].end()));
  CHECK(asked.size() == lists[0].size());
  for (const auto& [geom, triangle] : asked) {
    CHECK(geom == floor.id);
    CHECK(std::binary_search(lists[0].begin(), lists[0].end(), triangle));
  }
  // All rejected: the box falls through.
  rejected.insert(lists[0].begin(), lists[0].end());
  CHECK(test::collide(floor.id, other.id).empty());
  // One rejected: the contacts of the other pairs of triangles.
  rejected = {lists[0].front()};
  const auto rest = test::collide(floor.id, other.id);
  CHECK(!rest.empty());
  for (const dContactGeom& c : rest) CHECK(c.side1 != lists[0].front());
  // The callback of the other geom, which has no say about the first one's triangles.
  dGeomTriMeshSetCallback(floor.id, nullptr);
  dGeomTriMeshSetArrayCallback(floor.id, nullptr);
  dGeomTriMeshSetCallback(other.id, &askTriangle);
  rejected.clear();
  asked.clear();
  CHECK(sameContacts(test::collide(floor.id, other.id), plain));
  CHECK(!asked.empty());
  for (const auto& [geom, triangle] : asked) CHECK(geom == other.id);
}

TEST_CASE("last transforms tell how geoms without a body move") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  // A cube in the middle of another one has no nearest way out: the one back to where it came from is taken.
  const OdeMesh small(scenes::makeBox({0.4, 0.4, 0.4})), large(scenes::makeBox({1, 1, 1}));
  const OdeGeom a(large), b(small);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      dGpuTriMeshOverrideForgetGeom(a.id);
      dGpuTriMeshOverrideForgetGeom(b.id);
      settleOrder(a.id, b.id);
      dReal at[3] = {0.001, 0.002, 0.003};
      dGeomSetPosition(b.id, at[0], at[1], at[2]);
      at[axis] += 0.01 * sign;
      const dMatrix4 last = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, at[0], at[1], at[2], 1};
      REQUIRE(dGeomGpuTriMeshSetLastTransform(b.id, last) == dGPUTRIMESH_OK);
      CHECK(dGeomGpuTriMeshGetLastTransform(b.id)[12 + axis] == at[axis]);
      const auto contacts = test::collide(a.id, b.id);
      REQUIRE(!contacts.empty());
      INFO("axis " << axis << " sign " << sign << " normal " << contacts[0].normal[0] << " " << contacts[0].normal[1]
                   << " " << contacts[0].normal[2]);
      CHECK(contacts[0].normal[axis] * -sign > 0.9);  // into the large one: the small one leaves the way it came
    }
  }
}

TEST_CASE("flat dTriMesh geoms on flat ones, and on needles, keep ODE's own contacts") {
  scenes::MeshArrays needles;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const double a = 0.3 * i;
    needles.vertices.push_back({0, 0, static_cast<float>(0.01 * i)});
    needles.vertices.push_back({static_cast<float>(3 * std::cos(a)), static_cast<float>(3 * std::sin(a)), 0.3F});
    needles.vertices.push_back({static_cast<float>(3 * std::cos(a)), static_cast<float>(3 * std::sin(a)), 0.35F});
    needles.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  scenes::MeshArrays plate;
  plate.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  plate.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  scenes::MeshArrays ground = plate;
  for (Vec3f& v : ground.vertices) v = {5 * v.x, 5 * v.y, 0};
  for (const auto* below : {&ground, &needles}) {
    std::vector<std::vector<dContactGeom>> found;
    for (const bool isOverridden : {false, true}) {
      const OdeSession session;
      const OdeMesh belowData(*below), plateData(plate);
      if (isOverridden) REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
      const OdeGeom fixed(belowData), body(plateData);
      dMatrix3 r;
      dRFromAxisAndAngle(r, 1, 0.4, 0, 0.2);
      dGeomSetRotation(body.id, r);
      dGeomSetPosition(body.id, 0.1, 0.2, 0.05);
      found.push_back(collide(fixed.id, body.id, 64));
      if (!isOverridden) continue;
      const dGpuTriMeshPair pair{fixed.id, body.id};
      std::vector<dContactGeom> array(64);
      int count = 0;
      const int sum = dGpuTriMeshCollidePairs(&pair, 1, 64, array.data(), sizeof(dContactGeom), &count);
      REQUIRE(sum == count);
      REQUIRE(count == static_cast<int>(found[1].size()));
      for (std::size_t i = 0; i < found[1].size(); ++i) {
        for (int k = 0; k < 3; ++k) CHECK(array[i].pos[k] == Approx(found[1][i].pos[k]).margin(1e-12));
        for (int k = 0; k < 3; ++k) CHECK(array[i].normal[k] == Approx(found[1][i].normal[k]).margin(1e-12));
        CHECK(array[i].depth == found[1][i].depth);
      }
    }
    REQUIRE_FALSE(found[0].empty());
    REQUIRE(found[0].size() == found[1].size());
    for (std::size_t i = 0; i < found[0].size(); ++i) {
      const dContactGeom &stock = found[0][i], &ours = found[1][i];
      CHECK(std::equal(stock.pos, stock.pos + 3, ours.pos));
      CHECK(std::equal(stock.normal, stock.normal + 3, ours.normal));
      CHECK(stock.depth == ours.depth);
      CHECK(stock.side1 == ours.side1);
      CHECK(stock.side2 == ours.side2);
    }
  }
}
