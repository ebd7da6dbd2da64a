// SPDX-License-Identifier: BSD-3-Clause
// What dTriMesh offers besides building and colliding, on geoms of our class: callbacks, preprocessed data, coherence.
#include <cmath>
#include <set>

#include "base/vectors.h"
#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kPi = 3.14159265358979323846;

struct Asked {
  dGeomID own, other;
  int triangle, otherTriangle;
};
std::vector<Asked> asked;
std::set<std::pair<int, int>> rejectedPairs;
int askPair(dGeomID own, dGeomID other, int triangle, int otherTriangle) {
  asked.push_back({own, other, triangle, otherTriangle});
  return rejectedPairs.count({triangle, otherTriangle}) == 0;
}
int rejectAll(dGeomID, dGeomID, int) {
  return 0;
}
int rejectAllPairs(dGeomID, dGeomID, int, int) {
  return 0;
}
std::vector<std::pair<int, int>> merged;
int mergeNumbers(dGeomID, int first, int second) {
  merged.emplace_back(first, second);
  return first | 1 << 20 | second;
}
int passRays(dGeomID, dGeomID, int, dReal, dReal) {
  return 0;
}
/// Collides another pair in the middle of a collision.
dGeomID inner1, inner2;
std::vector<dContactGeom> innerContacts;
int collideInside(dGeomID, dGeomID, int) {
  innerContacts = test::collide(inner1, inner2);
  return 1;
}

/// A box that lies a little in a ground of 4 x 4 cells.
struct Scene {
  OdeSession session;
  Data ground{scenes::makeGround(4, 0.5, 4)}, box{scenes::makeBox({1, 1, 1})};
  Geom floor{ground}, other{box};
  Scene() { dGeomSetPosition(other.id, 0.1, 0.2, 0.45); }
};

}  // namespace

TEST_CASE("a pair callback is asked about every pair of triangles that intersects, and may reject it") {
  const Scene s;
  const auto plain = test::collide(s.floor.id, s.other.id);
  REQUIRE(dGeomGpuTriMeshSetPairCallback(s.other.id, &askPair) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetPairCallback(s.other.id) == &askPair);
  asked.clear();
  rejectedPairs.clear();
  CHECK(sameContacts(test::collide(s.floor.id, s.other.id), plain));
  dGpuTriMeshStats stats;
  dGpuTriMeshStatsInit(&stats);
  dGeomGpuTriMeshGetStats(s.floor.id, &stats);
  CHECK(asked.size() * 2 >= stats.intersecting_pairs);  // of two equal calls; contacts name a few pairs more
  std::set<std::pair<int, int>> pairs;
  for (const Asked& a : asked) {
    CHECK(a.own == s.other.id);
    CHECK(a.other == s.floor.id);
    CHECK(pairs.emplace(a.triangle, a.otherTriangle).second);
  }
  // All but one pair rejected: the pairwise contact of that one.
  const std::pair<int, int> kept = *pairs.begin();
  rejectedPairs = pairs;
  rejectedPairs.erase(kept);
  for (const dContactGeom& c : test::collide(s.floor.id, s.other.id)) {
    CHECK(c.side1 == kept.second);
    CHECK(c.side2 == kept.first);
  }
  // Both orders of the call mirror.
  CHECK(sameContacts(mirrored(test::collide(s.other.id, s.floor.id)), test::collide(s.floor.id, s.other.id)));
  rejectedPairs = pairs;
  CHECK(test::collide(s.floor.id, s.other.id).empty());
}

TEST_CASE("a mesh inside another one, all of whose triangles are rejected, has no contacts") {
  const OdeSession session;
  const Data large(scenes::makeBox({2, 2, 2})), small(scenes::makeBox({0.5, 0.5, 0.5}));
  const Geom a(large), b(small);
  CHECK(!test::collide(a.id, b.id).empty());
  REQUIRE(dGeomGpuTriMeshSetCallback(b.id, &rejectAll) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetCallback(b.id) == &rejectAll);
  CHECK(test::collide(a.id, b.id).empty());
  REQUIRE(dGeomGpuTriMeshSetCallback(b.id, nullptr) == dGPUTRIMESH_OK);
  CHECK(!test::collide(a.id, b.id).empty());
}

