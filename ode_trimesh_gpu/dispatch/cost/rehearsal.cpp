// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost/rehearsal.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <vector>

#include "dispatch/cost/calibration_mesh.h"
#include "opencl/runtime/stop.h"

namespace otg {
namespace {

struct Bodies {
  std::shared_ptr<const CollisionMesh> a, b;
  explicit Bodies(int steps) : a(calibrationBody(steps, 0)), b(calibrationBody(steps, 1)) {}
  Query at(double distance, ContactModel contacts) const {
    Query query;
    query.a = a.get();
    query.b = b.get();
    query.bInA = Transformd{{1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8}, {0.6 * distance, 0.48 * distance, 0.64 * distance}};
    query.options.contacts = contacts;
    query.options.maxContacts = 64;
    return query;
  }
};

/// Meshes that leave to double arithmetic what it cannot decide, and one that is no solid.
struct FlatThings {
  std::shared_ptr<const CollisionMesh> wedge = calibrationMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                               {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{0, 3, 2}}});
  std::shared_ptr<const CollisionMesh> sheet =
      calibrationMesh({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {{{0, 1, 2}}, {{0, 2, 3}}});
};

/// One upon the other: `a` and `b` where they were made.
Query inPlace(const CollisionMesh& a, const CollisionMesh& b, ContactModel contacts) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
  query.options.contacts = contacts;
  query.options.maxContacts = 64;
  return query;
}

/// Results of a device beside those of the CPU, byte for byte. Both stay false or true once they are.
class Compared {
 public:
  explicit Compared(opencl::Backend& backend) : backend_(backend) {}
  /// No call has failed.
  bool good() const { return good_; }
  /// A result of a call that did not fail differs from the CPU's.
  bool differs() const { return differs_; }

  void collide(const Query& query) {
    opencl::checkStop();
    const bool done = backend_.collide(query, device_);
    otg::collide(query, host_);
    note(done, same(device_.reduced, host_.reduced));
  }
  void findPairs(const Query& query) {
    opencl::checkStop();
    const bool done = backend_.findIntersectingPairs(query, device_);
    findIntersectingPairs(query, host_);
    note(done, device_.intersecting == host_.intersecting);
  }
  void collideBatch(const std::vector<Query>& queries) {
    opencl::checkStop();
    const bool done = backend_.collideBatch(queries, answer_);
    bool right = answer_.size() == queries.size();
    for (std::size_t i = 0; right && i < queries.size(); ++i) {
      const bool isAsBefore = i > 0 && queries[i].a == queries[i - 1].a && queries[i].bInA.t == queries[i - 1].bInA.t;
      if (!isAsBefore) otg::collide(queries[i], host_);
      right = same(answer_.of(i), host_.reduced);
    }
    note(done, right);
  }
  void meet(const std::vector<Query>& queries) {
    opencl::checkStop();
    std::vector<std::uint8_t> answers;
    const bool done = backend_.intersectBatch(queries, answers);
    bool right = answers.size() == queries.size();
    for (std::size_t i = 0; right && i < queries.size(); ++i) {
      findIntersectingPairs(queries[i], host_);
      right = (answers[i] != 0) != host_.intersecting.empty();
    }
    note(done, right);
  }
  void note(bool done, bool right) {
    good_ = good_ && done;
    differs_ = differs_ || (done && !right);
  }

 private:
  static bool same(std::span<const Contact> x, std::span<const Contact> y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Contact& a, const Contact& b) {
      return a.position == b.position && a.normal == b.normal && a.depth == b.depth && a.triangleA == b.triangleA &&
             a.triangleB == b.triangleB && a.region == b.region;
    });
  }

  opencl::Backend& backend_;
  Workspace device_, host_;
  opencl::BatchAnswer answer_;
  bool good_ = true, differs_ = false;
};

/// Exact arithmetic: with few open hits and with many, contacts and pairs alone; in batches, too. And a sheet.
void rehearseFlat(Compared& device, const Bodies& small, bool solids) {
  const FlatThings flat;
  const Query few = inPlace(*flat.wedge, *flat.wedge, ContactModel::kPairwise);
  const Query many = inPlace(*small.a, *small.a, ContactModel::kPairwise);
  Query asCone = few;
  asCone.options.reduction.method = Reduction::kCone;
  for (const Query* query : std::initializer_list<const Query*>{&few, &many, &asCone}) device.collide(*query);
  // A lane's first query with open hits has the CPU decide them.
  for (int i = 0; i < 2; ++i) device.findPairs(few);
  device.collideBatch({few, many, few});
  if (solids) device.collideBatch(std::vector<Query>(2, inPlace(*small.a, *flat.sheet, ContactModel::kSolid)));
}

