// SPDX-License-Identifier: BSD-3-Clause
// What becomes of each pair of a batch, and how a batch is cut: decided without a device.
#include <limits>
#include <numeric>
#include <vector>

#include "opencl/batch/pieces.h"
#include "opencl/batch/routing.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::opencl;

namespace {

constexpr otg_uint why(otg_uint reasons) {
  return reasons << OTG_PAIR_WHY;
}

constexpr BatchRules kContacts{}, kDescribes{.describes = true}, kRecordsOfAll{.recordsOfAll = true};
constexpr otg_uint kByCells = OTG_PAIR_TO_HOST | why(OTG_SOLID_ODD | OTG_SOLID_BY_CELLS);

struct Row {
  const char* what;
  otg_uint flags;
  BatchRules rules;
  bool doneMeanwhile;
  Fate fate;
};

const Row kRows[] = {
    {"nothing to say", 0, kContacts, false, Fate::kDevice},
    {"contacts by the other model", OTG_PAIR_PAIRWISE, kDescribes, false, Fate::kDevice},
    {"many hits", OTG_PAIR_MANY, kContacts, false, Fate::kDevice},
    {"certain to intersect", OTG_PAIR_INTERSECTS, kContacts, false, Fate::kDevice},
    {"certain, with open hits", OTG_PAIR_INTERSECTS | OTG_PAIR_TO_HOST, kContacts, false, Fate::kDevice},
    {"refused", OTG_PAIR_REFUSED, kContacts, false, Fate::kRefused},
    {"refused goes first", OTG_PAIR_REFUSED | OTG_PAIR_NO_FRAME | OTG_PAIR_TO_HOST | OTG_PAIR_SKIPPED, kRecordsOfAll,
     true, Fate::kRefused},
    {"no frame", OTG_PAIR_NO_FRAME | OTG_PAIR_TO_HOST, kContacts, false, Fate::kWithoutDevice},
    {"no frame before what was made meanwhile", OTG_PAIR_NO_FRAME | OTG_PAIR_TO_HOST, kContacts, true,
     Fate::kWithoutDevice},
    {"no frame before skipped", OTG_PAIR_NO_FRAME | OTG_PAIR_SKIPPED, kContacts, false, Fate::kWithoutDevice},
    {"skipped", OTG_PAIR_SKIPPED, kContacts, false, Fate::kSettled},
    {"skipped, where all have records", OTG_PAIR_SKIPPED, kRecordsOfAll, false, Fate::kSettled},
    {"left", OTG_PAIR_TO_HOST, kContacts, false, Fate::kRecords},
    {"left, with many hits", OTG_PAIR_TO_HOST | OTG_PAIR_MANY, kContacts, false, Fate::kRecords},
    {"left, and made meanwhile", OTG_PAIR_TO_HOST, kContacts, true, Fate::kMeanwhile},
    {"made meanwhile rather than described", kByCells, kDescribes, true, Fate::kMeanwhile},
    {"made meanwhile, but the device has it", OTG_PAIR_INTERSECTS, kDescribes, true, Fate::kDevice},
    {"by cells", kByCells, kDescribes, false, Fate::kDescribed},
    {"by cells, where nothing is described", kByCells, kContacts, false, Fate::kRecords},
    {"left, and not by cells", OTG_PAIR_TO_HOST | why(OTG_SOLID_ODD), kDescribes, false, Fate::kRecords},
    {"records of all", 0, kRecordsOfAll, false, Fate::kRecords},
    {"records of all, certain to intersect", OTG_PAIR_INTERSECTS, kRecordsOfAll, false, Fate::kRecords},
};

}  // namespace

TEST_CASE("every row of the table: after the batch") {
  for (const Row& row : kRows) {
    INFO(row.what);
    CHECK(fateAfter(row.flags, row.rules, row.doneMeanwhile) == row.fate);
  }
}

TEST_CASE("every row of the table: before a pair is sent, and after a failed call") {
  CHECK(fateBefore({}) == Fate::kDevice);
  CHECK(fateBefore({.idle = true}) == Fate::kWithoutDevice);
  CHECK(fateBefore({.host = true}) == Fate::kWithoutDevice);
  CHECK(fateBefore({.large = true}) == Fate::kAlone);
  CHECK(fateBefore({.large = true, .idle = true}) == Fate::kAlone);
  for (const bool large : {false, true}) {
    for (const bool idle : {false, true}) {
      CHECK(fateBefore({true, large, idle}) == Fate::kRefused);
      CHECK(fateBefore({true, large, idle, true}) == Fate::kRefused);
    }
  }
  CHECK(fateAfterFailure(false, false) == Fate::kWithoutDevice);
  CHECK(fateAfterFailure(false, true) == Fate::kMeanwhile);
  CHECK(fateAfterFailure(true, false) == Fate::kRefused);
  CHECK(fateAfterFailure(true, true) == Fate::kRefused);
}

