// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/levels_lane.h"

#include <algorithm>
#include <bit>
#include <initializer_list>
#include <string>
#include <utility>

#include "opencl/meshes/pack_mesh.h"

namespace otg::opencl {
namespace {

std::uint32_t groupFor(const Context& context, const Tuning& tuning) {
  const std::uint64_t most = std::min<std::uint64_t>(context.info().largestWorkGroup, 1024);
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(tuning.levelsGroup, 4, std::max<std::uint64_t>(4, most)));
}

/// The nodes at `depth`, and leaves above it: together they hold every triangle.
void appendNodesAt(const BinaryTree& tree, std::uint32_t depth, std::vector<cl_uint>& out) {
  std::vector<cl_uint> level{0}, below;
  for (; depth > 0; --depth) {
    below.clear();
    for (const cl_uint node : level) {
      const BvhNode& n = tree.nodes[node];
      if (n.isLeaf()) {
        below.push_back(node);
      } else {
        below.push_back(static_cast<cl_uint>(n.child));
        below.push_back(static_cast<cl_uint>(n.child) + 1);
      }
    }
    if (below.size() == level.size()) break;  // leaves only
    level.swap(below);
  }
  out.insert(out.end(), level.begin(), level.end());
}

std::string contactOptions(bool contacts, bool reduce) {
  return std::string(" -DOTG_CONTACTS=") + (contacts ? "1" : "0") + " -DOTG_ENTER=" + (reduce ? "1" : "0");
}

/// Of levels_walk.cl.
std::string walkOptions(std::size_t group, bool quantized) {
  return "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_LEAF=1 -DOTG_QUANTIZED=" + (quantized ? "1" : "0");
}

MeshUnit stepUnit(const Vec3f& step) {
  return {step.x, step.y, step.z, 0};
}

/// The nodes of a tree as integers: a unit each, behind two with their steps.
PackedMesh packNodes(const CollisionMesh& mesh) {
  PackedMesh out;
  const auto pack = [&](const QuantizedTree& tree) {
    static_assert(sizeof(QuantizedNode) == sizeof(MeshUnit));
    out.units.reserve(2 + tree.nodes.size());
    out.units.push_back(stepUnit(tree.centerStep));
    out.units.push_back(stepUnit(tree.extentStep));
    for (const QuantizedNode& node : tree.nodes) out.units.push_back(std::bit_cast<MeshUnit>(node));
  };
  if (mesh.boxScale() != nullptr) {
    mesh.withOwnBoxes([&](const BinaryTree& tree) { pack(quantizeTree(tree)); });
  } else {
    pack(mesh.quantized());
  }
  out.place.center = mesh.mesh().origin();
  out.place.radius = mesh.mesh().radius();
  out.place.triangles = static_cast<std::uint32_t>(mesh.mesh().triangleCount());
  return out;
}

/// Of levels_near.cl.
std::string nearOptions(std::size_t group, bool fused, bool contacts, bool reduce) {
  return "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_LEAF=1 -DOTG_FUSED=" + (fused ? "1" : "0") +
         contactOptions(contacts, reduce);
}

}  // namespace

LevelsLane::FusedKernels& LevelsLane::fusedKernels(bool contacts, bool reduce) {
  FusedKernels& kernels = fused_[reduce ? 2 : contacts ? 1 : 0];
  if (kernels.end || kernels.enter) return kernels;
  const std::string options = nearOptions(group_, true, contacts, reduce);
  kernels.near.make(context_, "published/levels_near.cl", options);
  if (reduce) {
    kernels.enter.make(context_, "published/levels_near.cl", options);
  } else {
    kernels.end.make(context_, "published/levels_near.cl", options);
  }
  return kernels;
}

LevelsLane::NearKernels& LevelsLane::nearKernels(bool contacts, bool reduce) {
  NearKernels& kernels = near_[reduce ? 2 : contacts ? 1 : 0];
  if (kernels.records || kernels.entered) return kernels;
  const std::string options = "-DOTG_GROUP=" + std::to_string(tuning_.recordGroup) + contactOptions(contacts, reduce);
  kernels.near.make(context_, "published/levels_near.cl", nearOptions(group_, false, false, false));
  if (reduce) {
    kernels.entered.make(context_, "pairwise/pair_results.cl", options);
  } else {
    kernels.records.make(context_, "pairwise/pair_results.cl", options);
  }
  return kernels;
}

