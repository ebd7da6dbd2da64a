// SPDX-License-Identifier: BSD-3-Clause
// What pairs remember, and so all later contacts, does not depend on how they are requested: one by one, in the other
// order, twice, in arrays, in a whole space, in flight, or computed ahead.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "support/bodies.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr int kMost = 16;

using Saved = std::vector<unsigned char>;

/// A sheet, two equal solids, two meshes that are wound inward, and shapes of ODE's.
class World {
 public:
  World() {
    for (const Data* data : {&sheet_, &ball_, &ball_, &inward_, &ring_}) {
      geoms_.push_back(dCreateGpuTriMesh(space_, data->id));
    }
    meshes_ = static_cast<int>(geoms_.size());
    geoms_.push_back(dCreateSphere(space_, 0.2));
    geoms_.push_back(dCreateCapsule(space_, 0.1, 0.3));
    geoms_.push_back(dCreateBox(space_, 0.3, 0.25, 0.2));
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World() { dSpaceDestroy(space_); }
  int count() const { return static_cast<int>(geoms_.size()); }
  int meshes() const { return meshes_; }
  dGeomID geom(int i) const { return geoms_[static_cast<std::size_t>(i)]; }
  dSpaceID space() const { return space_; }
  /// Of one of the kinds of meshes.
  void setData(int i, int kind) {
    const Data* const all[] = {&sheet_, &ball_, &inward_, &ring_};
    REQUIRE(dGeomGpuTriMeshSetData(geom(i), all[kind]->id) == dGPUTRIMESH_OK);
  }
  void setModel(int i, int model) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    REQUIRE(dGeomGpuTriMeshGetParams(geom(i), &params) == dGPUTRIMESH_OK);
    params.contact_model = model;
    REQUIRE(dGeomGpuTriMeshSetParams(geom(i), &params) == dGPUTRIMESH_OK);
  }
  /// Pair by pair: which was remembered first is of no consequence.
  Saved saved() const {
    Saved all;
    for (int i = 0; i < meshes_; ++i) {
      for (int j = i + 1; j < count(); ++j) {
        const dGeomID pair[] = {geom(i), geom(j)};
        const std::size_t size = dGpuTriMeshHistorySave(pair, 2, nullptr, 0), before = all.size();
        all.resize(before + size);
        REQUIRE(dGpuTriMeshHistorySave(pair, 2, all.data() + before, size) == size);
      }
    }
    return all;
  }
  /// Whose boxes overlap, as a space would hand them over.
  std::vector<dGpuTriMeshPair> pairs(bool ofMeshes, bool ofShapes) const {
    std::vector<dGpuTriMeshPair> all;
    for (int i = 0; i < meshes_; ++i) {
      for (int j = i + 1; j < count(); ++j) {
        if (!(j < meshes_ ? ofMeshes : ofShapes)) continue;
        dReal a[6], b[6];
        dGeomGetAABB(geom(i), a);
        dGeomGetAABB(geom(j), b);
        bool overlap = true;
        for (int k = 0; k < 6; k += 2) overlap = overlap && a[k] <= b[k + 1] && b[k] <= a[k + 1];
        if (overlap) all.push_back({geom(i), geom(j)});
      }
    }
    return all;
  }

 private:
  dSpaceID space_ = dSimpleSpaceCreate(nullptr);
  Data sheet_{
      scenes::makeGround(1.6, 0, 8, [](double x, double y) { return 0.2 * std::sin(4 * x) * std::cos(3 * y); })},
      ball_{scenes::makeSphere(0.4, 2)}, inward_{turned(scenes::makeBox({0.9, 0.8, 0.7}, 2))},
      ring_{turned(scenes::makeTorus(0.4, 0.15, 16, 8))};
  std::vector<dGeomID> geoms_;
  int meshes_ = 0;
};

void collideAll(const std::vector<dGpuTriMeshPair>& pairs, bool swapped) {
  std::vector<dContactGeom> contacts(kMost);
  for (const auto& [o1, o2] : pairs) {
    dCollide(swapped ? o2 : o1, swapped ? o1 : o2, kMost, contacts.data(), sizeof(dContactGeom));
  }
}