TEST_CASE("flags of all kinds: a pair without those that leave it out is the device's, and never else if all is") {
  constexpr otg_uint kFlags = 2 * OTG_PAIR_PAIRWISE;
  for (otg_uint flags = 0; flags < kFlags; ++flags) {
    INFO(flags);
    if ((flags & kNotByDevice) == 0) {
      CHECK(fateAfter(flags, kContacts, false) == Fate::kDevice);
      CHECK(fateAfter(flags, kDescribes, true) == Fate::kDevice);
    }
    CHECK(fateAfter(flags, kRecordsOfAll, false) != Fate::kDevice);
    // What a pair is found to be early it is in the end.
    if (isLeftEarly(flags) && !(flags & OTG_PAIR_INTERSECTS)) {
      CHECK(fateAfter(flags, kContacts, false) == Fate::kRecords);
      CHECK(fateAfter(flags, kContacts, true) == Fate::kMeanwhile);
    }
    if (isRemembered(flags)) CHECK(fateAfter(flags, kDescribes, false) == Fate::kDevice);
  }
}

TEST_CASE("what is left early, and what is remembered") {
  CHECK(isLeftEarly(OTG_PAIR_TO_HOST));
  CHECK(isLeftEarly(OTG_PAIR_TO_HOST | OTG_PAIR_MANY));
  for (const otg_uint other : {OTG_PAIR_REFUSED, OTG_PAIR_NO_FRAME, OTG_PAIR_SKIPPED}) {
    CHECK_FALSE(isLeftEarly(OTG_PAIR_TO_HOST | other));
    CHECK_FALSE(isLeftEarly(other));
    CHECK_FALSE(isRemembered(other));
  }
  CHECK_FALSE(isLeftEarly(0));
  CHECK(isRemembered(0));
  CHECK(isRemembered(OTG_PAIR_MANY));
  CHECK_FALSE(isRemembered(OTG_PAIR_TO_HOST));
  CHECK_FALSE(isRemembered(OTG_PAIR_PAIRWISE));
}

TEST_CASE("overlaps that may be described") {
  CHECK(mayBeDescribed(kByCells));
  CHECK_FALSE(mayBeDescribed(OTG_PAIR_TO_HOST));
  CHECK_FALSE(mayBeDescribed(why(OTG_SOLID_ODD | OTG_SOLID_TOO_MANY)));
  CHECK_FALSE(mayBeDescribed(kByCells | why(OTG_SOLID_BROKEN)));
  CHECK(mayBeDescribed(why(OTG_SOLID_AT_ODDS | OTG_SOLID_BROKEN)));
  for (const otg_uint reason : {OTG_SOLID_INEXACT, OTG_SOLID_CONTAINED, OTG_SOLID_TIE}) {
    CHECK_FALSE(mayBeDescribed(kByCells | why(reason)));
    CHECK_FALSE(mayBeDescribed(why(OTG_SOLID_AT_ODDS | reason)));
  }
}

TEST_CASE("rules about numbers of pairs, at their limits") {
  CHECK(isForHostMeanwhile(0, 0, 64, 64));
  CHECK(isForHostMeanwhile(64, 63, 64, 64));
  CHECK_FALSE(isForHostMeanwhile(65, 0, 64, 64));
  CHECK_FALSE(isForHostMeanwhile(64, 64, 64, 64));
  CHECK(areWorthDescribing(64, 64));
  CHECK_FALSE(areWorthDescribing(63, 64));
  CHECK(mayWait(64, true, true, 64));
  CHECK_FALSE(mayWait(65, true, true, 64));
  CHECK_FALSE(mayWait(1, false, true, 64));
  CHECK_FALSE(mayWait(1, true, false, 64));
}

