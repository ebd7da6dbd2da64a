// SPDX-License-Identifier: BSD-3-Clause
// dGpuTriMeshJoin(): contacts of all pieces together are those of the whole, however they are asked for, and what ends
// a join.
#include <algorithm>
#include <memory>

#include "base/vectors.h"
#include "support/catch.h"
#include "support/cut_ground.h"
#include "support/draw.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"
#include "support/sheet_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A terrain of blocks or sheets, whole and in 4 x 4 pieces.
class Cut {
 public:
  Cut(bool isSolid, const Transformd& pose) {
    const scenes::MeshArrays sheet = terrain(4, 16, 0.15);
    const auto made = [&](const scenes::MeshArrays& mesh) { return isSolid ? blockUnder(mesh, -1) : mesh; };
    wholeData_ = std::make_unique<Data>(made(sheet));
    whole = dCreateGpuTriMesh(nullptr, wholeData_->id);
    setPose(whole, pose);
    for (const scenes::MeshArrays& piece : cutTerrain(sheet, 4, 4)) {
      data_.push_back(std::make_unique<Data>(made(piece)));
      pieces.push_back(dCreateGpuTriMesh(nullptr, data_.back()->id));
      setPose(pieces.back(), pose);
    }
  }
  ~Cut() {
    dGeomDestroy(whole);
    for (const dGeomID piece : pieces) {
      if (piece != nullptr) dGeomDestroy(piece);
    }
  }
  Cut(const Cut&) = delete;
  Cut& operator=(const Cut&) = delete;
  int join() const { return dGpuTriMeshJoin(pieces.data(), static_cast<int>(pieces.size())); }
  dGpuTriMeshDataID data(std::size_t i) const { return data_[i]->id; }

  dGeomID whole;
  std::vector<dGeomID> pieces;

 private:
  std::unique_ptr<Data> wholeData_;
  std::vector<std::unique_ptr<Data>> data_;
};