/// Pairs alone, with few hits and with many; twice, because a query goes by what the last one found.
void rehearsePairs(Compared& device, const Bodies& small, const Bodies& large, bool solids) {
  for (const ContactModel contacts : {ContactModel::kPairwise, ContactModel::kSolid}) {
    if (contacts == ContactModel::kSolid && !solids) continue;
    for (const Bodies* bodies : {&small, &large, &large}) device.collide(bodies->at(1.4, contacts));
  }
  device.findPairs(small.at(1.8, ContactModel::kPairwise));
}

void rehearseBatches(Compared& device, const Bodies& small, const Bodies& large, bool solids) {
  std::vector<Query> queries;
  for (const double distance : {1.97, 1.4, 0.9}) queries.push_back(small.at(distance, ContactModel::kPairwise));
  queries.push_back(large.at(1.4, ContactModel::kPairwise));
  device.collideBatch(queries);
  device.meet(queries);
  if (!solids) return;
  for (Query& query : queries) query.options.contacts = ContactModel::kSolid;
  constexpr std::size_t kDescribed = 64;  // fewer are not described
  queries.insert(queries.end(), kDescribed, large.at(1.8, ContactModel::kSolid));
  device.collideBatch(queries);
}

bool rehearseArrays(opencl::Backend& backend, const Bodies& small) {
  constexpr std::size_t kCount = 64;
  const auto fillPoints = [](std::size_t begin, std::size_t end, Vec3d* to) {
    std::fill(to, to + (end - begin), Vec3d{0.3, 0.2, 1.1});
  };
  const auto takePoints = [](std::size_t, std::size_t, const Vec3d*, const otg_uint*) {};
  const auto fillRays = [](std::size_t begin, std::size_t end, LongRay* to) {
    std::fill(to, to + (end - begin), LongRay{{{3, 0.1, 0.1}, {-1, 0, 0}}, 10});
  };
  const auto takeRays = [](std::size_t, std::size_t, const LongRay*, const otg_uint*) {};
  const opencl::RunParts run = [](std::size_t count, const auto& work) { work(0, count); };
  bool good = true;
  for (const opencl::PointRequest request : {opencl::PointRequest{true, false}, {false, true}, {true, true}}) {
    if (!backend.answersPoints()) break;
    good = backend.askPoints(*small.a, request, kCount, fillPoints, takePoints) == kCount && good;
  }
  for (const bool cullBack : {false, true}) {
    if (!backend.answersRays()) break;
    good = backend.castRays(*small.a, cullBack, kCount, fillRays, takeRays) == kCount && good;
  }
  if (!backend.answersDistances()) return good;
  const Query apart = small.at(3, ContactModel::kPairwise);
  TrianglePair nearest;
  return backend.nearestTriangles({&apart, 1}, std::numeric_limits<double>::infinity(), {&nearest, 1}, run) == 1 &&
         good;
}

}  // namespace

bool mayDoSolids(const opencl::Backend& backend) {
  return backend.device().kind != opencl::DeviceKind::kCpu && backend.device().doubles;
}

Rehearsed rehearse(opencl::Backend& backend) {
  const Bodies small(6), large(36);
  const bool solids = mayDoSolids(backend);
  for (std::size_t failed = backend.failedPrograms();;) {
    Compared device(backend);
    rehearsePairs(device, small, large, solids);
    if (device.good()) rehearseBatches(device, small, large, solids);
    if (device.good()) rehearseFlat(device, small, solids);
    if (device.differs()) return Rehearsed::kDiffers;
    if (device.good() && rehearseArrays(backend, small)) return Rehearsed::kGood;
    // Once more without what could not be built.
    if (backend.failedPrograms() == failed) return Rehearsed::kFailed;
    failed = backend.failedPrograms();
  }
}

bool agreesWithHost(opencl::Backend& backend) {
  const Bodies small(6);
  std::vector<Query> queries;
  queries.reserve(8);
  for (int i = 0; i < 8; ++i) queries.push_back(small.at(1.9 - 0.15 * i, ContactModel::kPairwise));
  Compared device(backend);
  device.collide(queries[3]);
  device.collideBatch(queries);
  return !device.differs();
}

}  // namespace otg