TEST_CASE("pairs with callbacks in arrays, batches and prefetches") {
  const Scene s;
  REQUIRE(dGeomGpuTriMeshSetPairCallback(s.floor.id, &rejectAllPairs) == dGPUTRIMESH_OK);
  const Geom third(s.box);
  dGeomSetPosition(third.id, 0.3, 0.2, 1.3);
  const dGpuTriMeshPair pairs[2] = {{s.floor.id, s.other.id}, {s.other.id, third.id}};
  std::vector<dContactGeom> contacts(64);
  int counts[2] = {-1, -1};
  CHECK(dGpuTriMeshCollidePairs(pairs, 2, 32, contacts.data(), sizeof(dContactGeom), counts) > 0);
  CHECK(counts[0] == 0);
  CHECK(counts[1] > 0);
  const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(pairs, 2, 32);
  CHECK(dGpuTriMeshBatchWait(batch) == counts[1]);
  dGpuTriMeshBatchDestroy(batch);
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  for (const dGeomID g : {s.floor.id, s.other.id, third.id}) dSpaceAdd(space, g);
  CHECK(dGpuTriMeshPrefetch(space) == 1);
  CHECK(test::collide(s.floor.id, s.other.id).empty());
  for (const dGeomID g : {s.floor.id, s.other.id, third.id}) dSpaceRemove(space, g);
  dSpaceDestroy(space);
}

TEST_CASE("a merge callback gets the triangles of contacts that were left out") {
  const Scene s;
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.max_contacts = 1;
  REQUIRE(dGeomGpuTriMeshSetParams(s.floor.id, &params) == dGPUTRIMESH_OK);
  const auto alone = test::collide(s.floor.id, s.other.id);
  REQUIRE(alone.size() == 1);
  REQUIRE(dGeomGpuTriMeshSetTriMergeCallback(s.floor.id, &mergeNumbers) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetTriMergeCallback(s.floor.id) == &mergeNumbers);
  merged.clear();
  const auto contacts = test::collide(s.floor.id, s.other.id);
  REQUIRE(contacts.size() == 1);
  REQUIRE(!merged.empty());
  CHECK(merged[0].first == alone[0].side1);
  CHECK((contacts[0].side1 & 1 << 20) != 0);
  CHECK(contacts[0].side2 == alone[0].side2);
  CHECK(contacts[0].depth == alone[0].depth);
}

TEST_CASE("a callback may collide other geoms") {
  const Scene s;
  const Geom a(s.box), b(s.box);
  dGeomSetPosition(a.id, 10, 0, 0);
  dGeomSetPosition(b.id, 10.2, 0.3, 0.9);
  inner1 = a.id;
  inner2 = b.id;
  const auto inner = test::collide(a.id, b.id), outer = test::collide(s.floor.id, s.other.id);
  REQUIRE(dGeomGpuTriMeshSetCallback(s.floor.id, &collideInside) == dGPUTRIMESH_OK);
  CHECK(sameContacts(test::collide(s.floor.id, s.other.id), outer));
  CHECK(sameContacts(innerContacts, inner));
}

TEST_CASE("callbacks of geoms of other classes") {
  const OdeSession session;
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  CHECK(dGeomGpuTriMeshSetCallback(sphere, &rejectAll) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshSetArrayCallback(sphere, nullptr) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshSetRayCallback(nullptr, &passRays) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshSetTriMergeCallback(sphere, &mergeNumbers) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshSetPairCallback(sphere, &askPair) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshGetCallback(sphere) == nullptr);
  CHECK(dGeomGpuTriMeshGetArrayCallback(sphere) == nullptr);
  CHECK(dGeomGpuTriMeshGetPairCallback(sphere) == nullptr);
  CHECK(dGeomGpuTriMeshGetTriMergeCallback(sphere) == nullptr);
  dGeomDestroy(sphere);
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom geom(box);
  CHECK(dGeomGpuTriMeshSetRayCallback(geom.id, &passRays) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetRayCallback(geom.id) == &passRays);
}

