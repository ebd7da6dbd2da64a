// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/solid/large_contacts.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "collide/solid/escape.h"
#include "collide/solid/solid_contacts.h"
#include "opencl/results/reducer.h"

namespace otg::opencl {
namespace {

constexpr std::uint32_t kRegions = OTG_OVERLAP_REGIONS;
/// Hits of small regions that there is room for at first, and how many of them are read with the head.
constexpr std::uint32_t kSmallAtFirst = kRegions * OTG_SOLID_LARGE_REGION, kSmallAhead = OTG_SOLID_LARGE_REGION;
constexpr std::uint32_t kUnitsOfRegion = sizeof(otg_region_work) / OTG_ARENA_UNIT;
/// Work-groups of overlapWeigh for one region: six with tasks of their own, the others weigh faces. And of many pairs.
constexpr std::uint32_t kWeighGroups = 54, kWeighOfMany = 22;
/// Work-groups for one region: a line of each direction, or a part of its extent, or a few directions; candidates.
constexpr std::size_t kExtentGroups = 16, kDeepGroups = 64, kCandidateGroups = 256;
constexpr std::size_t kEscapeGroups = OTG_ESCAPE_DIRECTIONS * (kExtentGroups + OTG_ESCAPE_ORIGINS) + 1;
constexpr std::size_t kTurnGroups = OTG_ESCAPE_SIDES * (kExtentGroups + OTG_ESCAPE_ORIGINS);
/// The same where there are many pairs, and the size of work-groups there: others have something to do while one waits.
constexpr std::uint32_t kLanesOfMany = 32;
constexpr std::size_t kWaysOfMany = 16, kCandidatesOfMany = 64;
/// And on CPUs, where a work-group is one lane and a launch that is empty costs something for each.
constexpr std::size_t kCpuGroups = 4;

void store(double* to, const Vec3d& v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

}  // namespace

otg_overlap_task overlapTask(const Query& query) {
  otg_overlap_task task{};
  const PairMotion motion = motionBefore(query);
  store(task.motion.back, motion.back);
  store(task.motion.escape, motion.escape);
  store(task.motion.deepNormal, motion.deepNormal);
  task.motion.step = motion.step;
  task.most = static_cast<std::uint32_t>(std::max(query.options.solid.contactsPerRegion, 0));
  return task;
}

LargeContacts::LargeContacts(Context& context, const Tuning& tuning, bool many)
    : context_(context),
      isCpu_(context.info().kind == DeviceKind::kCpu),
      forMany_(many),
      lanes_(tuning.overlapLanes),
      weighGroups_(many || isCpu_ ? kWeighOfMany : kWeighGroups),
      arenaWanted_(std::max(1u, tuning.overlapArena)),
      smallWanted_(kSmallAtFirst) {}

/// Not before they are needed.
void LargeContacts::build() {
  if (choose_.kernel) return;
  const auto make = [&](const char* file, std::uint32_t lanes, const char* name) {
    const std::uint32_t group = lanes_ != 0 ? lanes_ : isCpu_ ? 1 : forMany_ ? kLanesOfMany : lanes;
    const std::string options = "-DOTG_GROUP=" + std::to_string(group) + warpOption(context_) +
                                " -DOTG_WEIGH_GROUPS=" + std::to_string(weighGroups_);
    return Made{context_.makeKernel(file, options, name), group};
  };
  list_ = make("solid/large/arena.cl", 256, "overlapList");
  arena_ = make("solid/large/arena.cl", 256, "overlapArena");
  weigh_ = make("solid/large/weigh.cl", 128, "overlapWeigh");
  ways_ = make("solid/large/ways.cl", 128, "overlapWays");
  turn_ = make("solid/large/ways.cl", 128, "overlapTurn");
  candidates_ = make("solid/large/candidates.cl", 128, "overlapCandidates");
  choose_ = make("solid/large/choose.cl", 256, "overlapChoose");
}

void LargeContacts::reserve(cl_command_queue queue) {
  build();
  if (!progress_) {
    BufferHandle progress = context_.makeBuffer(CL_MEM_READ_WRITE, sizeof(otg_overlap_progress));
    fillZero(queue, progress.get(), sizeof(otg_overlap_progress));
    progress_ = std::move(progress);
  }
  slots_ = kRegions;
  if (count_ > 1) {
    slots_ = std::max(slotsWanted_, std::bit_ceil(count_));
    places_.reserve(context_, slots_);
  }
  small_ = smallWanted_;
  tasks_.reserve(context_, count_);
  space_.reserve(context_, std::uint64_t{slots_} * kUnitsOfRegion + arenaWanted_);
  results_.reserve(context_, smallAt() + std::uint64_t{small_} * sizeof(otg_found_inside));
}

void LargeContacts::enqueue(cl_command_queue queue, const Pairs& pairs, Profile& profile) {
  count_ = static_cast<std::uint32_t>(pairs.tasks.size());
  stride_ = 1;
  for (const otg_overlap_task& task : pairs.tasks) stride_ = std::max(stride_, task.most);
  reserve(queue);
  const auto complete = [&](otg_overlap_task task) {
    task.pairs = count_;
    task.unitRoom = pairs.unitRoom;
    task.tableRoom = pairs.tableRoom;
    return task;
  };
  const auto run = [&](const Made& made, std::size_t groups, std::size_t rows, Profile::Stage stage) {
    launch(queue, made.kernel, made.group, groups, rows, profile.next(stage));
  };
  const bool many = count_ > 1;
  const cl_mem places = many ? places_.get() : nullptr;
  if (many) {
    staged_.reserve(context_, queue, count_ * sizeof(otg_overlap_task));
    std::transform(pairs.tasks.begin(), pairs.tasks.end(), reinterpret_cast<otg_overlap_task*>(staged_.data()),
                   complete);
    writeLater(queue, tasks_.get(), count_ * sizeof(otg_overlap_task), staged_.data(), profile.next(Profile::kWrite));
    Arguments(list_.kernel) << tasks_.get() << pairs.description << places << slots_ << progress_.get();
    run(list_, (std::size_t{count_} * kRegions + list_.group - 1) / list_.group, 1, Profile::kWeigh);
  }
  // Of many pairs some are entangled.
  const cl_uint turns = many || turns_ ? 1 : 0;
  const cl_uint begin = slots_ * kUnitsOfRegion;
  Arguments(arena_.kernel) << complete(pairs.tasks[0]) << pairs.pairs << pairs.meshes << pairs.description << places
                           << tasks_.get() << space_.get() << begin << space_.places() << progress_.get();
  run(arena_, std::size_t{2} * slots_, 1, Profile::kWeigh);
  Arguments(weigh_.kernel) << space_.get();
  run(weigh_, std::size_t{weighGroups_} * slots_, 1, Profile::kWeigh);
  Arguments(ways_.kernel) << pairs.pairs << pairs.meshes << tasks_.get() << pairs.description << space_.get();
  const std::size_t forWays = many ? kWaysOfMany : turns ? kEscapeGroups : kDeepGroups;
  run(ways_, isCpu_ ? kCpuGroups : forWays, slots_, Profile::kWays);
  for (cl_uint turn = 0; turn < (turns ? OTG_ESCAPE_TURNS : 0); ++turn) {
    Arguments(turn_.kernel) << pairs.pairs << pairs.meshes << tasks_.get() << pairs.description << space_.get() << turn;
    run(turn_, isCpu_ ? kCpuGroups : many ? kWaysOfMany : kTurnGroups, slots_, Profile::kWays);
  }
  Arguments(candidates_.kernel) << pairs.pairs << pairs.meshes << tasks_.get() << pairs.description << space_.get()
                                << turns;
  run(candidates_, isCpu_ ? kCpuGroups : many ? kCandidatesOfMany : kCandidateGroups, slots_, Profile::kCandidates);
  Arguments(choose_.kernel) << tasks_.get() << pairs.description << space_.get() << turns << slots_ << stride_ << small_
                            << progress_.get() << results_.get();
  run(choose_, std::size_t{slots_} + count_, 1, Profile::kChoose);
}

void LargeContacts::read(cl_command_queue queue, std::size_t from, std::size_t bytes, Profile& profile) {
  clDo(OTG_CL(clEnqueueReadBuffer), queue, results_.get(), cl_bool{CL_FALSE}, from, bytes,
       static_cast<void*>(host_.data() + from), cl_uint{0}, static_cast<const cl_event*>(nullptr),
       profile.next(Profile::kReadBack));
}

void LargeContacts::beginHead(cl_command_queue queue, Profile& profile) {
  host_.reserve(context_, queue, smallAt() + std::size_t{small_} * sizeof(otg_found_inside));
  have_ = count_ > 1 ? headBytes() : smallAt() + kSmallAhead * sizeof(otg_found_inside);
  read(queue, 0, have_, profile);
  clDo(OTG_CL(clFlush), queue);
}

void LargeContacts::endHead(cl_command_queue queue) {
  clDo(OTG_CL(clFinish), queue);
}

bool LargeContacts::isIncomplete() {
  const auto enough = [](std::uint64_t wanted) {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(std::bit_ceil(wanted + wanted / 8), 0x7fffffffu));
  };
  bool escapes = false, missing = false;
  for (std::uint32_t pair = 0; pair < count_; ++pair) {
    for (const otg_found_contacts& region : head(pair).regions) {
      constexpr std::uint32_t kBoth = OTG_FOUND_ESCAPING | OTG_FOUND_COUNTS;
      escapes = escapes || (region.status & kBoth) == kBoth;
      missing = missing || (region.status & OTG_FOUND_TURNS) != 0;
    }
  }
  // The next query is likely to be such a one, too.
  if (count_ == 1) turns_ = escapes;
  const otg_overlap_progress& wanted = sums().progress;
  const bool slotsFit = wanted.slots <= slots_, smallFits = wanted.small <= small_;
  const bool spaceFits = std::uint64_t{slots_} * kUnitsOfRegion + wanted.arenaUnits <= space_.places();
  if (!slotsFit) slotsWanted_ = enough(wanted.slots);
  if (!smallFits) smallWanted_ = enough(wanted.small);
  if (!spaceFits) arenaWanted_ = enough(wanted.arenaUnits);
  return missing || !slotsFit || !smallFits || !spaceFits;
}

void LargeContacts::readRest(cl_command_queue queue, Profile& profile) {
  const std::size_t slots = count_ > 1 ? std::min(sums().progress.slots, slots_) : slots_;
  const std::size_t contactsEnd = headBytes() + slots * stride_ * sizeof(otg_chosen_contact);
  const std::size_t smallEnd = smallAt() + std::size_t{sums().progress.small} * sizeof(otg_found_inside);
  const std::size_t smallFrom = std::max(have_, smallAt());
  if (contactsEnd > have_) read(queue, have_, contactsEnd - have_, profile);
  if (sums().progress.small > 0 && smallEnd > smallFrom) read(queue, smallFrom, smallEnd - smallFrom, profile);
  clDo(OTG_CL(clFinish), queue);
}

FoundContacts LargeContacts::found(std::uint32_t pair) const {
  FoundContacts found;
  found.head = &head(pair);
  const std::byte* const contacts = host_.data() + headBytes();
  found.contacts = {reinterpret_cast<const Contact*>(contacts), std::size_t{slots_} * stride_};
  found.small = {reinterpret_cast<const otg_found_inside*>(host_.data() + smallAt()) + found.head->firstSmall,
                 found.head->small};
  return found;
}

}  // namespace otg::opencl
