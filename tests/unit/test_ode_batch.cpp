// SPDX-License-Identifier: BSD-3-Clause
// Arrays of pairs, at once and in the background: each pair has what dCollide gives it.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <thread>

#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Geoms of all kinds in a heap, made the same way each time.
struct Heap {
  std::vector<std::unique_ptr<Data>> data;
  std::vector<dGeomID> geoms;

  explicit Heap(unsigned seed, int count = 24) {
    for (const scenes::MeshArrays& arrays :
         {scenes::makeLump(0.5, 3, 0.4, 4), scenes::makeBox({1, 0.7, 0.5}, 2), scenes::makeTorus(0.5, 0.2, 20, 9),
          scenes::makeGround(2, 0.5, 6), scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})}) {
      data.push_back(std::make_unique<Data>(arrays));
    }
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
      geoms.push_back(dCreateGpuTriMesh(nullptr, data[static_cast<std::size_t>(i) % data.size()]->id));
      setRandomPose(geoms.back(), random, 0.8);
      if (i % 7 == 3) usePairwise(geoms.back());
    }
  }
  ~Heap() {
    for (const dGeomID geom : geoms) dGeomDestroy(geom);
  }
  Heap(const Heap&) = delete;
  Heap& operator=(const Heap&) = delete;

  /// Every pair, in both orders by turns, some of them twice.
  std::vector<dGpuTriMeshPair> pairs() const {
    std::vector<dGpuTriMeshPair> all;
    for (std::size_t i = 0; i < geoms.size(); ++i) {
      for (std::size_t k = i + 1; k < geoms.size(); ++k) {
        all.push_back((i + k) % 2 == 0 ? dGpuTriMeshPair{geoms[i], geoms[k]} : dGpuTriMeshPair{geoms[k], geoms[i]});
        if ((i + k) % 11 == 0) all.push_back({geoms[i], geoms[k]});
      }
    }
    return all;
  }
  std::vector<unsigned char> history() const {
    std::vector<unsigned char> bytes(dGpuTriMeshHistorySave(geoms.data(), static_cast<int>(geoms.size()), nullptr, 0));
    dGpuTriMeshHistorySave(geoms.data(), static_cast<int>(geoms.size()), bytes.data(), bytes.size());
    return bytes;
  }
  std::vector<duint64> stats() const {
    std::vector<duint64> all;
    for (const dGeomID geom : geoms) {
      dGpuTriMeshStats s;
      dGpuTriMeshStatsInit(&s);
      dGeomGpuTriMeshGetStats(geom, &s);
      all.insert(all.end(), {s.queries, s.failed_queries, s.box_tests, s.candidate_pairs, s.intersecting_pairs,
                             s.contacts_before_reduction, s.contacts});
    }
    return all;
  }
};

using Lists = std::vector<std::vector<dContactGeom>>;

/// Two heaps have other geoms: contacts are compared by places in the list.
Lists named(Lists lists, const Heap& heap) {
  const auto number = [&](dGeomID geom) {
    const auto at = std::find(heap.geoms.begin(), heap.geoms.end(), geom) - heap.geoms.begin();
    return reinterpret_cast<dGeomID>(static_cast<std::uintptr_t>(at + 1));
  };
  for (auto& list : lists) {
    for (dContactGeom& c : list) {
      c.g1 = number(c.g1);
      c.g2 = number(c.g2);
    }
  }
  return lists;
}

bool sameLists(const Lists& x, const Lists& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), sameContacts);
}

Lists oneByOne(const std::vector<dGpuTriMeshPair>& pairs, int places, unsigned flags) {
  Lists lists;
  for (const dGpuTriMeshPair& pair : pairs) lists.push_back(test::collide(pair.o1, pair.o2, places, flags));
  return lists;
}

Lists asArray(const std::vector<dGpuTriMeshPair>& pairs, int places, unsigned flags) {
  std::vector<dContactGeom> contacts(pairs.size() * static_cast<std::size_t>(places));
  std::vector<int> counts(pairs.size(), -1);
  const int all = dGpuTriMeshCollidePairs(pairs.data(), static_cast<int>(pairs.size()),
                                          static_cast<int>(static_cast<unsigned>(places) | flags), contacts.data(),
                                          sizeof(dContactGeom), counts.data());
  Lists lists;
  int sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    REQUIRE(counts[i] >= 0);
    const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(i * static_cast<std::size_t>(places));
    lists.emplace_back(begin, begin + counts[i]);
    sum += counts[i];
  }
  CHECK(all == sum);
  return lists;
}

