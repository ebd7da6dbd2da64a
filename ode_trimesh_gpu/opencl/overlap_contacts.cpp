// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/overlap_contacts.h"

#include <algorithm>
#include <bit>
#include <string>

#include "collide/solid/escape.h"
#include "collide/solid_contacts.h"

namespace otg::opencl {
namespace {

constexpr std::uint32_t kRegions = OTG_OVERLAP_REGIONS;
constexpr std::size_t kMostSmall = std::size_t{kRegions} * OTG_SOLID_LARGE_REGION;  ///< hits of small regions
constexpr std::uint32_t kBegin = kRegions * (sizeof(otg_region_work) / OTG_ARENA_UNIT);
/// Work-groups of overlapWeigh for one region: six with tasks of their own, the others weigh faces.
constexpr std::uint32_t kWeighGroups = 22;
/// Work-groups for one region: a line of each direction, or a few directions; candidates.
constexpr std::size_t kEscapeGroups = OTG_ESCAPE_DIRECTIONS * (1 + OTG_ESCAPE_ORIGINS) + 1, kDeepGroups = 16;
constexpr std::size_t kTurnGroups = OTG_ESCAPE_SIDES * (1 + OTG_ESCAPE_ORIGINS), kCandidateGroups = 256;
/// The same on CPUs, where a work-group is one lane and a launch that is empty costs something for each.
constexpr std::size_t kCpuGroups = 4;

std::size_t bytesOf(std::uint32_t most, std::size_t small) {
  return sizeof(otg_contacts_head) + std::size_t{kRegions} * most * sizeof(otg_chosen_contact) +
         small * sizeof(otg_found_inside);
}

void store(double* to, const Vec3d& v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

}  // namespace

OverlapContacts::OverlapContacts(Context& context, const Tuning& tuning)
    : context_(context),
      isCpu_(context.info().kind == DeviceKind::kCpu),
      works_(tuning.overlapContacts != 0),
      lanes_(tuning.overlapLanes),
      registers_(context.info().registerLimit ? tuning.solidRegisters : 0),
      arenaWanted_(std::max(kBegin + 1, tuning.overlapArena)) {}

/// Not before they are needed.
void OverlapContacts::build() {
  if (choose_.kernel) return;
  const auto make = [&](const char* file, std::uint32_t lanes, const char* name) {
    const std::uint32_t group = lanes_ != 0 ? lanes_ : isCpu_ ? 1 : lanes;
    const std::string options = "-DOTG_GROUP=" + std::to_string(group) +
                                " -DOTG_WEIGH_GROUPS=" + std::to_string(kWeighGroups) +
                                (registers_ != 0 ? " -cl-nv-maxrregcount=" + std::to_string(registers_) : "");
    return Made{context_.makeKernel(file, options, name), group};
  };
  arena_ = make("overlap_arena.cl", 256, "overlapArena");
  weigh_ = make("overlap_weigh.cl", 128, "overlapWeigh");
  ways_ = make("overlap_ways.cl", 128, "overlapWays");
  turn_ = make("overlap_ways.cl", 128, "overlapTurn");
  candidates_ = make("overlap_candidates.cl", 128, "overlapCandidates");
  choose_ = make("overlap_choose.cl", 256, "overlapChoose");
}

void OverlapContacts::reserve(cl_command_queue queue) {
  build();
  if (!progress_) {
    progress_ = context_.makeBuffer(CL_MEM_READ_WRITE, sizeof(otg_overlap_progress));
    fillZero(queue, progress_.get(), sizeof(otg_overlap_progress));
    task_ = context_.makeBuffer(CL_MEM_READ_WRITE, sizeof(otg_overlap_task));
  }
  space_.reserve(context_, arenaWanted_);
  results_.reserve(context_, bytesOf(std::max(most_, 16u), kMostSmall));
}

void OverlapContacts::enqueue(cl_command_queue queue, const Pair& pair, Profile& profile) {
  most_ = static_cast<std::uint32_t>(std::max(pair.query.options.solid.contactsPerRegion, 0));
  reserve(queue);
  otg_overlap_task task{};
  const PairMotion motion = motionBefore(pair.query);
  store(task.motion.back, motion.back);
  store(task.motion.escape, motion.escape);
  store(task.motion.deepNormal, motion.deepNormal);
  task.motion.step = motion.step;
  task.most = most_;
  task.pairs = 1;
  task.unitRoom = pair.unitRoom;
  task.tableRoom = pair.tableRoom;
  const auto run = [&](const Made& made, std::size_t groups, std::size_t rows, Profile::Stage stage) {
    launch(queue, made.kernel, made.group, groups, rows, profile.next(stage));
  };
  const cl_uint turns = turns_ ? 1 : 0;
  Arguments(arena_.kernel) << task << pair.pairs << pair.meshes << pair.description << task_.get() << space_.get()
                           << kBegin << space_.places() << progress_.get();
  run(arena_, std::size_t{2} * kRegions, 1, Profile::kWeigh);
  Arguments(weigh_.kernel) << space_.get();
  run(weigh_, std::size_t{kWeighGroups} * kRegions, 1, Profile::kWeigh);
  Arguments(ways_.kernel) << pair.pairs << pair.meshes << task_.get() << pair.description << space_.get();
  run(ways_, isCpu_ ? kCpuGroups : turns_ ? kEscapeGroups : kDeepGroups, kRegions, Profile::kWays);
  for (cl_uint turn = 0; turn < (turns_ ? OTG_ESCAPE_TURNS : 0); ++turn) {
    Arguments(turn_.kernel) << pair.pairs << pair.meshes << task_.get() << pair.description << space_.get() << turn;
    run(turn_, isCpu_ ? kCpuGroups : kTurnGroups, kRegions, Profile::kWays);
  }
  Arguments(candidates_.kernel) << pair.pairs << pair.meshes << task_.get() << pair.description << space_.get()
                                << turns;
  run(candidates_, isCpu_ ? kCpuGroups : kCandidateGroups, kRegions, Profile::kCandidates);
  Arguments(choose_.kernel) << task_.get() << pair.description << space_.get() << turns << cl_uint{kRegions}
                            << progress_.get() << results_.get();
  run(choose_, kRegions + 1, 1, Profile::kChoose);
}

FoundContacts OverlapContacts::read(cl_command_queue queue, Profile& profile) {
  // As many hits of small regions as there may be of one.
  std::size_t small = OTG_SOLID_LARGE_REGION;
  const auto get = [&] {
    const std::size_t bytes = bytesOf(most_, small);
    host_.reserve(context_, queue, bytes);
    readBlocking(queue, results_.get(), bytes, host_.data(), profile.next(Profile::kReadBack));
  };
  get();
  const auto* head = reinterpret_cast<const otg_contacts_head*>(host_.data());
  const std::size_t listed = std::min<std::size_t>(head->state.counts[OTG_OVERLAP_SMALL], kMostSmall);
  if (listed > small) {
    small = listed;
    get();
    head = reinterpret_cast<const otg_contacts_head*>(host_.data());
  }
  FoundContacts found;
  found.head = head;
  found.most = most_;
  found.contacts = {reinterpret_cast<const Contact*>(head + 1), std::size_t{kRegions} * most_};
  found.small = {reinterpret_cast<const otg_found_inside*>(found.contacts.data() + found.contacts.size()), listed};
  return found;
}

bool OverlapContacts::isIncomplete() {
  const auto* head = reinterpret_cast<const otg_contacts_head*>(host_.data());
  const std::uint64_t units = std::uint64_t{kBegin} + head->progress.arenaUnits;
  bool escapes = false, missing = false;
  for (const otg_found_contacts& region : head->regions) {
    escapes =
        escapes || (region.status & (OTG_FOUND_ESCAPING | OTG_FOUND_COUNTS)) == (OTG_FOUND_ESCAPING | OTG_FOUND_COUNTS);
    missing = missing || (region.status & OTG_FOUND_TURNS) != 0;
  }
  // The next query is likely to be such a one, too.
  turns_ = escapes;
  if (units <= space_.places()) return missing;
  arenaWanted_ = static_cast<std::uint32_t>(std::bit_ceil(units + units / 8));
  return true;
}

}  // namespace otg::opencl