LevelsLane::LevelsLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      group_(groupFor(context, tuning)),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      queue_(context.makeQueue(tuning.profile)),
      sumOfOne_(context, groupFor(context, tuning)),
      sumOfTwo_(context, groupFor(context, tuning)),
      results_(tuning.recordsExpected),
      chosen_(PinnedPool::make(context)),
      reducer_(context, tuning, true),
      profile_(tuning.profile) {
  begin_.make(context, "published/levels_walk.cl", walkOptions(group_, false));
  reset_.make(context, "published/levels_near.cl", nearOptions(group_, false, false, false));
  counters_.reserve(context, OTG_COUNTERS);
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
  totals_.reserve(context, 4);
  next_.reserve(context, tuning.pairPlaces);
  leaves_.reserve(context, tuning.leafPlaces);
  hits_.reserve(context, tuning.hitPlaces);
  reducer_.reserveStates(1);
}

template <class Use>
void LevelsLane::onMeshes(const Query& query, const PairFrame& frame, bool sendTrees, bool nodesAlone, Use&& use) {
  const CollisionMesh* const both[] = {query.a, query.b};
  bytesSent_ = 0;
  MeshStore::Pinned pinned;
  if (!sendTrees) pinned = meshes_.acquire(both);
  otg_device_pair pair{deviceBoxes(frame), frame.floatError, {}, {}};
  try {
    if (sendTrees) {
      send(query, nodesAlone, pair);
    } else {
      pair.a = pinned[0];
      pair.b = pinned[1];
    }
    makeWalk(sendTrees && nodesAlone);
    use(pair, sendTrees ? Meshes(sentUnits_.buffer()) : pinned.units());
    if (profile_.on()) profile_.collect();
  } catch (...) {
    // Meshes, which are not pinned any longer in a moment, may still be read, and what is sent too.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

PairAnswer LevelsLane::run(const Query& query, const PairFrame& frame, bool contacts, const LevelsOptions& how) {
  PairAnswer answer;
  onMeshes(query, frame, how.sendTrees, false, [&](const otg_device_pair& pair, Meshes meshes) {
    answer = runOn(pair, query, meshes, contacts && context_.info().doubles, how);
  });
  return answer;
}

bool LevelsLane::findCandidates(const Query& query, const PairFrame& frame, const LevelsOptions& how,
                                std::vector<TrianglePair>& candidates) {
  static_assert(sizeof(TrianglePair) == sizeof(otg_place_pair));  // places in a soup are numbers here
  candidates.clear();
  bool tooMany = false;
  onMeshes(query, frame, how.sendTrees, true, [&](const otg_device_pair& pair, Meshes meshes) {
    walk(pair, query, meshes, how);
    tooMany = leafCount_ > static_cast<std::uint32_t>(query.options.middle.maxPairs);
    if (leafCount_ == 0 || tooMany) return;
    candidates.resize(leafCount_);
    readBlocking(queue_.get(), leaves_.get(), leafCount_ * sizeof(TrianglePair), candidates.data(),
                 profile_.next(Profile::kReadBack));
  });
  return !tooMany;
}

/// Does not wait. A mesh that meets itself is sent once.
void LevelsLane::send(const Query& query, bool nodesAlone, otg_device_pair& pair) {
  const PackedMesh& a = packed(*query.a, 0, nodesAlone);
  const PackedMesh& b = query.a == query.b ? a : packed(*query.b, 1, nodesAlone);
  const std::size_t unitsB = query.a == query.b ? 0 : b.units.size();
  sentUnits_.reserve(context_, a.units.size() + unitsB);
  const cl_mem to = sentUnits_.get();
  write(to, 0, a.units.size() * sizeof(MeshUnit), a.units.data());
  if (unitsB > 0) write(to, a.units.size() * sizeof(MeshUnit), unitsB * sizeof(MeshUnit), b.units.data());
  pair.a = a.placeAt(0);
  pair.b = unitsB > 0 ? b.placeAt(static_cast<std::uint32_t>(a.units.size())) : pair.a;
}

const PackedMesh& LevelsLane::packed(const CollisionMesh& mesh, int side, bool nodesAlone) {
  const std::weak_ptr<const void> alive = mesh.lifetime();
  const auto isIt = [&](const std::unique_ptr<SentMesh>& sent) {
    return sent && sent->nodesAlone == nodesAlone && !sent->of.owner_before(alive) && !alive.owner_before(sent->of);
  };
  if (!isIt(sent_[side])) {
    sent_[side] = std::make_unique<SentMesh>(
        SentMesh{alive, nodesAlone ? packNodes(mesh) : packMesh(mesh, MeshLayout::kBinary, 1), nodesAlone});
  }
  return sent_[side]->mesh;
}

void LevelsLane::makeWalk(bool nodesAlone) {
  walk_ = &walks_[nodesAlone ? 1 : 0];
  if (walk_->spawn) return;
  const std::string options = walkOptions(group_, nodesAlone);
  walk_->test.make(context_, "published/levels_walk.cl", options);
  walk_->compact.make(context_, "published/levels_walk.cl", options);
  walk_->split.make(context_, "published/levels_walk.cl", options);
  walk_->spawn.make(context_, "published/levels_walk.cl", options);
}

/// Does not wait: `from` has to stay as it is until the queue was waited for.
void LevelsLane::write(cl_mem to, std::size_t offset, std::size_t bytes, const void* from) {
  clDo(OTG_CL(clEnqueueWriteBuffer), queue_.get(), to, cl_bool{CL_FALSE}, offset, bytes, from, cl_uint{0},
       static_cast<const cl_event*>(nullptr), profile_.next(Profile::kWrite));
  bytesSent_ += bytes;
}

PairAnswer LevelsLane::runOn(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts,
                             const LevelsOptions& how) {
  walk(pair, query, meshes, how);
  if (leafCount_ > 0) return decide(pair, query, meshes, contacts, how.fusedNear);
  static constexpr otg_uint kNothing[OTG_COUNTERS] = {};
  PairAnswer answer;
  answer.found.counters = kNothing;
  answer.reduced = contacts;
  return answer;
}

void LevelsLane::walk(const otg_device_pair& pair, const Query& query, Meshes meshes, const LevelsOptions& how) {
  const std::uint32_t startDepth = std::min(how.startDepth, kMostStartDepth);
  prefixSums_ = how.prefixSums;
  steps_.clear();
  leafCount_ = 0;
  std::uint32_t count = begin(query, startDepth);
  for (std::uint32_t depth = startDepth; count > 0; ++depth) {
    LevelsStep counts;
    counts.depth = depth;
    counts.tests = count;
    step(pair, meshes, count);
    distribute(pair, meshes, count, counts);
    steps_.push_back(counts);
    leafCount_ += static_cast<std::uint32_t>(counts.leafPairs);
    count = static_cast<std::uint32_t>(counts.spawned);
    std::swap(now_, next_);
  }
}

/// Writes the pairs to start from to `now_`; their number.
std::uint32_t LevelsLane::begin(const Query& query, std::uint32_t startDepth) {
  startNodes_.clear();
  appendNodesAt(query.a->tree(), startDepth, startNodes_);
  const auto countA = static_cast<cl_uint>(startNodes_.size());
  appendNodesAt(query.b->tree(), startDepth, startNodes_);
  const cl_uint countB = static_cast<cl_uint>(startNodes_.size()) - countA, count = countA * countB;
  starts_.reserve(context_, std::bit_ceil(startNodes_.size()));
  now_.reserve(context_, std::max(tuning_.pairPlaces, std::bit_ceil(count)));
  write(starts_.get(), 0, startNodes_.size() * sizeof(cl_uint), startNodes_.data());
  begin_.give({.starts = starts_.buffer(), .countA = countA, .countB = countB, .pairs = now_.buffer()});
  launch(queue_.get(), begin_, group_, (count + group_ - 1) / group_, 1, profile_.next(Profile::kTop));
  return count;
}

/// Up to the prefix sums by which pairs of leaves and of children are placed.
void LevelsLane::step(const otg_device_pair& pair, Meshes meshes, std::uint32_t count) {
  const cl_command_queue queue = queue_.get();
  const std::size_t groups = (count + group_ - 1) / group_;
  // Four children each have to be counted in 32 bits.
  if (count >= 1u << 30)
    throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "a list outgrows the device");
  for (DeviceList* list : std::initializer_list<DeviceList*>{&overlaps_, &places_, &kept_, &weights_, &placesOfTwo_}) {
    list->reserve(context_, std::bit_ceil(count));
  }
  walk_->test.give(
      {.pair = pair, .meshes = meshes, .pairs = now_.buffer(), .count = count, .overlaps = overlaps_.buffer()});
  launch(queue, walk_->test, group_, groups, 1, profile_.next(Profile::kTest));
  sumOfOne_.enqueue(queue, overlaps_.buffer(), places_.buffer(), count, totals_.buffer(), 0, profile_, prefixSums_);
  walk_->compact.give({.meshes = meshes,
                       .nodesA = pair.a.nodes,
                       .nodesB = pair.b.nodes,
                       .pairs = now_.buffer(),
                       .count = count,
                       .overlaps = overlaps_.buffer(),
                       .places = places_.buffer(),
                       .total = totals_.buffer(),
                       .kept = kept_.buffer(),
                       .weights = weights_.buffer()});
  launch(queue, walk_->compact, group_, groups, 1, profile_.next(Profile::kCompact));
  // Words 2 and 3 of the totals.
  const BufferOf<otg_two_sums> totals(totals_.get());
  sumOfTwo_.enqueue(queue, weights_.buffer(), placesOfTwo_.buffer(), count, totals, 1, profile_, prefixSums_);
}

/// Pairs of leaves to their list, pairs of children to `next_`; again where a list was too short.
void LevelsLane::distribute(const otg_device_pair& pair, Meshes meshes, std::uint32_t count, LevelsStep& counts) {
  const cl_command_queue queue = queue_.get();
  const std::size_t groups = (count + group_ - 1) / group_;
  for (;; ++repeats_) {
    cl_uint totals[4] = {};
    const given::LevelsKept level{.meshes = meshes,
                                  .nodesA = pair.a.nodes,
                                  .nodesB = pair.b.nodes,
                                  .kept = kept_.buffer(),
                                  .weights = weights_.buffer(),
                                  .places = placesOfTwo_.buffer(),
                                  .count = count};
    walk_->split.give(
        {.level = level, .begin = leafCount_, .leaves = leaves_.buffer(), .leafCapacity = leaves_.places()});
    launch(queue, walk_->split, group_, groups, 1, profile_.next(Profile::kSplit));
    walk_->spawn.give({.level = level, .next = next_.buffer(), .nextCapacity = next_.places()});
    launch(queue, walk_->spawn, group_, groups, 1, profile_.next(Profile::kSpawn));
    readBlocking(queue, totals_.get(), sizeof totals, totals, profile_.next(Profile::kReadBack));
    counts.overlapping = totals[0];
    counts.leafPairs = totals[2];
    counts.spawned = totals[3];
    const std::uint64_t leaves = std::uint64_t{leafCount_} + totals[2];
    if (leaves <= leaves_.places() && totals[3] <= next_.places()) return;
    if (leaves > leaves_.places()) growLeaves(leaves);
    next_.reserve(context_, std::bit_ceil(std::uint64_t{totals[3]}));
  }
}

/// Keeps the pairs of leaves that were found so far.
void LevelsLane::growLeaves(std::uint64_t places) {
  ListOf<otg_place_pair> larger;
  larger.reserve(context_, std::bit_ceil(places));
  if (leafCount_ > 0) {
    clDo(OTG_CL(clEnqueueCopyBuffer), queue_.get(), leaves_.get(), larger.get(), std::size_t{0}, std::size_t{0},
         std::size_t{leafCount_ * sizeof(otg_place_pair)}, cl_uint{0}, static_cast<const cl_event*>(nullptr),
         static_cast<cl_event*>(nullptr));
  }
  std::swap(leaves_, larger);
}

PairAnswer LevelsLane::decide(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts,
                              bool fused) {
  const cl_command_queue queue = queue_.get();
  const otg_reduction how = deviceReduction(query.options, !contacts || !reducer_.works());
  const bool reduce = how.method != OTG_REDUCE_BY_HOST && !((pair.a.flags | pair.b.flags) & OTG_MESH_TANGLED);
  PairAnswer answer;
  if (reduce) reducer_.send(queue, {&how, 1});
  for (;; ++repeats_) {
    results_.reserve(context_, hits_.places());
    if (reduce) reducer_.reserve(queue, 1, hits_.places(), how.places);
    chosen_.reserve(context_, 1, reduce ? reducer_.contactsOfPair() : 0);
    enqueueDecision(pair, query, meshes, how, contacts, reduce, fused);
    const otg_uint* counters = reduce ? chosen_.readHead(context_, queue, 1, true, &profile_)
                                      : results_.readHead(context_, queue, contacts, &profile_);
    if (counters[OTG_COUNT_HITS] <= hits_.places()) {
      if (!reduce) {
        answer.found = results_.readRest(context_, queue, contacts, &profile_);
      } else if (chosen_.flags()[0] & OTG_PAIR_TO_HOST) {
        answer.found = results_.readAll(context_, queue, contacts, counters, &profile_);
      } else {
        answer.contacts = chosen_.readRest(context_, queue, chosen_.places()[1], &profile_);
        answer.found.counters = chosen_.counters();
        answer.reduced = true;
      }
      return answer;
    }
    hits_.reserve(context_, std::bit_ceil(std::uint64_t{counters[OTG_COUNT_HITS]}));
  }
}

void LevelsLane::enqueueDecision(const otg_device_pair& pair, const Query& query, Meshes meshes,
                                 const otg_reduction& how, bool contacts, bool reduce, bool fused) {
  const cl_command_queue queue = queue_.get();
  reset_.give({.pair = pair, .state = reducer_.states(), .chosen = chosen_.words(), .method = how.method});
  launch(queue, reset_, group_, 1, 1, profile_.next(Profile::kNear));
  if (fused) {
    enqueueFused(pair, query, meshes, contacts, reduce);
  } else {
    enqueueNear(pair, query, meshes, contacts, reduce);
  }
  if (!reduce) return;
  const Reducer::Hits hits{meshes, counters_.buffer(), results_.bytes(), hits_.places(), 1};
  reducer_.enqueue(queue, hits, chosen_, chosen_.beginAnswer(context_, queue, tuning_.hostAnswers), groups_, profile_);
}

/// As published: one kernel for tests and contacts.
void LevelsLane::enqueueFused(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts,
                              bool reduce) {
  FusedKernels& kernels = fusedKernels(contacts, reduce);
  kernels.near.give({.pair = pair,
                     .bInA = query.bInA,
                     .meshes = meshes,
                     .counters = counters_.buffer(),
                     .leaves = leaves_.buffer(),
                     .count = leafCount_,
                     .hitCapacity = hits_.places(),
                     .results = results_.bytes()});
  launch(queue_.get(), kernels.near, group_, (leafCount_ + group_ - 1) / group_, 1, profile_.next(Profile::kNear));
  if (!reduce) {
    kernels.end.give({.counters = counters_.buffer(), .results = results_.bytes()});
    launch(queue_.get(), kernels.end, group_, groups_, 1, profile_.next(Profile::kRegions));
    return;
  }
  kernels.enter.give({.counters = counters_.buffer(),
                      .results = results_.bytes(),
                      .hitCapacity = hits_.places(),
                      .tables = reducer_.tables(),
                      .state = reducer_.states(),
                      .chosen = chosen_.words()});
  launch(queue_.get(), kernels.enter, group_, groups_, 1, profile_.next(Profile::kRegions));
}

/// A list of hits first, then their records.
void LevelsLane::enqueueNear(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts,
                             bool reduce) {
  NearKernels& kernels = nearKernels(contacts, reduce);
  kernels.near.give({.pair = pair,
                     .meshes = meshes,
                     .counters = counters_.buffer(),
                     .leaves = leaves_.buffer(),
                     .count = leafCount_,
                     .hits = hits_.buffer(),
                     .hitCapacity = hits_.places()});
  launch(queue_.get(), kernels.near, group_, (leafCount_ + group_ - 1) / group_, 1, profile_.next(Profile::kNear));
  const given::PairHits found{.pair = pair,
                              .bInA = query.bInA,
                              .meshes = meshes,
                              .counters = counters_.buffer(),
                              .hits = hits_.buffer(),
                              .hitCapacity = hits_.places(),
                              .results = results_.bytes()};
  if (!reduce) {
    kernels.records.give({.found = found, .decides = otg_uint{0}});
    launch(queue_.get(), kernels.records, tuning_.recordGroup, groups_, 1, profile_.next(Profile::kContacts));
    return;
  }
  kernels.entered.give({.found = found,
                        .decides = otg_uint{0},
                        .tables = reducer_.tables(),
                        .state = reducer_.states(),
                        .chosen = chosen_.words()});
  launch(queue_.get(), kernels.entered, tuning_.recordGroup, groups_, 1, profile_.next(Profile::kContacts));
}

}  // namespace otg::opencl