Lists collect(dGpuTriMeshBatchID batch, std::size_t pairs) {
  const int all = dGpuTriMeshBatchWait(batch);
  REQUIRE(all >= 0);
  CHECK(dGpuTriMeshBatchIsDone(batch) == 1);
  std::vector<dContactGeom> contacts(static_cast<std::size_t>(all));
  std::vector<int> first(pairs + 1);
  CHECK(dGpuTriMeshBatchCollect(batch, contacts.data(), sizeof(dContactGeom), nullptr, 0, first.data()) == all);
  Lists lists;
  for (std::size_t i = 0; i < pairs; ++i)
    lists.emplace_back(contacts.begin() + first[i], contacts.begin() + first[i + 1]);
  return lists;
}

}  // namespace

TEST_CASE("an array of pairs has the contacts, the history and the statistics of one dCollide after the other") {
  const OdeSession session;
  // The last round is worked on by the caller's own scheduler, which takes one task after the other.
  std::atomic<int> tasks{0};
  const auto runner = [](void* data, int count, dGpuTriMeshTask* task, void* context) {
    *static_cast<std::atomic<int>*>(data) += count;
    for (int i = 0; i < count; ++i) task(context, i);
  };
  for (const int threads : {1, 2, 3, 4, 5}) {
    CHECK(dGpuTriMeshSetThreadCount(threads) == dGPUTRIMESH_OK);
    if (threads == 5) CHECK(dGpuTriMeshSetTaskRunner(runner, &tasks) == dGPUTRIMESH_OK);
    for (const unsigned flags : {0u, unsigned{CONTACTS_UNIMPORTANT}}) {
      for (const int places : {1, 6, 200}) {
        INFO(threads << " threads, " << places << " places, flags " << flags);
        const Heap x(5), y(5);
        for (int round = 0; round < 2; ++round) {
          const Lists expected = oneByOne(x.pairs(), places, flags);
          CHECK(expected.size() > 250);
          const Lists found = asArray(y.pairs(), places, flags);
          CHECK(sameLists(named(expected, x), named(found, y)));
          CHECK(x.history() == y.history());
          CHECK(x.stats() == y.stats());
        }
      }
    }
  }
  CHECK(tasks > 0);
  CHECK(dGpuTriMeshSetTaskRunner(nullptr, nullptr) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshSetThreadCount(0) == dGPUTRIMESH_OK);
}

TEST_CASE("a skip, and geoms that have nothing to do with each other") {
  const OdeSession session;
  Heap heap(2, 6);
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dGeomSetBody(heap.geoms[0], body);
  dGeomSetBody(heap.geoms[1], body);
  dGeomSetPosition(heap.geoms[5], std::numeric_limits<dReal>::infinity(), 0, 0);
  const Geom empty(*std::make_unique<Data>(scenes::MeshArrays{}));
  const std::vector<dGpuTriMeshPair> pairs = {{heap.geoms[0], heap.geoms[1]},
                                              {heap.geoms[2], heap.geoms[2]},
                                              {heap.geoms[2], heap.geoms[5]},
                                              {heap.geoms[2], empty.id},
                                              {heap.geoms[2], heap.geoms[3]}};
  struct Slot {
    dContactGeom contact;
    int mine;
  };
  std::vector<Slot> slots(pairs.size() * 8);
  for (Slot& slot : slots) slot.mine = 77;
  int counts[5];
  dGpuTriMeshGetError();
  const int all = dGpuTriMeshCollidePairs(pairs.data(), 5, 8, &slots[0].contact, sizeof(Slot), counts);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_POSE);
  const std::vector<dContactGeom> expected = test::collide(heap.geoms[2], heap.geoms[3], 8);
  REQUIRE(!expected.empty());
  CHECK(all == static_cast<int>(expected.size()));
  for (int i = 0; i < 4; ++i) CHECK(counts[i] == 0);
  REQUIRE(counts[4] == all);
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(sameContact(slots[4 * 8 + i].contact, expected[i]));
  for (const Slot& slot : slots) CHECK(slot.mine == 77);
  dWorldDestroy(world);
}

TEST_CASE("pairs that fail are counted, and the others of an array have their contacts") {
  const OdeSession session;
  const auto spoil = [](const Heap& heap) {
    const dMatrix3 stretched = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0};
    dGeomSetRotation(heap.geoms[9], stretched);
    dGeomGpuTriMeshSetCallback(heap.geoms[4], [](dGeomID, dGeomID, int triangle) { return triangle % 3 != 0 ? 1 : 0; });
    dGeomGpuTriMeshSetData(heap.geoms[6], nullptr);
  };
  const Heap x(17), y(17);
  spoil(x);
  spoil(y);
  for (int round = 0; round < 2; ++round) {
    const Lists expected = oneByOne(x.pairs(), 8, 0);
    CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_POSE);
    CHECK(dGpuTriMeshBatchWait(nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);  // another error than that
    const Lists found = asArray(y.pairs(), 8, 0);
    CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_POSE);
    CHECK(sameLists(named(expected, x), named(found, y)));
    CHECK(x.history() == y.history());
    CHECK(x.stats() == y.stats());
  }
}