TEST_CASE("last transforms of geoms of our class") {
  const OdeSession session;
  const Data large(scenes::makeBox({1, 1, 1})), small(scenes::makeBox({0.4, 0.4, 0.4}));
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      const Geom a(large), b(small);
      dReal at[3] = {0.001, 0.002, 0.003};
      dGeomSetPosition(b.id, at[0], at[1], at[2]);
      for (int k = 0; k < 16; ++k) CHECK(dGeomGpuTriMeshGetLastTransform(b.id)[k] == 0);
      at[axis] += 0.01 * sign;
      const dMatrix4 last = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, at[0], at[1], at[2], 1};
      REQUIRE(dGeomGpuTriMeshSetLastTransform(b.id, last) == dGPUTRIMESH_OK);
      CHECK(test::collide(a.id, b.id)[0].normal[axis] * -sign > 0.9);
      const dMatrix4 bad = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, std::nan(""), 0, 0, 1};
      CHECK(dGeomGpuTriMeshSetLastTransform(b.id, bad) == dGPUTRIMESH_ERROR_ARGUMENT);
      CHECK(dGeomGpuTriMeshGetLastTransform(b.id)[12] == at[0]);
      CHECK(dGeomGpuTriMeshSetLastTransform(b.id, nullptr) == dGPUTRIMESH_OK);
    }
  }
  CHECK(dGeomGpuTriMeshGetLastTransform(nullptr) == nullptr);
}