/// Shapes are requested one by one in all ways but two.
struct Way {
  const char* name;
  std::function<void(const World&)> ask;
};
const std::vector<Way>& ways() {
  static const std::vector<Way> all = {
      {"swapped", [](const World& w) { collideAll(w.pairs(true, true), true); }},
      {"twice",
       [](const World& w) {
         collideAll(w.pairs(true, true), false);
         collideAll(w.pairs(true, true), false);
       }},
      {"array",
       [](const World& w) {
         std::vector<dGpuTriMeshPair> pairs = w.pairs(true, false);
         const std::size_t once = pairs.size();
         for (std::size_t i = 0; i < once; i += 2) pairs.push_back({pairs[i].o2, pairs[i].o1});
         std::vector<dContactGeom> contacts(pairs.size() * kMost + 1);
         std::vector<int> counts(pairs.size() + 1);
         dGpuTriMeshCollidePairs(pairs.data(), static_cast<int>(pairs.size()), kMost, contacts.data(),
                                 sizeof(dContactGeom), counts.data());
         collideAll(w.pairs(false, true), false);
       }},
      {"batch",
       [](const World& w) {
         const std::vector<dGpuTriMeshPair> pairs = w.pairs(true, false);
         if (!pairs.empty()) {
           const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(pairs.data(), static_cast<int>(pairs.size()), kMost);
           std::vector<dContactGeom> contacts(static_cast<std::size_t>(dGpuTriMeshBatchWait(batch)) + 1);
           std::vector<int> firsts(pairs.size() + 1);
           dGpuTriMeshBatchCollect(batch, contacts.data(), sizeof(dContactGeom), nullptr, 0, firsts.data());
           dGpuTriMeshBatchDestroy(batch);
         }
         collideAll(w.pairs(false, true), false);
       }},
      {"space",
       [](const World& w) {
         std::vector<dContactGeom> contacts(4000);
         dGpuTriMeshCollideSpace(w.space(), kMost, nullptr, nullptr, contacts.data(), sizeof(dContactGeom),
                                 static_cast<int>(contacts.size()));
       }},
      {"computed ahead", [](const World& w) {
         dGpuTriMeshPrefetch(w.space());
         collideAll(w.pairs(true, true), false);
       }}};
  return all;
}

}  // namespace

TEST_CASE("what pairs remember does not depend on how they are requested") {
  const OdeSession session;
  std::size_t wrong = 0, remembered = 0;
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    Draw draw(seed);
    World one, other;
    const auto both = [&](const auto& change) {
      change(one);
      change(other);
    };
    std::vector<Vec3d> places(static_cast<std::size_t>(one.count()));
    const auto place = [&](int i, double angle) {
      const Vec3d axis = draw.direction();
      both([&](World& w) { setPose(w.geom(i), makePose(axis, angle, places[static_cast<std::size_t>(i)])); });
    };
    for (int i = 0; i < one.count(); ++i) {
      places[static_cast<std::size_t>(i)] = otgScale(draw.direction(), 0.5);
      place(i, draw.uniform(0, 3));
    }
    for (int step = 0; step < 50; ++step) {
      const int moved = static_cast<int>(draw.below(static_cast<std::uint32_t>(one.count())));
      const double far = draw.below(4) == 0 ? 0.4 : 0.05;
      Vec3d& at = places[static_cast<std::size_t>(moved)];
      at = otgScale(otgAdd(at, otgScale(draw.direction(), far)), 0.9);
      place(moved, 0.1 * step);
      const int changed = static_cast<int>(draw.below(static_cast<std::uint32_t>(one.meshes())));
      const auto what = draw.below(6);
      const int model = draw.below(2) == 0 ? dGPUTRIMESH_CONTACTS_PAIRWISE : dGPUTRIMESH_CONTACTS_SOLID;
      const int kind = static_cast<int>(draw.below(4));
      if (what == 0) both([&](World& w) { w.setModel(changed, model); });
      if (what == 1) both([&](World& w) { w.setData(changed, kind); });
      const Way& way = ways()[draw.below(static_cast<std::uint32_t>(ways().size()))];
      collideAll(one.pairs(true, true), false);
      way.ask(other);
      const Saved expected = one.saved(), found = other.saved();
      INFO("seed " << seed << ", step " << step << ": " << way.name);
      const bool same = found == expected;
      if (wrong == 0) CHECK(same);
      wrong += same ? 0 : 1;
      remembered += expected.size();
    }
  }
  CHECK(wrong == 0);
  CHECK(remembered > 24 * 50 * 1000);  // two pairs and more, on average
}