TEST_CASE("what is remembered of a pair goes with its contacts, whatever model has them, or when it is unwanted") {
  const OdeSession session;
  for (const bool array : {false, true}) {
    INFO((array ? "an array" : "one by one"));
    Heap heap(1, 0);
    // Boxes of 1 x 0.7 x 0.5.
    for (int i = 0; i < 2; ++i) heap.geoms.push_back(dCreateGpuTriMesh(nullptr, heap.data[1]->id));
    const std::size_t nothing = heap.history().size();
    const dGpuTriMeshPair pair{heap.geoms[0], heap.geoms[1]};
    const auto collide = [&](dReal height) {
      dGeomSetPosition(pair.o2, 0.1, 0.2, height);
      const Lists lists = array ? asArray({pair}, 8, 0) : oneByOne({pair}, 8, 0);
      return !lists[0].empty();
    };
    const dReal touching = 0.45, near = 0.55;
    CHECK(collide(touching));
    CHECK(heap.history().size() > nothing);
    usePairwise(pair.o1);
    CHECK(collide(touching));
    CHECK(heap.history().size() > nothing);
    CHECK(!collide(near));
    CHECK(heap.history().size() == nothing);
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    CHECK(dGeomGpuTriMeshSetParams(pair.o1, &params) == dGPUTRIMESH_OK);
    CHECK(collide(touching));
    CHECK(heap.history().size() > nothing);
    params.history = dGPUTRIMESH_HISTORY_OFF;
    CHECK(dGeomGpuTriMeshSetParams(pair.o1, &params) == dGPUTRIMESH_OK);
    CHECK(collide(touching));
    CHECK(heap.history().size() == nothing);
  }
}

TEST_CASE("arguments that are refused change nothing") {
  const OdeSession session;
  const Heap heap(1, 2);
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  const dGpuTriMeshPair good{heap.geoms[0], heap.geoms[1]}, bad[] = {good, {heap.geoms[0], sphere}};
  dContactGeom contacts[8];
  int counts[2] = {-5, -5};
  const auto refuse = [&](int status, int result) {
    CHECK(result == status);
    CHECK(dGpuTriMeshGetError() == status);
  };
  const int size = sizeof(dContactGeom);
  refuse(dGPUTRIMESH_ERROR_CLASS, dGpuTriMeshCollidePairs(bad, 2, 4, contacts, size, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshCollidePairs(nullptr, 1, 4, contacts, size, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshCollidePairs(&good, -1, 4, contacts, size, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshCollidePairs(&good, 1, 0, contacts, size, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshCollidePairs(&good, 1, 4, nullptr, size, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshCollidePairs(&good, 1, 4, contacts, size - 1, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshCollidePairs(&good, 1, 4, contacts, size, nullptr));
  CHECK(counts[0] == -5);
  // Wherever in a large array the geom is, and whether it is read by the time it is found.
  for (const std::size_t at : {std::size_t{0}, std::size_t{63}, std::size_t{64}, std::size_t{1000}}) {
    std::vector<dGpuTriMeshPair> many(1001, good);
    many[at].o1 = sphere;
    std::vector<dContactGeom> places(many.size());
    std::vector<int> ofEach(many.size(), -5);
    const int count = static_cast<int>(many.size());
    refuse(dGPUTRIMESH_ERROR_CLASS, dGpuTriMeshCollidePairs(many.data(), count, 1, places.data(), size, ofEach.data()));
    CHECK(std::count(ofEach.begin(), ofEach.end(), -5) == count);
    CHECK(dGpuTriMeshBatchSubmit(many.data(), count, 1) == nullptr);
  }
  CHECK(dGpuTriMeshCollidePairs(nullptr, 0, 4, nullptr, 0, nullptr) == 0);
  CHECK(dGpuTriMeshBatchSubmit(bad, 2, 4) == nullptr);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_CLASS);
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshBatchWait(nullptr));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshBatchIsDone(nullptr));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshBatchCollect(nullptr, contacts, size, nullptr, 0, counts));
  dGpuTriMeshBatchDestroy(nullptr);
  const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(&good, 1, 4);
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshBatchCollect(batch, nullptr, size, nullptr, 0, counts));
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshBatchCollect(batch, contacts, size - 1, nullptr, 0, counts));
  dGpuTriMeshContactData data[8];
  refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshBatchCollect(batch, contacts, size, data, 3, counts));
  dGpuTriMeshBatchDestroy(batch);
  for (const int count : {-1, 1025}) refuse(dGPUTRIMESH_ERROR_ARGUMENT, dGpuTriMeshSetThreadCount(count));
  dGeomDestroy(sphere);
  for (const duint64 n : heap.stats()) CHECK(n == 0);
}

