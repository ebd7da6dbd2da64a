// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/levels_lane.h"

#include <algorithm>
#include <bit>
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

/// Of levels_near.cl.
std::string nearOptions(std::size_t group, bool fused, bool contacts, bool reduce) {
  return "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_LEAF=1 -DOTG_FUSED=" + (fused ? "1" : "0") +
         contactOptions(contacts, reduce);
}

}  // namespace

LevelsLane::NearKernels& LevelsLane::nearKernels(bool fused, bool contacts, bool reduce) {
  NearKernels& kernels = near_[fused][reduce ? 2 : contacts ? 1 : 0];
  if (kernels.rest) return kernels;
  kernels.near = context_.makeKernel("published/levels_near.cl",
                                     nearOptions(group_, fused, fused && contacts, fused && reduce), "levelsNear");
  kernels.rest =
      fused
          ? context_.makeKernel("published/levels_near.cl", nearOptions(group_, fused, contacts, reduce), "levelsEnter")
          : context_.makeKernel("pairwise/pair_results.cl",
                                "-DOTG_GROUP=" + std::to_string(tuning_.recordGroup) + contactOptions(contacts, reduce),
                                "pairResults");
  return kernels;
}

LevelsLane::LevelsLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      group_(groupFor(context, tuning)),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      queue_(context.makeQueue(tuning.profile)),
      sumOfOne_(context, groupFor(context, tuning), PrefixSum::Of::kUint),
      sumOfTwo_(context, groupFor(context, tuning), PrefixSum::Of::kUint2),
      results_(tuning.recordsExpected),
      chosen_(PinnedPool::make(context)),
      reducer_(context, tuning, true),
      profile_(tuning.profile) {
  const std::string walk = "-DOTG_GROUP=" + std::to_string(group_) + " -DOTG_LEAF=1";
  begin_ = context.makeKernel("published/levels_walk.cl", walk, "levelsBegin");
  test_ = context.makeKernel("published/levels_walk.cl", walk, "levelsTest");
  compact_ = context.makeKernel("published/levels_walk.cl", walk, "levelsCompact");
  split_ = context.makeKernel("published/levels_walk.cl", walk, "levelsSplit");
  spawn_ = context.makeKernel("published/levels_walk.cl", walk, "levelsSpawn");
  reset_ = context.makeKernel("published/levels_near.cl", nearOptions(group_, false, false, false), "levelsReset");
  counters_ = context.makeBuffer(CL_MEM_READ_WRITE, OTG_COUNTERS * sizeof(otg_uint));
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
  totals_ = context.makeBuffer(CL_MEM_READ_WRITE, 4 * sizeof(cl_uint));
  next_.reserve(context, tuning.pairPlaces);
  leaves_.reserve(context, tuning.leafPlaces);
  hits_.reserve(context, tuning.hitPlaces);
  reducer_.reserveStates(1);
}