TEST_CASE("a batch is cut into pieces that follow each other and are large enough") {
  Tuning tuning;
  tuning.batchPairs = 100;
  tuning.pieces = 4;
  tuning.leastPiece = 20;
  CHECK(cutBatch(0, tuning, false).empty());
  for (const std::size_t pairs : {1u, 19u, 20u, 21u, 79u, 80u, 99u, 100u, 101u, 250u}) {
    for (const bool inOnePiece : {false, true}) {
      INFO(pairs << (inOnePiece ? " in one piece" : ""));
      std::size_t next = 0;
      for (const std::vector<PairRange>& submission : cutBatch(pairs, tuning, inOnePiece)) {
        std::size_t sum = 0;
        CHECK(submission.size() <= (inOnePiece ? 1 : tuning.pieces));
        for (const PairRange& piece : submission) {
          CHECK(piece.begin == next);
          CHECK((piece.count >= tuning.leastPiece || next + piece.count == pairs || sum + piece.count == 100));
          next += piece.count;
          sum += piece.count;
        }
        CHECK((sum == tuning.batchPairs || next == pairs));
      }
      CHECK(next == pairs);
    }
  }
  CHECK(cutBatch(80, tuning, false) == std::vector<std::vector<PairRange>>{{{0, 20}, {20, 20}, {40, 20}, {60, 20}}});
  CHECK(cutBatch(130, tuning, true) == std::vector<std::vector<PairRange>>{{{0, 100}}, {{100, 30}}});
  tuning.batchPairs = tuning.pieces = 0;  // as one
  CHECK(cutBatch(2, tuning, false) == std::vector<std::vector<PairRange>>{{{0, 1}}, {{1, 1}}});
}

TEST_CASE("no piece has more work than a launch may have, but for a pair that has by itself") {
  std::uint32_t state = 1;
  for (int round = 0; round < 200; ++round) {
    std::vector<double> work;
    for (int i = 0; i < 1 + round; ++i) {
      state = state * 1664525u + 1013904223u;
      work.push_back(static_cast<double>(1 + state % (i % 7 == 0 ? 1000000 : 1000)));
    }
    Tuning tuning;
    tuning.batchPairs = 70;
    tuning.leastPiece = 10;
    tuning.batchWork = 5000;
    std::size_t next = 0;
    for (const std::vector<PairRange>& submission : cutPieces(cutBatch(work.size(), tuning, false), work, tuning)) {
      REQUIRE((!submission.empty() && submission.size() <= tuning.pieces));
      for (const PairRange& piece : submission) {
        REQUIRE(piece.begin == next);
        REQUIRE(piece.count > 0);
        const auto first = work.begin() + static_cast<std::ptrdiff_t>(next);
        const double sum = std::accumulate(first, first + static_cast<std::ptrdiff_t>(piece.count), 0.0);
        REQUIRE((sum <= tuning.batchWork || piece.count == 1));
        next += piece.count;
      }
    }
    CHECK(next == work.size());
  }
  CHECK(cutByWork({}, 1).empty());
  const double equal[] = {4, 4, 4, 4, 4};
  CHECK(cutByWork(equal, 8) == std::vector<std::size_t>{2, 4, 5});
  CHECK(cutByWork(equal, 100) == std::vector<std::size_t>{5});
}

TEST_CASE("halves of a piece are the piece") {
  for (std::size_t count = 2; count < 9; ++count) {
    const auto [first, second] = halvesOf({7, count});
    CHECK(first.begin == 7);
    CHECK(first.count >= 1);
    CHECK(second == PairRange{7 + first.count, count - first.count});
    CHECK(second.count - first.count <= 1);
  }
}

TEST_CASE("a piece has the meshes that its tasks name, under numbers of its own") {
  const auto box = scenes::build(scenes::makeBox({1, 1, 1}, 1));
  const CollisionMesh one(box, BuildStrategy::kSah), two(box, BuildStrategy::kSah), three(box, BuildStrategy::kSah);
  const std::vector<const CollisionMesh*> all{&one, &two, &three};
  const auto numbers = [](const PieceMeshes& meshes) {
    std::vector<otg_batch_task> tasks(2);
    tasks[0].meshA = tasks[1].meshB = 2;
    tasks[0].meshB = tasks[1].meshA = 1;
    meshes.renumber(tasks);
    return std::vector<otg_uint>{tasks[0].meshA, tasks[0].meshB, tasks[1].meshA, tasks[1].meshB};
  };
  PieceMeshes meshes;
  meshes.takeAll(all);
  CHECK(meshes.list() == all);
  CHECK(numbers(meshes) == std::vector<otg_uint>{2, 1, 1, 2});
  meshes.clear(all.size());
  for (const std::uint32_t mesh : {2u, 1u, 1u, 2u}) meshes.use(all, mesh);
  CHECK(meshes.list() == std::vector<const CollisionMesh*>{&three, &two});
  CHECK(numbers(meshes) == std::vector<otg_uint>{0, 1, 1, 0});
  meshes.takeAll(all);
  CHECK(meshes.list() == all);
  CHECK(numbers(meshes) == std::vector<otg_uint>{2, 1, 1, 2});
}
