// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/batch_lane.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace otg::opencl {

BatchLane::BatchLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      queue_(context.makeQueue(tuning.profile)),
      results_(tuning.recordsExpected),
      chosen_(PinnedPool::make(context)),
      chosenOfMany_(PinnedPool::make(context)),
      contactPlaces_(std::max(1u, tuning.contactPlaces)),
      reducer_(context, tuning, false),
      profile_(tuning.profile),
      solid_(context, tuning) {
  mediumHits_ = std::max(2u, hitsOfGroup(context, tuning.mediumHits));
  smallHits_ = std::min(hitsOfGroup(context, tuning.smallHits), mediumHits_ / 2);
  const std::string walk =
      "-DOTG_GROUP=" + std::to_string(tuning.batchGroup) + " -DOTG_LEAF=" + std::to_string(meshes.leafTriangles()) +
      " -DOTG_SMALL=" + std::to_string(smallHits_) + " -DOTG_MEDIUM=" + std::to_string(mediumHits_);
  const std::string results = "-DOTG_GROUP=" + std::to_string(tuning.recordGroup) + " -DOTG_CONTACTS=";
  prepare_.make(context, "walk/batch_prepare.cl", walk);
  walk_.make(context, "walk/batch_walk.cl", walk);
  pairs_.make(context, "pairwise/batch_results.cl", results + "0 -DOTG_ENTER=0");
  if (reducer_.works()) {
    small_.make(context, "pairwise/batch_reduce.cl", groupReduction(context, tuning.smallGroup, smallHits_));
    medium_.make(context, "pairwise/batch_reduce.cl", groupReduction(context, tuning.mediumGroup, mediumHits_));
    records_.make(context, "pairwise/batch_results.cl", results + "1 -DOTG_ENTER=0");
    entered_.make(context, "pairwise/batch_results.cl", results + "1 -DOTG_ENTER=1");
  }
  counters_.reserve(context, OTG_COUNTERS);
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
  hits_.reserve(context, tuning.hitPlaces);
}

std::span<otg_batch_task> BatchLane::stage(std::size_t count) {
  staged_.reserve(context_, queue_.get(), std::max<std::size_t>(1, count) * sizeof(otg_batch_task));
  count_ = static_cast<std::uint32_t>(count);
  if (!context_.info().doubles) frames_.assign(count, {});
  remembers_ = false;
  return {reinterpret_cast<otg_batch_task*>(staged_.data()), count};
}

std::span<otg_batch_pair> BatchLane::stageFrames() {
  return frames_;
}

std::span<Vec3d> BatchLane::stageDirections() {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  const std::size_t bytes = std::max<std::size_t>(1, count_) * sizeof(Vec3d);
  directionsBefore_.reserve(context_, queue_.get(), bytes);
  directions_.reserve(context_, queue_.get(), bytes);
  remembers_ = true;
  return {reinterpret_cast<Vec3d*>(directionsBefore_.data()), count_};
}

BatchLane::~BatchLane() {
  if (underWay_) clRelease(OTG_CL(clFinish), queue_.get());  // end() was not reached
}

/// What fails leaves nothing behind: kernels may still be reading the meshes and this memory, both of which are gone in
/// a moment.
template <class Run>
void BatchLane::guarded(Run&& run) {
  try {
    run();
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue_.get());
    pinned_ = {};
    underWay_ = false;
    throw;
  }
}

