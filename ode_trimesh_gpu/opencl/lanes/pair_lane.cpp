// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/pair_lane.h"

#include <algorithm>
#include <bit>
#include <string>

namespace otg::opencl {
namespace {

constexpr std::uint32_t kCutTile = 4;  // OTG_CUT_TILE of pair_query.cl
}  // namespace

PairLane::PairLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      queue_(context.makeQueue(tuning.profile)),
      results_(tuning.recordsExpected),
      chosen_(PinnedPool::make(context)),
      reducer_(context, tuning, true),
      overlap_(context, tuning),
      overlapContacts_(context, tuning, false),
      profile_(tuning.profile) {
  const std::string walk =
      "-DOTG_GROUP=" + std::to_string(tuning.group) + " -DOTG_LEAF=" + std::to_string(meshes.leafTriangles());
  const auto results = [&](int makes, int reduces) {
    return "-DOTG_GROUP=" + std::to_string(tuning.recordGroup) + " -DOTG_CONTACTS=" + std::to_string(makes) +
           " -DOTG_ENTER=" + std::to_string(reduces);
  };
  cut_.make(context, "walk/pair_query.cl", walk);
  level_.make(context, "walk/pair_query.cl", walk);
  tail_.make(context, "walk/pair_query.cl", walk);
  pairs_.make(context, "pairwise/pair_results.cl", results(0, 0));
  if (context.info().doubles) {
    contacts_.make(context, "pairwise/pair_results.cl", results(1, 0));
    if (reducer_.works()) {
      entered_.make(context, "pairwise/pair_results.cl", results(1, 1));
      fewHits_ = hitsOfGroup(context, tuning.fewHits);
      few_.make(context, "pairwise/pair_reduce.cl",
                groupReduction(context, tuning.fewGroup, fewHits_) + " -DOTG_EXACT=0");
    }
  }
  counters_.reserve(context, OTG_COUNTERS);
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
  for (ListOf<otg_node_pair>* list : {&level0_, &level1_, &level2_}) list->reserve(context, tuning.pairPlaces);
  leaves_.reserve(context, tuning.leafPlaces);
  hits_.reserve(context, tuning.hitPlaces);
  reducer_.reserveStates(1);
}

PairAnswer PairLane::run(const Query& query, const PairFrame& frame, PairRequest request) {
  const CollisionMesh* const both[] = {query.a, query.b};
  const MeshStore::Pinned pinned = meshes_.acquire(both);
  const otg_device_pair pair{deviceBoxes(frame), frame.floatError, pinned[0], pinned[1]};
  try {
    if (request == PairRequest::kOverlap && describes(pair)) return describe(pair, query, pinned.units());
    return runOn(pair, query, pinned.units(), request == PairRequest::kContacts && contacts_);
  } catch (...) {
    // Kernels may still be reading the meshes, which are not pinned any longer in a moment.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

/// Whether the device is to describe the overlap: as many hits are expected as last time.
bool PairLane::describes(const otg_device_pair& pair) const {
  // Two solids, or a solid and a sheet.
  if (!(pair.a.flags & pair.b.flags & OTG_MESH_LISTED) || !((pair.a.flags | pair.b.flags) & OTG_MESH_CLOSED)) {
    return false;
  }
  return isFresh_ ? overlap_.paysForTriangles(std::uint64_t{pair.a.triangles} + pair.b.triangles)
                  : overlap_.pays(lastHits_);
}

PairAnswer PairLane::describe(const otg_device_pair& pair, const Query& query, Meshes meshes) {
  const cl_command_queue queue = queue_.get();
  const otg_reduction how = deviceReduction(query.options, true);
  PairAnswer answer;
  answer.asked = true;
  const otg_overlap_state* head = nullptr;
  for (;; ++repeats_) {
    results_.reserve(context_, hits_.places());
    chosen_.reserve(context_, 1, 0);
    const LargeStage::Pair task{pair,        query.bInA,     *query.a,       *query.b, meshes.get(), counters_.get(),
                                hits_.get(), hits_.places(), results_.get(), lastHits_};
    overlap_.reserve(queue, task);
    enqueueWalk(pair, meshes, how);
    overlap_.enqueue(queue, task, profile_);
    const bool makes = LargeContacts::works(query, tuning_);
    const otg_overlap_task asked = makes ? overlapTask(query) : otg_overlap_task{};
    const LargeContacts::Pairs described{{&asked, 1},        meshes.get(),        overlap_.pairs(),
                                         overlap_.results(), overlap_.unitRoom(), overlap_.tableRoom()};
    const auto make = [&] {
      overlapContacts_.enqueue(queue, described, profile_);
      overlapContacts_.beginHead(queue, profile_);
      overlapContacts_.endHead(queue);
      head = &overlapContacts_.head().state;
    };
    bool fits = true;
    if (makes) {
      make();
      fits = overlap_.fits(overlapContacts_.totals());
    } else {
      overlap_.beginHead(queue, profile_);
      fits = overlap_.endHead(queue);
      head = &overlap_.head();
    }
    lastHits_ = head->counters[OTG_COUNT_HITS];
    isFresh_ = false;
    answer.tooMany = hasTooMany();
    if (answer.tooMany) return answer;
    if (makeRoom(head->counters) || !fits) continue;
    const otg_uint why = head->counts[OTG_OVERLAP_WHY];
    answer.described = why == 0 && head->counts[OTG_OVERLAP_CHORDS] > 0;
    answer.made = makes && answer.described;
    for (; answer.made && overlapContacts_.isIncomplete(); ++repeats_) make();
    if (answer.made) {
      overlapContacts_.readRest(queue, profile_);
      answer.contactsOfRegions = overlapContacts_.found();
    }
    if (!makes) {
      overlap_.readRest(queue, profile_);
      answer.overlap = overlap_.found();
      head = answer.overlap.head;
    }
    break;
  }
  answer.found.counters = head->counters;
  if (!answer.described) answer.found = results_.readAll(context_, queue, false, head->counters, &profile_);
  if (profile_.on()) profile_.collect();
  return answer;
}

FoundOverlap PairLane::description() {
  try {
    overlap_.beginHead(queue_.get(), profile_);
    overlap_.endHead(queue_.get());
    overlap_.readRest(queue_.get(), profile_);
    if (profile_.on()) profile_.collect();
    return overlap_.found();
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

Answer PairLane::records(const otg_uint* counters) {
  try {
    return results_.readAll(context_, queue_.get(), false, counters, nullptr);
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

PairAnswer PairLane::runOn(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts) {
  const cl_command_queue queue = queue_.get();
  const otg_reduction how = deviceReduction(query.options, !contacts || !reducer_.works());
  const bool reduce = how.method != OTG_REDUCE_BY_HOST && !((pair.a.flags | pair.b.flags) & OTG_MESH_TANGLED);
  PairAnswer answer;
  if (reduce) reducer_.send(queue, {&how, 1});
  for (;;) {
    // As last time, as a rule.
    const bool decides = exact_.isExpected();
    const bool few = reduce && lastHits_ <= fewHits_;
    results_.reserve(context_, hits_.places());
    if (reduce) reducer_.reserve(queue, 1, hits_.places(), how.places);
    chosen_.reserve(context_, 1, reduce ? std::max(reducer_.contactsOfPair(), fewHits_) : 0);
    enqueueWalk(pair, meshes, how);
    const given::PairHits found = hitsOf(pair, query.bInA, meshes);
    if (few) {
      enqueueFew(found);
    } else {
      enqueueRecords(found, contacts, reduce);
    }
    const otg_uint* counters = reduce ? chosen_.readHead(context_, queue, 1, true, &profile_)
                                      : results_.readHead(context_, queue, contacts, &profile_);
    lastHits_ = counters[OTG_COUNT_HITS];
    isFresh_ = false;
    const bool many = few && (chosen_.flags()[0] & OTG_PAIR_MANY);
    answer.tooMany = hasTooMany();
    if (answer.tooMany || makeRoom(counters)) {
      if (many) fillZero(queue, counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
      if (answer.tooMany) return answer;
      ++repeats_;
      continue;
    }
    if (many) {
      enqueueRecords(found, contacts, reduce);
      counters = chosen_.readHead(context_, queue, 1, true, &profile_);
    }
    const bool open = counters[OTG_COUNT_OPEN] > 0;
    exact_.take(open);
    // Where the CPU has the records in any case it decides what was not expected to be open.
    if (open && reduce && !decides) continue;
    if (!reduce) {
      answer.found = results_.readRest(context_, queue, contacts, &profile_);
    } else if (chosen_.flags()[0] & OTG_PAIR_TO_HOST) {
      answer.found = results_.readAll(context_, queue, contacts, counters, &profile_);
      answer.left = true;
    } else {
      answer.contacts = chosen_.readRest(context_, queue, chosen_.places()[1], &profile_);
      answer.found.counters = chosen_.counters();
      answer.reduced = true;
    }
    break;
  }
  if (profile_.on()) profile_.collect();
  return answer;
}

/// From the cuts to the list of hits.
void PairLane::enqueueWalk(const otg_device_pair& pair, Meshes meshes, const otg_reduction& how) {
  const BufferOf<otg_counter> counters = counters_.buffer();
  const BufferOf<otg_leaf_pair> leaves = leaves_.buffer();
  const ListOf<otg_node_pair>* const lists[] = {&level0_, &level1_, &level2_};
  const otg_uint levels =
      std::uint64_t{pair.a.triangles} + pair.b.triangles < tuning_.levelTriangles ? 0 : std::min(tuning_.levels, 2u);
  const otg_uint opened = std::min(levels, 1u);  // by the first kernel
  const ListOf<otg_node_pair>& first = *lists[opened];
  cut_.give({.pair = pair,
             .meshes = meshes,
             .counters = counters,
             .opens = opened,
             .out = first.buffer(),
             .outCapacity = first.places(),
             .leaves = leaves,
             .leafCapacity = leaves_.places(),
             .state = reducer_.states(),
             .chosen = chosen_.words(),
             .method = how.method});
  launch(queue_.get(), cut_, tuning_.group, (pair.a.cutCount + tuning_.group - 1) / tuning_.group,
         (pair.b.cutCount + kCutTile - 1) / kCutTile, profile_.next(Profile::kTop));
  if (tuning_.flushes & 1) clDo(OTG_CL(clFlush), queue_.get());
  for (otg_uint level = opened; level < levels; ++level) {
    const ListOf<otg_node_pair>&in = *lists[level], &out = *lists[level + 1];
    level_.give({.pair = pair,
                 .meshes = meshes,
                 .counters = counters,
                 .level = level,
                 .in = in.buffer(),
                 .inCapacity = in.places(),
                 .out = out.buffer(),
                 .outCapacity = out.places(),
                 .leaves = leaves,
                 .leafCapacity = leaves_.places()});
    launch(queue_.get(), level_, tuning_.group, groups_, 1, profile_.next(Profile::kLevels));
  }
  const otg_uint stackSize = stackSizeFor(tuning_, pair.a.depth + pair.b.depth);
  tail_.give({.pair = pair,
              .meshes = meshes,
              .counters = counters,
              .level = levels,
              .seeds = lists[levels]->buffer(),
              .seedCapacity = lists[levels]->places(),
              .leaves = leaves,
              .leafCapacity = leaves_.places(),
              .hits = hits_.buffer(),
              .hitCapacity = hits_.places(),
              .mostHits = tuning_.mostHits,
              .stackSize = stackSize,
              .stack = {stackSize}});
  launch(queue_.get(), tail_, tuning_.group, groups_, 1, profile_.next(Profile::kMain));
  if (tuning_.flushes & 2) clDo(OTG_CL(clFlush), queue_.get());
}

given::PairHits PairLane::hitsOf(const otg_device_pair& pair, const Transformd& bInA, Meshes meshes) const {
  return {.pair = pair,
          .bInA = bInA,
          .meshes = meshes,
          .counters = counters_.buffer(),
          .hits = hits_.buffer(),
          .hitCapacity = hits_.places(),
          .results = results_.bytes()};
}

/// Everything else, where there are few hits.
void PairLane::enqueueFew(const given::PairHits& found) {
  const BufferOf<otg_chosen_word> answer = chosen_.beginAnswer(context_, queue_.get(), tuning_.hostAnswers);
  if (exact_.isExpected() && !fewDecided_) {
    fewDecided_.make(context_, "pairwise/pair_reduce.cl",
                     groupReduction(context_, tuning_.fewGroup, fewHits_) + " -DOTG_EXACT=1");
  }
  KernelFor<given::PairReduce>& kernel = exact_.isExpected() ? fewDecided_ : few_;
  kernel.give({.found = found, .reductions = reducer_.reductions(), .chosen = chosen_.words(), .answer = answer});
  launch(queue_.get(), kernel, tuning_.fewGroup, 1, 1, profile_.next(Profile::kChoose));
}

/// Records of all hits, and with `reduce` the contacts.
void PairLane::enqueueRecords(const given::PairHits& found, bool contacts, bool reduce) {
  if (reduce) {
    enqueueContacts(found);
    return;
  }
  const bool decides = exact_.isExpected();
  launchRecords(contacts ? contacts_ : pairs_, {.found = found, .decides = otg_uint{decides}});
  if (!decides) return;
  KernelFor<given::PairDecide>& decide = contacts ? decideContacts_ : decidePairs_;
  if (!decide) decide.make(context_, "pairwise/decide_open.cl", decideOptions(contacts, false));
  launchRecords(decide, {.found = found});
}

void PairLane::enqueueContacts(const given::PairHits& found) {
  const bool decides = exact_.isExpected();
  launchRecords(entered_, {.found = found,
                           .decides = otg_uint{decides},
                           .tables = reducer_.tables(),
                           .state = reducer_.states(),
                           .chosen = chosen_.words()});
  if (decides) {
    if (!decideEntered_) decideEntered_.make(context_, "pairwise/decide_open.cl", decideOptions(true, true));
    launchRecords(decideEntered_,
                  {.found = found, .tables = reducer_.tables(), .state = reducer_.states(), .chosen = chosen_.words()});
  }
  const Reducer::Hits hits{found.meshes, found.counters, found.results, hits_.places(), 1};
  reducer_.enqueue(queue_.get(), hits, chosen_, chosen_.beginAnswer(context_, queue_.get(), tuning_.hostAnswers),
                   groups_, profile_);
}

/// Of the kernels that decide what double arithmetic leaves open.
std::string PairLane::decideOptions(bool contacts, bool reduce) const {
  return "-DOTG_SINGLE=1 -DOTG_GROUP=" + std::to_string(tuning_.recordGroup) +
         " -DOTG_CONTACTS=" + (contacts ? "1" : "0") + " -DOTG_ENTER=" + (reduce ? "1" : "0");
}

template <class Given>
void PairLane::launchRecords(KernelFor<Given>& kernel, const Given& given) {
  kernel.give(given);
  // No more work-groups than the device holds at once: these kernels take many registers.
  const std::size_t groups = std::max<std::size_t>(1, std::size_t{2} * context_.info().computeUnits);
  launch(queue_.get(), kernel, tuning_.recordGroup, groups, 1, profile_.next(Profile::kContacts));
}

/// Whether the CPU is to do the pair, which then shows nothing of the next one.
bool PairLane::hasTooMany() {
  if (lastHits_ <= tuning_.mostHits) return false;
  lastHits_ = 0;
  isFresh_ = true;
  return true;
}

/// After a run: false if every list was long enough, else they have grown.
bool PairLane::makeRoom(const otg_uint* counters) {
  bool grown = false;
  const auto check = [&](DeviceList& list, int counter) {
    if (counters[counter] <= list.places()) return;
    list.reserve(context_, std::bit_ceil(std::uint64_t{counters[counter]}));
    grown = true;
  };
  check(level0_, OTG_COUNT_LEVEL0);
  check(level1_, OTG_COUNT_LEVEL1);
  check(level2_, OTG_COUNT_LEVEL2);
  check(leaves_, OTG_COUNT_LEAVES);
  check(hits_, OTG_COUNT_HITS);
  return grown;
}

}  // namespace otg::opencl