using Key = std::array<double, 7>;
std::vector<Key> sortedKeys(const std::vector<dContactGeom>& contacts) {
  std::vector<Key> keys;
  for (const dContactGeom& c : contacts) {
    keys.push_back({c.pos[0], c.pos[1], c.pos[2], c.normal[0], c.normal[1], c.normal[2], c.depth});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

bool areNear(const std::vector<Key>& x, std::vector<Key> y) {
  if (x.size() != y.size()) return false;
  for (const Key& one : x) {
    const auto same = std::find_if(y.begin(), y.end(), [&](const Key& other) {
      for (std::size_t k = 0; k < one.size(); ++k) {
        if (std::fabs(one[k] - other[k]) > 1e-9) return false;
      }
      return true;
    });
    if (same == y.end()) return false;
    y.erase(same);
  }
  return true;
}

/// Of every piece with the body, one after the other, as a space would ask: those whose boxes meet.
std::vector<dContactGeom> ofPieces(const Cut& cut, dGeomID body) {
  std::vector<dContactGeom> all;
  dReal own[6], other[6];
  dGeomGetAABB(body, own);
  for (const dGeomID piece : cut.pieces) {
    dGeomGetAABB(piece, other);
    bool meet = true;
    for (int k = 0; k < 6; k += 2) meet = meet && own[k] <= other[k + 1] && other[k] <= own[k + 1];
    if (!meet) continue;
    for (const dContactGeom& c : collide(piece, body)) {
      CHECK(c.side1 < dGeomGpuTriMeshGetTriangleCount(piece));
      all.push_back(c);
    }
  }
  return all;
}

Transformd lyingPose(Draw& draw) {
  return makePose(draw.direction(), draw.uniform(0, 6), {draw.uniform(-1.6, 1.6), draw.uniform(-1.6, 1.6), 0.25});
}

}  // namespace

TEST_CASE("the contacts of all joined pieces are those of the whole, for meshes and ODE's shapes") {
  const OdeSession session;
  for (const bool isSolid : {false, true}) {
    const Cut cut(isSolid, makePose({0, 0, 1}, 0, {0, 0, 0}));
    REQUIRE(cut.join() == 16);
    const Data boxData(scenes::makeBox({0.7, 0.5, 0.4})), lumpData(scenes::makeLump(0.4, 3, 0.2, 2));
    const Geom box(boxData), lump(lumpData);
    const std::vector<dGeomID> bodies = {box.id,
                                         lump.id,
                                         dCreateBox(nullptr, 0.6, 0.5, 0.4),
                                         dCreateSphere(nullptr, 0.4),
                                         dCreateCapsule(nullptr, 0.25, 0.5),
                                         dCreateCylinder(nullptr, 0.3, 0.5)};
    Draw draw(4);
    int touching = 0;
    for (int i = 0; i < 240; ++i) {
      const dGeomID body = bodies[static_cast<std::size_t>(i) % bodies.size()];
      setPose(body, lyingPose(draw));
      const auto one = sortedKeys(collide(cut.whole, body)), many = sortedKeys(ofPieces(cut, body));
      INFO(isSolid << " " << i << " " << one.size() << " " << many.size());
      CHECK(areNear(one, many));
      touching += one.empty() ? 0 : 1;
    }
    CHECK(touching > 100);
    for (std::size_t k = 2; k < bodies.size(); ++k) dGeomDestroy(bodies[k]);
  }
}

TEST_CASE("pieces that are turned, each with a place of its own, are joined where their edges meet") {
  const OdeSession session;
  const Data slab(scenes::makeBox({1, 2, 0.3}));
  const Transformd row = makePose(unit({0.3, -0.2, 1}), 0.7, {5, -3, 2});
  std::vector<std::unique_ptr<Geom>> geoms;
  std::vector<dGeomID> ids;
  for (int i = 0; i < 5; ++i) {
    geoms.push_back(std::make_unique<Geom>(slab));
    Transformd pose = row;
    pose.t = otgTransform(row, Vec3d{1.0 * i, 0, i == 4 ? 0.1 : 0.0});
    setPose(geoms.back()->id, pose);
    ids.push_back(geoms.back()->id);
  }
  // The last one is a step higher: its side lies on nothing that has its edges.
  CHECK(dGpuTriMeshJoin(ids.data(), 5) == 4);
  CHECK(collide(ids[0], ids[1]).empty());
  const dGeomID ball = dCreateSphere(nullptr, 0.5);
  const Vec3d on = otgTransform(row, Vec3d{0.5, 0, 0.15 + 0.49});
  dGeomSetPosition(ball, on.x, on.y, on.z);
  std::vector<dContactGeom> contacts = collide(ids[0], ball);
  for (const dContactGeom& c : collide(ids[1], ball)) contacts.push_back(c);
  REQUIRE(contacts.size() == 1);
  CHECK(contacts[0].depth == Approx(0.01).margin(1e-6));
  dGeomDestroy(ball);
}

TEST_CASE("arrays of pairs, batches and what is prefetched have the contacts of joined pieces") {
  const OdeSession session;
  Cut cut(true, makePose({0, 0, 1}, 0.4, {1, 2, 3}));
  REQUIRE(cut.join() == 16);
  const Data boxData(scenes::makeBox({0.7, 0.5, 0.4}));
  const Geom box(boxData);
  Transformd pose = makePose({0, 0, 1}, 0.4, {0, 0, 0});
  pose.t = {1, 2, 3.2};
  setPose(box.id, pose);
  std::vector<dGpuTriMeshPair> pairs;
  std::vector<std::vector<dContactGeom>> single;
  for (const dGeomID piece : cut.pieces) {
    pairs.push_back({piece, box.id});
    single.push_back(collide(piece, box.id, 16));
  }
  std::vector<dContactGeom> contacts(16 * pairs.size());
  std::vector<int> counts(pairs.size());
  REQUIRE(dGpuTriMeshCollidePairs(pairs.data(), 16, 16, contacts.data(), sizeof(dContactGeom), counts.data()) > 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(16 * i);
    CHECK(sameContacts({first, first + counts[i]}, single[i]));
  }
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dSpaceSetCleanup(space, 0);
  for (const dGeomID piece : cut.pieces) dSpaceAdd(space, piece);
  dSpaceAdd(space, box.id);
  CHECK(dGpuTriMeshPrefetch(space) == 0);  // left to dCollide()
  for (std::size_t i = 0; i < pairs.size(); ++i) CHECK(sameContacts(collide(pairs[i].o1, box.id, 16), single[i]));
  dSpaceDestroy(space);
}

TEST_CASE("a join ends with a geom that is destroyed, changed, unjoined or joined anew") {
  const OdeSession session;
  const Data boxData(scenes::makeBox({0.7, 0.7, 0.4}));
  const Geom box(boxData);
  for (const int end : {0, 1, 2, 3}) {
    Cut cut(true, makePose({0, 0, 1}, 0, {0, 0, 0}));
    dGeomSetPosition(box.id, 0, 0, 0.2);
    const auto alone = collide(cut.pieces[5], box.id);
    REQUIRE(cut.join() == 16);
    const auto joined = collide(cut.pieces[5], box.id);
    CHECK_FALSE(sameContacts(joined, alone));
    if (end == 0) {
      dGeomDestroy(cut.pieces[0]);
      cut.pieces[0] = nullptr;
    } else if (end == 1) {
      REQUIRE(dGeomGpuTriMeshSetData(cut.pieces[5], cut.data(5)) == dGPUTRIMESH_OK);
      CHECK(sameContacts(collide(cut.pieces[5], box.id), joined));  // the same data
      REQUIRE(dGeomGpuTriMeshSetScale(cut.pieces[5], 1, 1, 1.5) == dGPUTRIMESH_OK);
      collide(cut.pieces[5], box.id);
      REQUIRE(dGeomGpuTriMeshSetScale(cut.pieces[5], 1, 1, 1) == dGPUTRIMESH_OK);
    } else if (end == 2) {
      REQUIRE(dGpuTriMeshUnjoin(cut.pieces[9]) == dGPUTRIMESH_OK);
    } else {
      REQUIRE(dGpuTriMeshJoin(&cut.pieces[9], 1) == 0);
    }
    INFO(end);
    CHECK(collide(cut.pieces[5], box.id).size() == alone.size());
  }
}

TEST_CASE("what cannot be joined is refused, or stays as it is") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom a(box), b(box);
  const dGeomID ball = dCreateSphere(nullptr, 1);
  const dGeomID twice[] = {a.id, a.id}, mixed[] = {a.id, ball}, both[] = {a.id, b.id};
  CHECK(dGpuTriMeshJoin(nullptr, 2) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshJoin(both, -1) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshJoin(twice, 2) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshJoin(mixed, 2) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshJoin(nullptr, 0) == 0);
  CHECK(dGpuTriMeshUnjoin(ball) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshUnjoin(a.id) == dGPUTRIMESH_OK);
  dGeomSetPosition(b.id, 1, 1, 0);  // edge on edge only
  CHECK(dGpuTriMeshJoin(both, 2) == 0);
  dGeomSetPosition(b.id, 1, 0.5, 0);  // faces that do not have the same edges
  CHECK(dGpuTriMeshJoin(both, 2) == 0);
  dGeomSetPosition(b.id, 1, 0, 0);
  CHECK(dGpuTriMeshJoin(both, 2) == 2);
  dGeomDestroy(ball);
}

TEST_CASE("dTriMesh geoms that collide through the library are joined, too") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  const OdeMesh slab(scenes::makeBox({1, 2, 0.3}));
  const OdeGeom left(slab), right(slab);
  dGeomSetPosition(right.id, 1, 0, 0);
  const dGeomID both[] = {left.id, right.id};
  const dGeomID box = dCreateBox(nullptr, 0.4, 0.4, 0.4);
  dGeomSetPosition(box, 0.5, 0, 0.34);
  REQUIRE(dGpuTriMeshJoin(both, 2) == 2);
  auto contacts = collide(left.id, box);
  for (const dContactGeom& c : collide(right.id, box)) contacts.push_back(c);
  CHECK(contacts.size() == 4);
  for (const dContactGeom& c : contacts) CHECK(c.depth == Approx(0.01).margin(1e-6));
  dGeomDestroy(box);
}