PairAnswer LevelsLane::run(const Query& query, const PairFrame& frame, bool contacts, const LevelsOptions& how) {
  const CollisionMesh* const both[] = {query.a, query.b};
  bytesSent_ = 0;
  MeshStore::Pinned pinned;
  if (!how.sendTrees) pinned = meshes_.acquire(both);
  otg_device_pair pair{deviceBoxes(frame), frame.floatError, {}, {}};
  try {
    cl_mem meshes = nullptr;
    if (how.sendTrees) {
      // A mesh that meets itself is sent once.
      const PackedMesh& a = packed(*query.a, 0);
      const PackedMesh& b = query.a == query.b ? a : packed(*query.b, 1);
      const std::size_t unitsB = query.a == query.b ? 0 : b.units.size();
      sentUnits_.reserve(context_, a.units.size() + unitsB);
      meshes = sentUnits_.get();
      write(meshes, 0, a.units.size() * sizeof(MeshUnit), a.units.data());
      if (unitsB > 0) write(meshes, a.units.size() * sizeof(MeshUnit), unitsB * sizeof(MeshUnit), b.units.data());
      pair.a = a.placeAt(0);
      pair.b = unitsB > 0 ? b.placeAt(static_cast<std::uint32_t>(a.units.size())) : pair.a;
    } else {
      meshes = pinned.buffer();
      pair.a = pinned[0];
      pair.b = pinned[1];
    }
    const PairAnswer answer = runOn(pair, query, meshes, contacts && context_.info().doubles, how);
    if (profile_.on()) profile_.collect();
    return answer;
  } catch (...) {
    // Meshes, which are not pinned any longer in a moment, may still be read, and what is sent too.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

const PackedMesh& LevelsLane::packed(const CollisionMesh& mesh, int side) {
  const std::weak_ptr<const void> alive = mesh.lifetime();
  const auto isIt = [&](const std::unique_ptr<SentMesh>& sent) {
    return sent && !sent->of.owner_before(alive) && !alive.owner_before(sent->of);
  };
  if (!isIt(sent_[side])) {
    sent_[side] = std::make_unique<SentMesh>(SentMesh{alive, packMesh(mesh, MeshLayout::kBinary, 1)});
  }
  return sent_[side]->mesh;
}

/// Does not wait: `from` has to stay as it is until the queue was waited for.
void LevelsLane::write(cl_mem to, std::size_t offset, std::size_t bytes, const void* from) {
  clDo(OTG_CL(clEnqueueWriteBuffer), queue_.get(), to, cl_bool{CL_FALSE}, offset, bytes, from, cl_uint{0},
       static_cast<const cl_event*>(nullptr), profile_.next(Profile::kWrite));
  bytesSent_ += bytes;
}

PairAnswer LevelsLane::runOn(const otg_device_pair& pair, const Query& query, cl_mem meshes, bool contacts,
                             const LevelsOptions& how) {
  walk(pair, query, meshes, std::min(how.startDepth, kMostStartDepth));
  if (leafCount_ > 0) return decide(pair, query, meshes, contacts, how.fusedNear);
  static constexpr otg_uint kNothing[OTG_COUNTERS] = {};
  PairAnswer answer;
  answer.found.counters = kNothing;
  answer.reduced = contacts;
  return answer;
}

void LevelsLane::walk(const otg_device_pair& pair, const Query& query, cl_mem meshes, std::uint32_t startDepth) {
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
  Arguments(begin_) << starts_.get() << countA << countB << now_.get();
  launch(queue_.get(), begin_, group_, (count + group_ - 1) / group_, 1, profile_.next(Profile::kTop));
  return count;
}

/// Up to the prefix sums by which pairs of leaves and of children are placed.
void LevelsLane::step(const otg_device_pair& pair, cl_mem meshes, std::uint32_t count) {
  const cl_command_queue queue = queue_.get();
  const std::size_t groups = (count + group_ - 1) / group_;
  // Four children each have to be counted in 32 bits.
  if (count >= 1u << 30)
    throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "a list outgrows the device");
  for (DeviceList* list : {&overlaps_, &places_, &kept_, &weights_, &placesOfTwo_}) {
    list->reserve(context_, std::bit_ceil(count));
  }
  Arguments(test_) << pair << meshes << now_.get() << count << overlaps_.get();
  launch(queue, test_, group_, groups, 1, profile_.next(Profile::kTest));
  sumOfOne_.enqueue(queue, overlaps_.get(), places_.get(), count, totals_.get(), 0, profile_);
  Arguments(compact_) << meshes << pair.a.nodes << pair.b.nodes << now_.get() << count << overlaps_.get()
                      << places_.get() << totals_.get() << kept_.get() << weights_.get();
  launch(queue, compact_, group_, groups, 1, profile_.next(Profile::kCompact));
  // Words 2 and 3 of the totals.
  sumOfTwo_.enqueue(queue, weights_.get(), placesOfTwo_.get(), count, totals_.get(), 1, profile_);
}

/// Pairs of leaves to their list, pairs of children to `next_`; again where a list was too short.
void LevelsLane::distribute(const otg_device_pair& pair, cl_mem meshes, std::uint32_t count, LevelsStep& counts) {
  const cl_command_queue queue = queue_.get();
  const std::size_t groups = (count + group_ - 1) / group_;
  for (;; ++repeats_) {
    cl_uint totals[4] = {};
    Arguments(split_) << meshes << pair.a.nodes << pair.b.nodes << kept_.get() << weights_.get() << placesOfTwo_.get()
                      << count << leafCount_ << leaves_.get() << leaves_.places();
    launch(queue, split_, group_, groups, 1, profile_.next(Profile::kSplit));
    Arguments(spawn_) << meshes << pair.a.nodes << pair.b.nodes << kept_.get() << weights_.get() << placesOfTwo_.get()
                      << count << next_.get() << next_.places();
    launch(queue, spawn_, group_, groups, 1, profile_.next(Profile::kSpawn));
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
  DeviceList larger(sizeof(cl_uint2));
  larger.reserve(context_, std::bit_ceil(places));
  if (leafCount_ > 0) {
    clDo(OTG_CL(clEnqueueCopyBuffer), queue_.get(), leaves_.get(), larger.get(), std::size_t{0}, std::size_t{0},
         std::size_t{leafCount_ * sizeof(cl_uint2)}, cl_uint{0}, static_cast<const cl_event*>(nullptr),
         static_cast<cl_event*>(nullptr));
  }
  std::swap(leaves_, larger);
}

PairAnswer LevelsLane::decide(const otg_device_pair& pair, const Query& query, cl_mem meshes, bool contacts,
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
    enqueueNear(pair, query, meshes, how, contacts, reduce, fused);
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

void LevelsLane::enqueueNear(const otg_device_pair& pair, const Query& query, cl_mem meshes, const otg_reduction& how,
                             bool contacts, bool reduce, bool fused) {
  const cl_command_queue queue = queue_.get();
  const cl_mem counters = counters_.get(), hits = hits_.get(), state = reducer_.states();
  const std::size_t groups = (leafCount_ + group_ - 1) / group_;
  const auto addPose = [&](Arguments& arguments) {
    arguments << pair;
    if (context_.info().doubles) {
      arguments << query.bInA;
    } else {
      arguments << cl_int{0};
    }
  };
  const auto addTables = [&](Arguments& arguments) {
    if (reduce) arguments << reducer_.links() << reducer_.tables() << reducer_.tableSize() << state << chosen_.get();
  };
  Arguments(reset_) << pair << state << chosen_.get() << how.method;
  launch(queue, reset_, group_, 1, 1, profile_.next(Profile::kNear));
  NearKernels& kernels = nearKernels(fused, contacts, reduce);
  Arguments near(kernels.near), rest(kernels.rest);
  if (fused) {
    addPose(near);
    near << meshes << counters << leaves_.get() << leafCount_ << hits_.places() << results_.get();
    rest << counters << results_.get() << hits_.places();
  } else {
    near << pair << meshes << counters << leaves_.get() << leafCount_ << hits << hits_.places();
    addPose(rest);
    rest << meshes << counters << hits << hits_.places() << results_.get() << otg_uint{0};
  }
  addTables(rest);
  launch(queue, kernels.near, group_, groups, 1, profile_.next(Profile::kNear));
  launch(queue, kernels.rest, fused ? group_ : tuning_.recordGroup, groups_, 1,
         profile_.next(fused ? Profile::kRegions : Profile::kContacts));
  if (!reduce) return;
  reducer_.enqueue(queue, meshes, counters, results_.get(), hits_.places(), 1, chosen_,
                   chosen_.beginAnswer(context_, queue, tuning_.hostAnswers), groups_, profile_);
}

}  // namespace otg::opencl