TEST_CASE("a batch in the background is of the moment of its submission") {
  const OdeSession session;
  const Heap x(9);
  auto y = std::make_unique<Heap>(9);
  const Lists expected = named(oneByOne(x.pairs(), 20, 0), x);
  const std::vector<dGpuTriMeshPair> pairs = y->pairs();
  const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(pairs.data(), static_cast<int>(pairs.size()), 20);
  REQUIRE(batch != nullptr);
  std::mt19937 random(1);
  for (const dGeomID geom : y->geoms) setRandomPose(geom, random, 0.8);
  const Lists found = collect(batch, pairs.size());
  CHECK(sameLists(expected, named(found, *y)));
  CHECK(x.history() == y->history());
  CHECK(x.stats() == y->stats());
  CHECK(sameLists(collect(batch, pairs.size()), found));  // again, without being counted again
  CHECK(x.stats() == y->stats());
  // With the data of the contacts: side numbers and names as CollideEx has them.
  const int all = dGpuTriMeshBatchWait(batch);
  std::vector<dContactGeom> contacts(static_cast<std::size_t>(all));
  std::vector<dGpuTriMeshContactData> data(contacts.size());
  CHECK(dGpuTriMeshBatchCollect(batch, contacts.data(), sizeof(dContactGeom), data.data(),
                                sizeof(dGpuTriMeshContactData), nullptr) == all);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    CHECK(data[i].id != 0);
    CHECK(data[i].triangle1 == contacts[i].side1);
    CHECK(data[i].triangle2 == contacts[i].side2);
  }
  dGpuTriMeshBatchDestroy(batch);

  // Geoms and meshes that go away meanwhile.
  for (int round = 0; round < 5; ++round) {
    auto gone = std::make_unique<Heap>(9);
    const Lists before = named({}, *gone);
    const std::vector<dGpuTriMeshPair> some = gone->pairs();
    const dGpuTriMeshBatchID late = dGpuTriMeshBatchSubmit(some.data(), static_cast<int>(some.size()), 20);
    const std::vector<dGeomID> names = gone->geoms;
    gone.reset();
    Lists lists = collect(late, some.size());
    for (auto& list : lists) {
      for (dContactGeom& c : list) {
        for (dGeomID* g : {&c.g1, &c.g2}) {
          const auto at = std::find(names.begin(), names.end(), *g) - names.begin();
          *g = reinterpret_cast<dGeomID>(static_cast<std::uintptr_t>(at + 1));
        }
      }
    }
    CHECK(sameLists(lists, expected));
    dGpuTriMeshBatchDestroy(late);
  }
}

TEST_CASE("many batches at once, from several threads, some of them given up") {
  const OdeSession session;
  const Heap heap(3, 12);
  for (const dGeomID geom : heap.geoms) {
    dReal aabb[6];
    dGeomGetAABB(geom, aabb);  // ODE computes poses on demand: not while several threads read them
  }
  const std::vector<dGpuTriMeshPair> pairs = heap.pairs();
  const Lists expected = oneByOne(pairs, 16, 0);
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      dAllocateODEDataForThread(dAllocateMaskAll);
      std::vector<dGpuTriMeshBatchID> batches;
      for (int i = 0; i < 6; ++i) {
        batches.push_back(dGpuTriMeshBatchSubmit(pairs.data(), static_cast<int>(pairs.size()), 16));
      }
      for (std::size_t i = 0; i < batches.size(); ++i) {
        if (i % 3 != 2) {
          const int all = dGpuTriMeshBatchWait(batches[i]);
          std::vector<dContactGeom> contacts(static_cast<std::size_t>(all));
          std::vector<int> first(pairs.size() + 1);
          dGpuTriMeshBatchCollect(batches[i], contacts.data(), sizeof(dContactGeom), nullptr, 0, first.data());
          for (std::size_t k = 0; k < pairs.size(); ++k) {
            if (!sameContacts({contacts.begin() + first[k], contacts.begin() + first[k + 1]}, expected[k])) ++wrong;
          }
        }
        dGpuTriMeshBatchDestroy(batches[i]);
      }
      if (t == 0) dGpuTriMeshSetThreadCount(2);
    });
  }
  for (std::thread& thread : threads) thread.join();
  dGpuTriMeshSetThreadCount(0);
  CHECK(wrong == 0);
}