TEST_CASE("angles of edges, edges to use, normals") {
  const Data box(scenes::makeBox({1, 2, 3}));  // twelve triangles: six diagonals, twelve edges
  CHECK(dGpuTriMeshDataGet(box.id, dTRIMESHDATA_USE_FLAGS) == nullptr);
  int flat = 0, right = 0;
  for (int t = 0; t < 12; ++t) {
    for (int k = 0; k < 3; ++k) {
      dReal angle = -9;
      REQUIRE(dGpuTriMeshDataGetEdgeAngle(box.id, t, k, &angle) == dGPUTRIMESH_OK);
      flat += std::abs(angle) < 1e-6;
      right += std::abs(angle - kPi / 2) < 1e-6;
    }
  }
  CHECK(flat == 12);
  CHECK(right == 24);
  REQUIRE(dGpuTriMeshDataPreprocess(box.id) == 1);
  dsizeint size = 0;
  const auto* flags = static_cast<const unsigned char*>(dGpuTriMeshDataGet2(box.id, dTRIMESHDATA_USE_FLAGS, &size));
  REQUIRE(size == 12);
  int edges = 0, vertices = 0;
  for (int t = 0; t < 12; ++t) {
    for (int k = 0; k < 3; ++k) {
      edges += (flags[t] & dMESHDATAUSE_EDGE1 << k) != 0;
      vertices += (flags[t] & dMESHDATAUSE_VERTEX1 << k) != 0;
    }
  }
  CHECK(edges == 12);
  CHECK(vertices == 8);
  // Inside out every edge is concave, and nothing rests on it.
  scenes::MeshArrays inverted = scenes::makeBox({1, 1, 1});
  for (Triangle& t : inverted.triangles) std::swap(t.v[1], t.v[2]);
  const Data cavity(inverted);
  REQUIRE(dGpuTriMeshDataPreprocess2(cavity.id, 3, nullptr) == 1);
  flags = static_cast<const unsigned char*>(dGpuTriMeshDataGet(cavity.id, dTRIMESHDATA_USE_FLAGS));
  REQUIRE(flags != nullptr);
  for (int t = 0; t < 12; ++t) CHECK(flags[t] == 0);
  dReal angle = 0;
  int concave = 0;
  for (int k = 0; k < 3; ++k) {
    dGpuTriMeshDataGetEdgeAngle(cavity.id, 0, k, &angle);
    concave += std::abs(angle + kPi / 2) < 1e-6;
  }
  CHECK(concave == 2);
  // Flags of the program's own.
  const unsigned char own[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  REQUIRE(dGpuTriMeshDataSet(cavity.id, dTRIMESHDATA_USE_FLAGS, own) == dGPUTRIMESH_OK);
  CHECK(static_cast<const unsigned char*>(dGpuTriMeshDataGet(cavity.id, dTRIMESHDATA_USE_FLAGS))[11] == 12);
  unsigned char* buffer = nullptr;
  int bytes = 0;
  dGpuTriMeshDataGetBuffer(cavity.id, &buffer, &bytes);
  REQUIRE(bytes == 12);
  CHECK(buffer[11] == 12);
  unsigned char others[12] = {12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
  dGpuTriMeshDataSetBuffer(cavity.id, others);
  others[11] = 0;  // it was copied
  dGpuTriMeshDataGetBuffer(cavity.id, &buffer, nullptr);
  CHECK(buffer[11] == 1);
  dGpuTriMeshDataGetBuffer(nullptr, &buffer, &bytes);
  CHECK((buffer == nullptr && bytes == 0));
  REQUIRE(dGpuTriMeshDataSet(cavity.id, dTRIMESHDATA_USE_FLAGS, nullptr) == dGPUTRIMESH_OK);
  CHECK(static_cast<const unsigned char*>(dGpuTriMeshDataGet(cavity.id, dTRIMESHDATA_USE_FLAGS))[11] == 0);
  // Normals, in the order of the caller's triangles.
  const scenes::MeshArrays lump = scenes::makeLump(1, 2, 0.2, 3);
  const Data data(lump);
  const auto* normals = static_cast<const dReal*>(dGpuTriMeshDataGet2(data.id, dTRIMESHDATA_FACE_NORMALS, &size));
  REQUIRE(size == 3 * sizeof(dReal) * lump.triangles.size());
  for (std::size_t t = 0; t < lump.triangles.size(); ++t) {
    const auto corner = [&](int k) {
      const Vec3f& v = lump.vertices[lump.triangles[t].v[k]];
      return Vec3d{v.x, v.y, v.z};
    };
    const Vec3d n = otgCross(otgSub(corner(1), corner(0)), otgSub(corner(2), corner(0)));
    const double length = norm(n);
    CHECK(normals[3 * t] == Approx(n.x / length).margin(1e-9));
    CHECK(normals[3 * t + 2] == Approx(n.z / length).margin(1e-9));
  }
  // An open mesh ends at its border.
  scenes::MeshArrays open = scenes::makeBox({1, 1, 1});
  open.triangles.pop_back();
  const Data shell(open);
  int border = 0;
  for (int t = 0; t < 11; ++t) {
    for (int k = 0; k < 3; ++k) {
      dGpuTriMeshDataGetEdgeAngle(shell.id, t, k, &angle);
      border += angle == Approx(kPi);
    }
  }
  CHECK(border == 3);
  // What is no mesh, no number, no array.
  CHECK(dGpuTriMeshDataPreprocess(nullptr) == 0);
  CHECK(dGpuTriMeshDataPreprocess2(box.id, 4, nullptr) == 0);
  CHECK(dGpuTriMeshDataGet(box.id, 7) == nullptr);
  CHECK(dGpuTriMeshDataSet(box.id, 7, own) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataGetEdgeAngle(box.id, 12, 0, &angle) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataGetEdgeAngle(box.id, 0, 3, &angle) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataGetEdgeAngle(box.id, 0, 0, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
}

TEST_CASE("scaled geoms collide as geoms of scaled vertices, and mirrored ones face outward") {
  const OdeSession session;
  const scenes::MeshArrays lump = scenes::makeLump(0.5, 3, 0.2, 4);
  const Data data(lump), ground(scenes::makeGround(6, 1, 8));
  const Geom floor(ground);
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.history = dGPUTRIMESH_HISTORY_OFF;
  REQUIRE(dGeomGpuTriMeshSetParams(floor.id, &params) == dGPUTRIMESH_OK);
  for (const Vec3f scale :
       {Vec3f{2, 0.5f, 1.5f}, Vec3f{-1, 1, 1}, Vec3f{1.25f, -2, 0.75f}, Vec3f{-1, -1, 2}, Vec3f{-0.5f, -0.5f, -0.5f}}) {
    INFO(scale.x << " " << scale.y << " " << scale.z);
    scenes::MeshArrays scaled = lump;
    for (Vec3f& v : scaled.vertices) v = {v.x * scale.x, v.y * scale.y, v.z * scale.z};
    if (scale.x * scale.y * scale.z < 0) {
      for (Triangle& t : scaled.triangles) std::swap(t.v[1], t.v[2]);
    }
    const Data other(scaled);
    const Geom g(data), twin(data), wanted(other);
    REQUIRE(dGeomGpuTriMeshSetScale(g.id, scale.x, scale.y, scale.z) == dGPUTRIMESH_OK);
    REQUIRE(dGeomGpuTriMeshSetScale(twin.id, scale.x, scale.y, scale.z) == dGPUTRIMESH_OK);
    dVector3 found;
    REQUIRE(dGeomGpuTriMeshGetScale(g.id, found) == dGPUTRIMESH_OK);
    CHECK(found[1] == scale.y);
    for (const dGeomID geom : {g.id, twin.id, wanted.id}) {
      dGeomSetPosition(geom, 0.1, 0.2, 0.35 * std::abs(scale.z));
    }
    const auto contacts = test::collide(floor.id, g.id), expected = test::collide(floor.id, wanted.id);
    // The same pairs of triangles intersect; which of many contacts are kept depends on inner numbers of triangles.
    REQUIRE(!contacts.empty());
    REQUIRE(!expected.empty());
    CHECK(contacts[0].depth == Approx(expected[0].depth).margin(1e-9));
    for (const dContactGeom& c : contacts) CHECK(c.normal[2] < -0.5);  // the lump leaves upward
    dGpuTriMeshStats stats, wantedStats;
    dGpuTriMeshStatsInit(&stats);
    dGpuTriMeshStatsInit(&wantedStats);
    REQUIRE(dGeomGpuTriMeshGetStats(g.id, &stats) == dGPUTRIMESH_OK);
    REQUIRE(dGeomGpuTriMeshGetStats(wanted.id, &wantedStats) == dGPUTRIMESH_OK);
    CHECK(stats.intersecting_pairs > 0);
    CHECK(stats.intersecting_pairs == wantedStats.intersecting_pairs);
    dMass mass, wantedMass;
    REQUIRE(dMassSetGpuTriMesh(&mass, 1, g.id) == dGPUTRIMESH_OK);
    REQUIRE(dMassSetGpuTriMesh(&wantedMass, 1, wanted.id) == dGPUTRIMESH_OK);
    CHECK(mass.mass > 0);
    CHECK(mass.mass == Approx(wantedMass.mass));
    CHECK(mass.I[1] == Approx(wantedMass.I[1]).margin(1e-9));
    for (int t = 0; t < 20; ++t) {
      dVector3 p[3], q[3];
      REQUIRE(dGeomGpuTriMeshGetTriangle(g.id, t, &p[0], &p[1], &p[2]) == dGPUTRIMESH_OK);
      REQUIRE(dGeomGpuTriMeshGetTriangle(wanted.id, t, &q[0], &q[1], &q[2]) == dGPUTRIMESH_OK);
      for (int k = 0; k < 3; ++k) CHECK(std::equal(p[k], p[k] + 3, q[k]));
    }
    dReal box[6], wantedBox[6];
    dGeomGetAABB(g.id, box);
    dGeomGetAABB(wanted.id, wantedBox);
    CHECK(std::equal(box, box + 6, wantedBox));
  }
}

TEST_CASE("the scale of a geom stays when its mesh changes, and is refused where it cannot be") {
  const OdeSession session;
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  const Data data(box), other(scenes::makeBox({2, 2, 2}));
  const Geom g(data), plain(data);
  REQUIRE(dGeomGpuTriMeshSetScale(g.id, 2, 1, 1) == dGPUTRIMESH_OK);
  const auto width = [](dGeomID geom) {
    dReal aabb[6];
    dGeomGetAABB(geom, aabb);
    return aabb[1] - aabb[0];
  };
  CHECK(width(g.id) == Approx(2));
  CHECK(width(plain.id) == Approx(1));
  std::vector<Vec3f> moved = box.vertices;
  for (Vec3f& v : moved) v.x *= 3;
  REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(data.id, moved.data(), 0, static_cast<int>(moved.size())) ==
          dGPUTRIMESH_OK);
  CHECK(width(g.id) == Approx(6));
  CHECK(width(plain.id) == Approx(3));
  REQUIRE(dGeomGpuTriMeshSetData(g.id, other.id) == dGPUTRIMESH_OK);
  CHECK(width(g.id) == Approx(4));
  REQUIRE(dGeomGpuTriMeshSetData(g.id, nullptr) == dGPUTRIMESH_OK);
  CHECK(width(g.id) == 0);
  REQUIRE(dGeomGpuTriMeshSetData(g.id, other.id) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetScale(g.id, 1, 1, 1) == dGPUTRIMESH_OK);
  CHECK(width(g.id) == Approx(2));
  CHECK(dGeomGpuTriMeshSetScale(g.id, 0, 1, 1) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshSetScale(g.id, 1, std::nan(""), 1) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshSetScale(g.id, 3.4e38, 1, 1) == dGPUTRIMESH_OK);
  Data huge(scenes::makeBox({100, 100, 100}));
  CHECK(dGeomGpuTriMeshSetData(g.id, huge.id) == dGPUTRIMESH_ERROR_MESH);
  CHECK(dGeomGpuTriMeshGetData(g.id) == other.id);
  CHECK(dGeomGpuTriMeshSetScale(nullptr, 1, 1, 1) == dGPUTRIMESH_ERROR_CLASS);
  dVector3 scale;
  CHECK(dGeomGpuTriMeshGetScale(nullptr, scale) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshGetScale(g.id, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
}

TEST_CASE("temporal coherence by ODE's names") {
  const OdeSession session;
  const Data large(scenes::makeBox({1, 1, 1})), small(scenes::makeBox({0.4, 0.4, 0.4}));
  const Geom a(large), b(small);
  CHECK(dGeomGpuTriMeshGetTriMeshDataID(a.id) == large.id);
  const int own = dGpuTriMeshGetClass();
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, own) == 1);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, dBoxClass) == 1);
  CHECK(dGeomGpuTriMeshEnableTC(a.id, dBoxClass, 0) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, dBoxClass) == 0);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, dCapsuleClass) == 1);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, own) == 1);
  CHECK(dGeomGpuTriMeshEnableTC(a.id, dBoxClass, 1) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, dBoxClass) == 1);
  CHECK(dGeomGpuTriMeshEnableTC(a.id, own, 0) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, own) == 0);
  CHECK(dGeomGpuTriMeshIsTCEnabled(a.id, dBoxClass) == 0);  // nothing is remembered at all
  CHECK(dGeomGpuTriMeshEnableTC(a.id, own, 1) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshEnableTC(a.id, -1, 1) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshIsTCEnabled(nullptr, own) == dGPUTRIMESH_ERROR_CLASS);
  // The small box came in along x and keeps leaving along x, until the pair is forgotten: then the nearest way is z.
  // Either geom may forget, whichever of the two remembers.
  for (const dGeomID cleared : {a.id, b.id}) {
    dGeomSetPosition(b.id, 0.02, 0, 0.03);
    const dMatrix4 last = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.05, 0, 0.03, 1};
    dGeomGpuTriMeshSetLastTransform(b.id, last);
    CHECK(std::abs(test::collide(a.id, b.id)[0].normal[0]) > 0.9);
    dGeomGpuTriMeshSetLastTransform(b.id, nullptr);
    dGeomSetPosition(b.id, 0.0201, 0, 0.03);
    CHECK(std::abs(test::collide(a.id, b.id)[0].normal[0]) > 0.9);
    REQUIRE(dGeomGpuTriMeshClearTCCache(cleared) == dGPUTRIMESH_OK);
    CHECK(std::abs(test::collide(a.id, b.id)[0].normal[2]) > 0.9);
    dGeomGpuTriMeshClearTCCache(cleared);
  }
  CHECK(dGeomGpuTriMeshClearTCCache(nullptr) == dGPUTRIMESH_ERROR_CLASS);
}