void BatchLane::begin(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions,
                      BatchRequest request, const RunParts* threads) {
  std::vector<const CollisionMesh*> full;
  for (const CollisionMesh* mesh : meshes) {
    if (!mesh->tree().nodes.empty()) full.push_back(mesh);
  }
  pinned_ = meshes_.acquire(full, threads);
  request_ = request;
  contactRecords_ = request == BatchRequest::kContacts;
  hasContacts_ = contactRecords_ || request == BatchRequest::kSolid;
  mostPlaces_ = 1;
  for (const otg_reduction& how : reductions) mostPlaces_ = std::max(mostPlaces_, how.places);
  // Only what is neither a solid nor one with a solid has contacts of the other model in a batch of solids.
  anyPairwise_ =
      request == BatchRequest::kSolid &&
      (std::any_of(full.begin(), full.end(),
                   [](const CollisionMesh* mesh) { return mesh->mesh().meshClass() != MeshClass::kSolid; }) ||
       std::any_of(reductions.begin(), reductions.end(), [](const otg_reduction& how) {
         return how.method != OTG_REDUCE_SOLID && how.method != OTG_REDUCE_BY_HOST;
       }));
  underWay_ = true;
  guarded([&] {
    send(meshes, reductions);
    beginRun();
  });
}

void BatchLane::beginWithFlags(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions,
                               const RunParts* threads) {
  wantsFlags_ = true;
  begin(meshes, reductions, BatchRequest::kSolid, threads);
}

const otg_uint* BatchLane::soonFlags() {
  guarded([&] {
    const cl_event event = flagged_.get();
    clDo(OTG_CL(clWaitForEvents), cl_uint{1}, static_cast<const cl_event*>(&event));
  });
  return reinterpret_cast<const otg_uint*>(flags_.data());
}

BatchFound BatchLane::end() {
  BatchFound found;
  guarded([&] { found = endRun(); });
  underWay_ = false;
  return found;
}

