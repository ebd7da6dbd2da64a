// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/solid_stage.h"

#include <algorithm>
#include <bit>
#include <string>

#include "shared/solid_layout.h"

namespace otg::opencl {

namespace {

/// Work-items for one pair. PoCL does not cope with barriers in kernels of this size.
std::uint32_t groupFor(const Context& context, const Tuning& tuning) {
  if (tuning.solidGroup != 0) return tuning.solidGroup;
  return context.info().kind == DeviceKind::kCpu ? 1 : 64;
}

/// As many hits as there is local memory for: otg_solid_scratch with some to spare.
std::uint32_t hitsFor(const Context& context, const Tuning& tuning) {
  std::uint32_t hits = std::bit_floor(std::clamp(tuning.solidHits, 32u, 1024u));
  const std::uint64_t lanes = 56 * std::uint64_t{groupFor(context, tuning)} + 1024;
  while (hits > 32 && 160 * std::uint64_t{hits} + lanes > context.info().localMemory) hits /= 2;
  return hits;
}

}  // namespace

SolidStage::SolidStage(Context& context, const Tuning& tuning)
    : context_(context),
      recordGroup_(tuning.recordGroup),
      group_(groupFor(context, tuning)),
      hits_(hitsFor(context, tuning)),
      registers_(context.info().registerLimit ? tuning.solidRegisters : 0),
      arenaWanted_(tuning.arenaUnits),
      arena_(OTG_ARENA_UNIT) {}

/// Not before they are needed: they are large, and many have contacts of the other model only.
void SolidStage::build() {
  if (write_) return;
  const std::string flat = "-DOTG_GROUP=" + std::to_string(recordGroup_) + " -DOTG_CONTACTS=0";
  const std::string pair = "-DOTG_GROUP=" + std::to_string(group_) + " -DOTG_CONTACTS=0 -DOTG_SOLID_CONTACTS=16" +
                           " -DOTG_SOLID_HITS=" + std::to_string(hits_) +
                           (registers_ != 0 ? " -cl-nv-maxrregcount=" + std::to_string(registers_) : "");
  records_ = context_.makeKernel("solid_gather.cl", flat, "solidRecords");
  stretches_ = context_.makeKernel("solid_gather.cl", flat, "solidPlaces");
  scatter_ = context_.makeKernel("solid_gather.cl", flat, "solidScatter");
  regions_ = context_.makeKernel("solid_regions.cl", pair, "solidRegions");
  contacts_ = context_.makeKernel("solid_contacts.cl", pair, "solidContacts");
  write_ = context_.makeKernel("solid_contacts.cl", pair, "solidWrite");
}

void SolidStage::reserve(std::uint32_t pairs, std::uint32_t hits, std::uint32_t places) {
  build();
  pairs = std::bit_ceil(pairs);
  room_ = places;
  sorted_.reserve(context_, hits);
  heads_.reserve(context_, pairs);
  arena_.reserve(context_, arenaWanted_);
  lists_.reserve(context_, std::uint64_t{pairs} * room_);
}

bool SolidStage::fits(std::uint32_t unitsWanted) {
  if (unitsWanted <= arena_.places()) return true;
  arenaWanted_ = static_cast<std::uint32_t>(std::bit_ceil(std::uint64_t{unitsWanted} + unitsWanted / 8));
  return false;
}

void SolidStage::enqueue(cl_command_queue queue, const Batch& batch, Reducer& reducer, const ChosenBuffer& chosen,
                         Profile& profile) {
  Arguments(records_) << batch.pairs << batch.places << batch.tasks << batch.meshes << batch.counters << batch.hits
                      << batch.hitPlaces << batch.records << batch.states << chosen.get();
  launch(queue, records_, recordGroup_, batch.groups, 1, profile.next(Profile::kContacts));
  Arguments(stretches_) << batch.count << batch.tasks << batch.places << batch.reductions << batch.counters
                        << batch.states << chosen.get();
  launch(queue, stretches_, recordGroup_, (batch.count + recordGroup_ - 1) / recordGroup_, 1,
         profile.next(Profile::kContacts));
  Arguments(scatter_) << batch.meshes << batch.tasks << batch.places << batch.counters << batch.records
                      << batch.hitPlaces << batch.states << sorted_.get() << chosen.get();
  launch(queue, scatter_, recordGroup_, batch.groups, 1, profile.next(Profile::kContacts));
  Arguments(regions_) << batch.meshes << batch.tasks << batch.places << batch.states << sorted_.get()
                      << sorted_.places() << batch.counters << arena_.get() << arena_.places() << heads_.get()
                      << chosen.get();
  launch(queue, regions_, group_, batch.count, 1, profile.next(Profile::kRegions));
  Arguments(contacts_) << batch.meshes << batch.tasks << batch.places << batch.states << batch.reductions
                       << batch.counters << arena_.get() << arena_.places() << heads_.get() << lists_.get() << room_
                       << chosen.get();
  launch(queue, contacts_, group_, batch.count, 1, profile.next(Profile::kSelect));
  reducer.enqueuePlaces(queue, batch.count, chosen, profile);
  Arguments(write_) << batch.counters << lists_.get() << room_ << batch.count << chosen.get() << chosen.contactPlaces();
  launch(queue, write_, group_, batch.groups, 1, profile.next(Profile::kChoose));
}

}  // namespace otg::opencl