TEST_CASE("temporal coherence with a class of ODE's") {
  const OdeSession session;
  const Data large(scenes::makeBox({1, 1, 1}));
  const Geom mesh(large);
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  const dGeomID box = dCreateBox(nullptr, 0.4, 0.4, 0.4);
  dGeomSetBody(box, body);
  // The box came in along x and keeps leaving along x when it is at rest, if that is remembered: the nearest way is z.
  for (const int enabled : {1, 0, 1}) {
    REQUIRE(dGeomGpuTriMeshEnableTC(mesh.id, dBoxClass, enabled) == dGPUTRIMESH_OK);
    dBodySetPosition(body, 0.02, 0, 0.03);
    dBodySetLinearVel(body, -1, 0, 0);
    CHECK(std::abs(test::collide(mesh.id, box)[0].normal[0]) > 0.9);
    dBodySetPosition(body, 0.0201, 0, 0.03);
    dBodySetLinearVel(body, 0, 0, 0);
    CHECK(std::abs(test::collide(mesh.id, box)[0].normal[enabled != 0 ? 0 : 2]) > 0.9);
    CHECK(dGeomGpuTriMeshClearTCCache(mesh.id) == dGPUTRIMESH_OK);
    CHECK(std::abs(test::collide(mesh.id, box)[0].normal[2]) > 0.9);
  }
  dGeomDestroy(box);
  dWorldDestroy(world);
}