void BatchLane::send(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions) {
  const cl_command_queue queue = queue_.get();
  std::vector<otg_device_mesh> places;
  std::size_t next = 0;
  std::uint32_t depth = 0;
  for (const CollisionMesh* mesh : meshes) {
    places.push_back(mesh->tree().nodes.empty() ? otg_device_mesh{} : pinned_[next++]);
    depth = std::max(depth, places.back().depth);
  }
  stackSize_ = stackSizeFor(tuning_, 2 * depth);
  // Meshes stay where they are from one batch to the next, as a rule.
  if (places.size() != sentPlaces_.size() ||
      std::memcmp(places.data(), sentPlaces_.data(), places.size() * sizeof(otg_device_mesh)) != 0) {
    sentPlaces_.clear();
    places_.reserve(context_, std::bit_ceil(places.size()));
    clDo(OTG_CL(clEnqueueWriteBuffer), queue, places_.get(), cl_bool{CL_TRUE}, std::size_t{0},
         places.size() * sizeof(otg_device_mesh), static_cast<const void*>(places.data()), cl_uint{0},
         static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
    sentPlaces_ = std::move(places);
  }
  reducer_.send(queue, reductions);
  tasks_.reserve(context_, std::bit_ceil(count_));
  writeLater(queue, tasks_.get(), count_ * sizeof(otg_batch_task), staged_.data(), profile_.next(Profile::kWrite));
  pairList_.reserve(context_, std::bit_ceil(count_));
  if (!frames_.empty()) writeLater(queue, pairList_.get(), count_ * sizeof(otg_batch_pair), frames_.data());
  order_.reserve(context_, std::uint64_t{OTG_CLASSES} * std::bit_ceil(count_));
  list_.reserve(context_, std::bit_ceil(count_));
  reducer_.reserveStates(count_);
}

void BatchLane::enqueueWalk(Meshes meshes, bool any) {
  const cl_command_queue queue = queue_.get();
  const otg_uint orderRoom = order_.places() / OTG_CLASSES;
  prepare_.give({.count = count_,
                 .tasks = tasks_.buffer(),
                 .places = places_.buffer(),
                 .reductions = reducer_.reductions(),
                 .pairs = pairList_.buffer(),
                 .states = reducer_.states(),
                 .chosen = chosen_.words(),
                 .counters = counters_.buffer(),
                 .order = order_.buffer(),
                 .orderRoom = orderRoom});
  launch(queue, prepare_, tuning_.batchGroup, (count_ + tuning_.batchGroup - 1) / tuning_.batchGroup, 1,
         profile_.next(Profile::kTop));
  if (tuning_.flushes & 1) clDo(OTG_CL(clFlush), queue);
  walk_.give({.pairs = pairList_.buffer(),
              .places = places_.buffer(),
              // All but delta is the same for all pairs.
              .precision = floatFilterError(0),
              .meshes = meshes,
              .counters = counters_.buffer(),
              .order = order_.buffer(),
              .orderRoom = orderRoom,
              .chosen = chosen_.words(),
              .states = reducer_.states(),
              .listed = list_.buffer(),
              .hits = hits_.buffer(),
              .hitCapacity = hits_.places(),
              .mostHits = tuning_.batchHits,
              .anyHit = otg_uint{any},
              .stackSize = stackSize_,
              .stack = {stackSize_}});
  launch(queue, walk_, tuning_.batchGroup, count_, 1, profile_.next(Profile::kMain));
  if (tuning_.flushes & 2) clDo(OTG_CL(clFlush), queue);
}

void BatchLane::enqueue(Meshes meshes, BatchRequest request) {
  enqueueWalk(meshes, request == BatchRequest::kAny);
  if (request == BatchRequest::kSolid) {
    enqueueSolids(meshes);
    return;
  }
  enqueueRecords(meshes);
  if (contactRecords_) enqueueReduction(meshes, results_.bytes(), 0);
}

void BatchLane::enqueueSolids(Meshes meshes) {
  const cl_command_queue queue = queue_.get();
  if (wantsFlags_) flags_.reserve(context_, queue, count_ * sizeof(otg_uint));
  const SmallStage::Batch batch{count_,
                                meshes.get(),
                                counters_.get(),
                                tasks_.get(),
                                pairList_.get(),
                                places_.get(),
                                hits_.get(),
                                hits_.places(),
                                results_.get(),
                                reducer_.states().get(),
                                reducer_.reductions().get(),
                                groups_,
                                wantsFlags_ ? flags_.data() : nullptr,
                                &flagged_,
                                remembers_ ? directionsBefore_.data() : nullptr,
                                remembers_ ? directions_.data() : nullptr};
  solid_.enqueue(queue, batch, reducer_, chosen_, profile_);
  wantsFlags_ = false;  // not when a list was too short
  if (anyPairwise_) {
    solid_.enqueuePairwise(queue, batch, chosen_, profile_);
    enqueueReduction(meshes, solid_.pairwiseRecords(), OTG_PAIR_PAIRWISE);
  }
  solid_.enqueueWrite(queue, batch, chosen_, profile_);
}

/// The hits that were found, and what is known of their pairs.
given::BatchHits BatchLane::hitsOf(Meshes meshes, const ChosenBuffer& chosen) const {
  return {.pairs = pairList_.buffer(),
          .places = places_.buffer(),
          .tasks = tasks_.buffer(),
          .meshes = meshes,
          .counters = counters_.buffer(),
          .hits = hits_.buffer(),
          .hitCapacity = hits_.places(),
          .results = results_.bytes(),
          .chosen = chosen.words()};
}

template <class Given>
void BatchLane::launchRecords(KernelFor<Given>& kernel, const Given& given) {
  kernel.give(given);
  launch(queue_.get(), kernel, tuning_.recordGroup, groups_, 1, profile_.next(Profile::kContacts));
}

/// Of the kernels that decide what double arithmetic leaves open.
std::string BatchLane::decideOptions(bool enter) const {
  return "-DOTG_SINGLE=0 -DOTG_GROUP=" + std::to_string(tuning_.recordGroup) +
         " -DOTG_CONTACTS=1 -DOTG_ENTER=" + (enter ? "1" : "0");
}

void BatchLane::enqueueRecords(Meshes meshes) {
  const given::BatchHits found = hitsOf(meshes, chosen_);
  if (!contactRecords_) {
    // For yes or no nothing is left open.
    const bool exact = request_ == BatchRequest::kAny && context_.info().doubles;
    if (exact && !decided_) {
      decided_.make(
          context_, "pairwise/batch_results.cl",
          "-DOTG_GROUP=" + std::to_string(tuning_.recordGroup) + " -DOTG_CONTACTS=0 -DOTG_ENTER=0 -DOTG_EXACT=1");
    }
    launchRecords(exact ? decided_ : pairs_, {.found = found, .decides = otg_uint{0}});
    return;
  }
  const bool decides = exact_.isExpected();
  launchRecords(records_, {.found = found, .decides = otg_uint{decides}});
  if (!decides) return;
  if (!decide_) decide_.make(context_, "pairwise/decide_open.cl", decideOptions(false));
  launchRecords(decide_, {.found = found});
}

/// The same, into the reducer's tables, for the pairs with many hits.
void BatchLane::enqueueEntered(Meshes meshes, bool decides) {
  const given::BatchHits found = hitsOf(meshes, chosenOfMany_);
  launchRecords(
      entered_,
      {.found = found, .decides = otg_uint{decides}, .tables = reducer_.tables(), .states = reducer_.states()});
  if (!decides) return;
  if (!decideEntered_) decideEntered_.make(context_, "pairwise/decide_open.cl", decideOptions(true));
  launchRecords(decideEntered_, {.found = found, .tables = reducer_.tables(), .states = reducer_.states()});
}

/// The contacts of all pairs but those with many hits, or of those with the flag `only`.
void BatchLane::enqueueReduction(Meshes meshes, BufferOf<const otg_result_byte> records, otg_uint only) {
  for (const bool medium : {false, true}) {
    KernelFor<given::BatchReduce>& kernel = medium ? medium_ : small_;
    kernel.give({.meshes = meshes,
                 .counters = counters_.buffer(),
                 .hitCapacity = hits_.places(),
                 .results = records,
                 .states = reducer_.states(),
                 .reductions = reducer_.reductions(),
                 .list = list_.buffer(),
                 .listed = otg_uint{medium},
                 .least = medium ? smallHits_ + 1 : 0,
                 .chosen = chosen_.words(),
                 .pairCount = count_,
                 .contactRoom = chosen_.contactPlaces(),
                 .only = only,
                 .last = otg_uint{medium && only == 0}});
    launch(queue_.get(), kernel, medium ? tuning_.mediumGroup : tuning_.smallGroup, count_, 1,
           profile_.next(medium ? Profile::kChoose : Profile::kRegions));
  }
}

/// The contacts of pairs with more hits than one work-group keeps, in a second submission.
void BatchLane::runMany(Meshes meshes, BatchFound& found) {
  const cl_command_queue queue = queue_.get();
  flagsOfMany_.resize(count_);
  for (std::uint32_t i = 0; i < count_; ++i) {
    const otg_uint flags = found.flags[i];
    flagsOfMany_[i] = flags & OTG_PAIR_MANY ? flags & OTG_PAIR_TO_HOST : otg_uint{OTG_PAIR_SKIPPED};
  }
  std::fill(std::begin(countersOfMany_), std::end(countersOfMany_), 0);
  countersOfMany_[OTG_COUNT_HITS] = found.counters[OTG_COUNT_HITS];
  reducer_.reserve(queue, count_, hits_.places(), mostPlaces_);
  chosenOfMany_.reserve(context_, std::bit_ceil(count_), found.counters[OTG_COUNT_MANY] * reducer_.contactsOfPair());
  writeLater(queue, counters_.get(), sizeof countersOfMany_, countersOfMany_);
  writeLater(queue, chosenOfMany_.get(), count_ * sizeof(otg_uint), flagsOfMany_.data(), nullptr, OTG_RESULT_HEAD);
  enqueueEntered(meshes, found.counters[OTG_COUNT_OPEN_OF_BATCH] > 0);
  const Reducer::Hits hits{meshes, counters_.buffer(), results_.bytes(), hits_.places(), count_};
  reducer_.enqueue(queue, hits, chosenOfMany_, chosenOfMany_.words(), groups_, profile_);
  const otg_uint made = chosenOfMany_.readHead(context_, queue, count_, true, &profile_)[OTG_COUNT_REDUCED];
  BatchFound::Contacts more;
  more.contacts = chosenOfMany_.readRest(context_, queue, made, &profile_).data();
  more.places = chosenOfMany_.places();
  more.memory = chosenOfMany_.memory();
  found.contacts.push_back(std::move(more));
  // What both submissions say together.
  std::copy_n(found.counters, OTG_COUNTERS_READ, countersOfMany_);
  for (const int counter : {OTG_COUNT_INTERSECTING, OTG_COUNT_CONTACTS, OTG_COUNT_REDUCED, OTG_COUNT_FLAGGED}) {
    countersOfMany_[counter] += chosenOfMany_.counters()[counter];
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    flagsOfMany_[i] = found.flags[i] & OTG_PAIR_MANY ? chosenOfMany_.flags()[i] : found.flags[i];
  }
  found.counters = countersOfMany_;
  found.flags = flagsOfMany_.data();
}

void BatchLane::beginRun() {
  results_.reserve(context_, hits_.places());
  if (request_ == BatchRequest::kSolid) solid_.reserve(count_, hits_.places(), mostPlaces_, anyPairwise_);
  chosen_.reserve(context_, std::bit_ceil(count_), hasContacts_ ? contactPlaces_ : 0);
  enqueue(pinned_.units(), request_);
  chosen_.beginHead(context_, queue_.get(), count_, hasContacts_, &profile_);
}

BatchFound BatchLane::endRun() {
  const cl_command_queue queue = queue_.get();
  const otg_uint* counters = nullptr;
  for (;;) {
    counters = chosen_.endHead(queue);
    const otg_uint hits = counters[OTG_COUNT_HITS], contacts = hasContacts_ ? counters[OTG_COUNT_REDUCED] : 0;
    const bool solidFits = request_ != BatchRequest::kSolid || solid_.fits(counters);
    const bool fits = hits <= hits_.places() && contacts <= contactPlaces_ && solidFits;
    const bool open = contactRecords_ && counters[OTG_COUNT_OPEN_OF_BATCH] > 0, again = open && !exact_.isExpected();
    if (contactRecords_ && (fits || open)) exact_.take(open);
    if (fits && !again) break;
    if (hits > hits_.places()) hits_.reserve(context_, std::bit_ceil(std::uint64_t{hits}));
    if (contacts > contactPlaces_) contactPlaces_ = std::bit_ceil(contacts);
    if (!fits) ++repeats_;
    beginRun();
  }
  BatchFound found;
  if (hasContacts_) {
    BatchFound::Contacts most;
    most.contacts = chosen_.readRest(context_, queue, counters[OTG_COUNT_REDUCED], &profile_).data();
    most.places = chosen_.places();
    most.memory = chosen_.memory();
    found.contacts.push_back(std::move(most));
  }
  found.counters = chosen_.counters();  // only now: reading the rest may have moved the memory
  if (contactRecords_) found.decidedExactly = found.counters[OTG_COUNT_OPEN_OF_BATCH];
  found.flags = chosen_.flags();
  if (remembers_) found.directions = reinterpret_cast<const Vec3d*>(directions_.data());
  if (contactRecords_ && found.counters[OTG_COUNT_MANY] > 0) runMany(pinned_.units(), found);
  if (profile_.on()) profile_.collect();
  return found;
}

Answer BatchLane::records() {
  const otg_uint* counters = chosen_.counters();
  Answer answer;
  guarded([&] { answer = results_.readAll(context_, queue_.get(), contactRecords_, counters); });
  return answer;
}

LargeStage::Batch BatchLane::solids() const {
  return {pinned_.buffer(),
          tasks_.get(),
          places_.get(),
          reducer_.states().get(),
          solid_.hits().get(),
          solid_.hits().places(),
          {},
          {}};
}

Answer BatchLane::recordsLeft() {
  Answer answer;
  bool isThere = false;
  if (request_ == BatchRequest::kSolid) {
    guarded([&] { isThere = solid_.readLeft(queue_.get(), chosen_.counters(), answer); });
  }
  return isThere ? answer : records();
}

}  // namespace otg::opencl
