// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/solid/small_stage.h"

#include <algorithm>
#include <bit>
#include <string>

#include "shared/contacts/solid_model.h"
#include "shared/layout/solid_layout.h"

namespace otg::opencl {

namespace {

/// As many hits as there is local memory for: otg_solid_scratch with some to spare.
std::uint32_t hitsFor(const Context& context, std::uint32_t group, std::uint32_t wanted) {
  std::uint32_t hits = std::bit_floor(std::clamp(wanted, 32u, 1024u));
  while (hits > 32 && 168 * std::uint64_t{hits} + 56 * std::uint64_t{group} + 1024 > context.info().localMemory) {
    hits /= 2;
  }
  return hits;
}

/// Numbers that otg_solid_choice takes for what it is.
constexpr std::uint32_t kMostPieces = 512, kMostCandidates = 512;

}  // namespace

SmallStage::SmallStage(Context& context, const Tuning& tuning)
    : context_(context),
      recordGroup_(tuning.recordGroup),
      registerLimit_(context.info().registerLimit && tuning.solidRegisters != 0
                         ? " -cl-nv-maxrregcount=" + std::to_string(tuning.solidRegisters)
                         : ""),
      arenaWanted_(tuning.arenaUnits),
      chunksWanted_(std::max(1u, tuning.arenaUnits / 64)),
      arena_(OTG_ARENA_UNIT) {
  // On CPUs a work-group is one work-item, and memory is memory: one size does for all. PoCL does not cope with
  // barriers in kernels of this size.
  const bool isCpu = context.info().kind == DeviceKind::kCpu;
  const std::uint32_t sizes = tuning.solidSizes != 0 ? tuning.solidSizes : isCpu ? 1 : 2;
  const std::uint32_t large = tuning.solidLargeGroup != 0 ? tuning.solidLargeGroup : isCpu ? 1 : 64;
  const std::uint32_t small = tuning.solidGroup != 0 ? tuning.solidGroup : isCpu ? 1 : 32;
  sizes_.push_back({large,
                    hitsFor(context, large, tuning.solidLargeHits),
                    kMostCandidates,
                    kMostPieces,
                    0,
                    sizes == 1 ? std::uint32_t{OTG_SOLID_BINS} : std::uint32_t{OTG_SOLID_LARGE_BINS},
                    std::size_t{context.info().computeUnits} * tuning.groupsPerUnit,
                    {},
                    {},
                    {}});
  if (sizes > 1) {
    sizes_.push_back({small,
                      hitsFor(context, small, tuning.solidHits),
                      // Only the large ones gather points and planes, as the CPU does from these numbers on.
                      std::clamp<std::uint32_t>(tuning.solidPoints, 96, OTG_SOLID_MOST_POINTS),
                      std::clamp<std::uint32_t>(tuning.solidFaces, 16, OTG_SOLID_MOST_PLANES),
                      OTG_SOLID_LARGE_BINS,
                      OTG_SOLID_BINS,
                      0,
                      {},
                      {},
                      {}});
  }
  estimateGroup_ = isCpu ? 1 : OTG_SOLID_CHUNK;
  unevenGroup_ = tuning.unevenGroup != 0 ? tuning.unevenGroup : isCpu ? 1 : 128;
  unevenFaces_ = tuning.unevenFaces;
  estimateGroups_ = std::size_t{context.info().computeUnits} * (isCpu ? 4 : 32);
}

/// Not before they are needed: they are large, and many have contacts of the other model only.
void SmallStage::build() {
  if (write_) return;
  const std::string flat = "-DOTG_GROUP=" + std::to_string(recordGroup_) + " -DOTG_CONTACTS=0";
  records_ = context_.makeKernel("solid/small/gather.cl", flat, "solidRecords");
  stretches_ = context_.makeKernel("solid/small/gather.cl", flat, "solidPlaces");
  scatter_ = context_.makeKernel("solid/small/gather.cl", flat, "solidScatter");
  Kernel write;
  for (Size& size : sizes_) {
    const auto number = [](const char* name, std::uint32_t value) { return name + std::to_string(value); };
    const std::string options = number("-DOTG_GROUP=", size.group) + " -DOTG_CONTACTS=0 -DOTG_SOLID_CONTACTS=16" +
                                number(" -DOTG_SOLID_HITS=", size.hits) + number(" -DOTG_SOLID_POINTS=", size.points) +
                                number(" -DOTG_SOLID_FACES=", size.faces) +
                                number(" -DOTG_SOLID_LARGE=", &size == &sizes_[0] ? 1 : 0) +
                                number(" -DOTG_UNEVEN_FACES=", unevenFaces_) + warpOption(context_) + registerLimit_;
    size.regions = context_.makeKernel("solid/small/regions.cl", options, "solidRegions");
    size.ways = context_.makeKernel("solid/small/ways.cl", options, "solidWays");
    size.contacts = context_.makeKernel("solid/small/contacts.cl", options, "solidContacts");
    if (!write) write = context_.makeKernel("solid/small/contacts.cl", options, "solidWrite");
  }
  estimate_ = context_.makeKernel("solid/small/estimate.cl",
                                  "-DOTG_GROUP=" + std::to_string(estimateGroup_) + registerLimit_, "solidEstimate");
  uneven_.make(context_, "solid/small/uneven.cl",
               "-DOTG_GROUP=" + std::to_string(unevenGroup_) + " -DOTG_UNEVEN_FACES=" + std::to_string(unevenFaces_) +
                   registerLimit_);
  write_ = std::move(write);
}

void SmallStage::reserve(std::uint32_t pairs, std::uint32_t hits, std::uint32_t places, bool anyPairwise) {
  build();
  if (anyPairwise) {
    if (!pairwise_) {
      pairwise_.make(context_, "pairwise/solid_pairwise.cl",
                     "-DOTG_GROUP=" + std::to_string(recordGroup_) + " -DOTG_CONTACTS=1");
    }
    pairwiseRecords_.reserve(context_, hits);
  }
  pairs = std::bit_ceil(pairs);
  room_ = places;
  sorted_.reserve(context_, hits);
  heads_.reserve(context_, pairs);
  arena_.reserve(context_, arenaWanted_);
  chunks_.reserve(context_, chunksWanted_);
  lists_.reserve(context_, 2 * OTG_SOLID_BINS * std::uint64_t{pairs});
  kept_.reserve(context_, std::uint64_t{pairs} * room_);
  directions_.reserve(context_, pairs);
  left_.reserve(context_, hits);
}

bool SmallStage::readLeft(cl_command_queue queue, const otg_uint* counters, Answer& answer) {
  if (counters[OTG_COUNT_LEFT] > left_.places()) return false;
  answer = left_.readSome(context_, queue, false, counters, counters[OTG_COUNT_LEFT], nullptr);
  return true;
}

bool SmallStage::fits(const otg_uint* counters) {
  const otg_uint units = counters[OTG_COUNT_ARENA], chunks = counters[OTG_COUNT_CHUNKS];
  const auto enough = [](otg_uint wanted) {
    return static_cast<std::uint32_t>(std::bit_ceil(std::uint64_t{wanted} + wanted / 8));
  };
  if (units > arena_.places()) arenaWanted_ = enough(units);
  if (chunks > chunks_.places()) chunksWanted_ = enough(chunks);
  return units <= arena_.places() && chunks <= chunks_.places();
}

void SmallStage::enqueue(cl_command_queue queue, const Batch& batch, Reducer& reducer, const ChosenBuffer& chosen,
                         Profile& profile) {
  Arguments(records_) << batch.pairs << batch.places << batch.tasks << batch.meshes << batch.counters << batch.hits
                      << batch.hitPlaces << batch.records << batch.states << chosen.get();
  launch(queue, records_, recordGroup_, batch.groups, 1, profile.next(Profile::kContacts));
  const Size& last = sizes_.back();
  Arguments(stretches_) << batch.count << batch.tasks << batch.places << batch.reductions << batch.counters
                        << batch.states << lists_.get() << last.hits << chosen.get();
  launch(queue, stretches_, recordGroup_, (batch.count + recordGroup_ - 1) / recordGroup_, 1,
         profile.next(Profile::kContacts));
  Arguments(scatter_) << batch.meshes << batch.tasks << batch.places << batch.counters << batch.records
                      << batch.hitPlaces << batch.states << sorted_.get() << chosen.get();
  launch(queue, scatter_, recordGroup_, batch.groups, 1, profile.next(Profile::kContacts));
  const auto groupsOf = [&](const Size& size) {
    return size.groups == 0 ? std::size_t{batch.count} : std::min<std::size_t>(size.groups, batch.count);
  };
  // Larger regions have their pieces in global memory.
  const std::uint32_t smallPoints = sizes_.size() > 1 ? last.points : 0,
                      smallFaces = sizes_.size() > 1 ? last.faces : 0;
  for (Size& size : sizes_) {
    Arguments(size.regions) << batch.meshes << batch.tasks << batch.places << batch.states << sorted_.get()
                            << sorted_.places() << batch.counters << arena_.get() << arena_.places() << heads_.get()
                            << lists_.get() << batch.count << size.firstList << size.endList << smallPoints
                            << smallFaces << chosen.get();
    launch(queue, size.regions, size.group, groupsOf(size), 1, profile.next(Profile::kRegions));
  }
  const otg_uint remembers = batch.directions != nullptr ? 1 : 0;
  const std::size_t directionBytes = batch.count * 3 * sizeof(double);
  if (remembers) writeLater(queue, directions_.get(), directionBytes, batch.directionsBefore);
  for (Size& size : sizes_) {
    Arguments(size.ways) << batch.meshes << batch.tasks << batch.places << batch.counters << arena_.get()
                         << arena_.places() << heads_.get() << lists_.get() << batch.count << size.firstList
                         << size.endList << chunks_.get() << chunks_.places()
                         << (remembers != 0 ? directions_.get() : nullptr) << chosen.get();
    launch(queue, size.ways, size.group, groupsOf(size), 1, profile.next(Profile::kWays));
  }
  if (batch.flags != nullptr) {
    cl_event flagged = nullptr;
    clDo(OTG_CL(clEnqueueReadBuffer), queue, chosen.get(), cl_bool{CL_FALSE}, std::size_t{OTG_RESULT_HEAD},
         batch.count * sizeof(otg_uint), static_cast<void*>(batch.flags), cl_uint{0},
         static_cast<const cl_event*>(nullptr), &flagged);
    *batch.flagged = EventHandle(flagged);  // at once: a later call may fail
  }
  Arguments(estimate_) << chunks_.get() << chunks_.places() << batch.counters << arena_.get();
  launch(queue, estimate_, estimateGroup_, estimateGroups_, 1, profile.next(Profile::kCandidates));
  uneven_.give({.meshes = BufferOf<otg_mesh_unit>(batch.meshes),
                .tasks = BufferOf<otg_batch_task>(batch.tasks),
                .places = BufferOf<otg_device_mesh>(batch.places),
                .counters = BufferOf<otg_counter>(batch.counters),
                .chunks = BufferOf<otg_solid_chunk>(chunks_.get()),
                .chunkRoom = chunks_.places(),
                .arena = BufferOf<otg_arena_byte>(arena_.get()),
                .arenaUnits = arena_.places()});
  launch(queue, uneven_, unevenGroup_, estimateGroups_, 1, profile.next(Profile::kCandidates));
  for (Size& size : sizes_) {
    Arguments(size.contacts) << batch.meshes << batch.tasks << batch.places << batch.states << batch.reductions
                             << batch.counters << arena_.get() << arena_.places() << heads_.get() << lists_.get()
                             << batch.count << size.firstList << size.endList << kept_.get() << room_
                             << directions_.get() << remembers << chosen.get();
    launch(queue, size.contacts, size.group, groupsOf(size), 1, profile.next(Profile::kSelect));
  }
  if (remembers) {
    clDo(OTG_CL(clEnqueueReadBuffer), queue, directions_.get(), cl_bool{CL_FALSE}, std::size_t{0}, directionBytes,
         static_cast<void*>(batch.directions), cl_uint{0}, static_cast<const cl_event*>(nullptr),
         profile.next(Profile::kReadBack));
  }
  reducer.enqueuePlaces(queue, batch.count, chosen, profile);
}

void SmallStage::enqueuePairwise(cl_command_queue queue, const Batch& batch, const ChosenBuffer& chosen,
                                 Profile& profile) {
  pairwise_.give({.pairs = BufferOf<otg_batch_pair>(batch.pairs),
                  .places = BufferOf<otg_device_mesh>(batch.places),
                  .tasks = BufferOf<otg_batch_task>(batch.tasks),
                  .meshes = BufferOf<otg_mesh_unit>(batch.meshes),
                  .counters = BufferOf<otg_counter>(batch.counters),
                  .hits = BufferOf<otg_batch_hit>(batch.hits),
                  .hitCapacity = batch.hitPlaces,
                  .decided = BufferOf<otg_result_byte>(batch.records),
                  .contacts = pairwiseRecords_.bytes(),
                  .chosen = chosen.words()});
  launch(queue, pairwise_, recordGroup_, batch.groups, 1, profile.next(Profile::kContacts));
}

void SmallStage::enqueueWrite(cl_command_queue queue, const Batch& batch, const ChosenBuffer& chosen,
                              Profile& profile) {
  Arguments(write_) << batch.counters << kept_.get() << room_ << batch.count << chosen.get() << chosen.contactPlaces()
                    << batch.states << batch.records << batch.hitPlaces << left_.get() << left_.places();
  launch(queue, write_, sizes_[0].group, batch.groups, 1, profile.next(Profile::kChoose));
}

}  // namespace otg::opencl
