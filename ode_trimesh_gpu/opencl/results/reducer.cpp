// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/results/reducer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace otg::opencl {
namespace {

/// As OTG_MAYBE in contact_reduce.cl: candidates for each contact that may stay.
constexpr std::uint32_t kMaybe = 4;
constexpr int kMostContactsOfRegion = 16;  // SmallStage's local memory

/// Local memory of chooseContacts (otg_choice) with some to spare.
std::uint64_t localBytes(std::uint32_t kept) {
  return 33 * std::uint64_t{kept} + 256;
}

std::uint32_t keptPlacesFor(const Context& context, const Tuning& tuning, bool single) {
  std::uint32_t kept = std::clamp(single ? tuning.keptPlaces : tuning.batchKeptPlaces, 1u, 1024u);
  while (kept > 1 && localBytes(kept) > context.info().localMemory) kept /= 2;
  return kept;
}

}  // namespace

std::string warpOption(const Context& context) {
  return context.info().warps ? " -DOTG_WARP=1" : "";
}

std::string staysOption(const Context& context) {
  return context.info().kind == DeviceKind::kCpu ? " -DOTG_STAYS=1" : " -DOTG_STAYS=0";
}

std::uint32_t hitsOfGroup(const Context& context, std::uint32_t wanted) {
  std::uint32_t hits = std::clamp(std::bit_ceil(wanted), 1u, 1024u);
  // otg_group_links with some to spare
  while (hits > 1 && 49 * std::uint64_t{hits} + 512 > context.info().localMemory) hits /= 2;
  return hits;
}

std::string groupReduction(const Context& context, std::uint32_t group, std::uint32_t hits) {
  return "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_KEPT=" + std::to_string(hits) + " -DOTG_CONTACTS=1" +
         warpOption(context) + staysOption(context);
}

otg_reduction deviceReduction(const CollideOptions& options, bool byHost) {
  otg_reduction out{};
  std::copy(options.reduction.bins.begin(), options.reduction.bins.end(), out.bins);
  out.places = static_cast<otg_uint>(std::max(options.maxContacts, 0));
  if (byHost || options.maxContacts < 1) {
    out.method = OTG_REDUCE_BY_HOST;
    return out;
  }
  switch (options.reduction.method) {
    case Reduction::kNone:
      out.method = OTG_REDUCE_NONE;
      break;
    case Reduction::kBinning:
      out.method = OTG_REDUCE_BINNING;
      break;
    case Reduction::kCone:
      out.method = OTG_REDUCE_BY_HOST;
      break;
  }
  return out;
}

otg_reduction solidReduction(const CollideOptions& options, bool byHost, std::uint32_t pairwise) {
  const int each = options.solid.contactsPerRegion;
  const bool plain = each >= 1 && each <= kMostContactsOfRegion && !(options.solid.regionMerge > 0);
  otg_reduction out = deviceReduction(options, true);
  if (byHost || !plain || options.maxContacts < 1) return out;
  out = {};
  out.method = OTG_REDUCE_SOLID;
  out.bins[0] = each;
  out.bins[2] = static_cast<otg_int>(pairwise);
  out.places = static_cast<otg_uint>(options.maxContacts);
  return out;
}

Reducer::Reducer(Context& context, const Tuning& tuning, bool single)
    : context_(context),
      recordGroup_(tuning.recordGroup),
      chooseGroup_(static_cast<std::uint32_t>(std::min<std::uint64_t>(
          single ? tuning.chooseGroup : tuning.batchChooseGroup, context.info().largestWorkGroup))),
      keptPlaces_(keptPlacesFor(context, tuning, single)),
      single_(single) {
  const auto options = [&](std::uint32_t group) {
    return "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_KEPT=" + std::to_string(keptPlaces_) +
           " -DOTG_CONTACTS=1 -DOTG_SINGLE=" + (single ? "1" : "0") + warpOption(context);
  };
  if (!context.info().doubles || !tuning.reduce) return;
  unite_.make(context, "pairwise/contact_reduce.cl", options(recordGroup_));
  select_.make(context, "pairwise/contact_reduce.cl", options(recordGroup_));
  choose_.make(context, "pairwise/contact_reduce.cl", options(chooseGroup_));
  if (single) return;
  placeGroup_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(256, context.info().largestWorkGroup));
  place_.make(context, "pairwise/contact_reduce.cl", options(placeGroup_));
  write_.make(context, "pairwise/contact_reduce.cl", options(recordGroup_));
}

void Reducer::reserveStates(std::uint32_t pairs) {
  states_.reserve(context_, std::bit_ceil(pairs));
}

void Reducer::reserve(cl_command_queue queue, std::uint32_t pairs, std::uint32_t hits, std::uint32_t places) {
  reserveStates(pairs);
  pairs = std::bit_ceil(pairs);
  room_ = std::clamp(places, 1u, keptPlaces_);
  links_.reserve(context_, hits);
  kept_.reserve(context_, std::uint64_t{pairs} * keptPlaces_ * kMaybe);
  roots_.reserve(context_, std::uint64_t{pairs} * keptPlaces_);
  lists_.reserve(context_, std::uint64_t{pairs} * room_);
  const std::uint64_t slots = std::max<std::uint64_t>(64, 4 * std::bit_ceil(std::uint64_t{hits}));
  if (slots > tables_.places()) {
    tableSize_ = 0;
    tables_.reserve(context_, slots);
    fillZero(queue, tables_.get(), slots * kTables * sizeof(otg_uint));
    tableSize_ = static_cast<std::uint32_t>(slots);
  }
}

void Reducer::send(cl_command_queue queue, std::span<const otg_reduction> reductions) {
  if (sent_.size() == reductions.size() &&
      std::memcmp(sent_.data(), reductions.data(), sent_.size() * sizeof(otg_reduction)) == 0) {
    return;
  }
  sent_.clear();
  reductions_.reserve(context_, std::bit_ceil(reductions.size()));
  clDo(OTG_CL(clEnqueueWriteBuffer), queue, reductions_.get(), cl_bool{CL_TRUE}, std::size_t{0},
       reductions.size() * sizeof(otg_reduction), static_cast<const void*>(reductions.data()), cl_uint{0},
       static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
  sent_.assign(reductions.begin(), reductions.end());
}

void Reducer::enqueue(cl_command_queue queue, const Hits& hits, const ChosenBuffer& chosen,
                      BufferOf<otg_chosen_word> answer, std::size_t groups, Profile& profile) {
  const given::EnteredHits entered{.records = hits.records,
                                   .links = links_.buffer(),
                                   .tables = tables_.buffer(),
                                   .tableSize = tableSize_,
                                   .capacity = hits.capacity};
  unite_.give({.meshes = hits.meshes,
               .counters = hits.counters,
               .hits = entered,
               .states = states_.buffer(),
               .reductions = reductions_.buffer(),
               .results = chosen.words()});
  launch(queue, unite_, recordGroup_, groups, 1, profile.next(Profile::kRegions));
  select_.give({.counters = hits.counters,
                .hits = entered,
                .states = states_.buffer(),
                .reductions = reductions_.buffer(),
                .results = chosen.words(),
                .kept = kept_.buffer(),
                .roots = roots_.buffer()});
  launch(queue, select_, recordGroup_, groups, 1, profile.next(Profile::kSelect));
  choose_.give({.meshes = hits.meshes,
                .counters = hits.counters,
                .hits = entered,
                .states = states_.buffer(),
                .reductions = reductions_.buffer(),
                .kept = kept_.buffer(),
                .roots = roots_.buffer(),
                .chosen = lists_.buffer(),
                .chosenRoom = room_,
                .results = chosen.words(),
                .answer = answer});
  launch(queue, choose_, chooseGroup_, hits.pairs, 1, profile.next(Profile::kChoose));
  if (single_) return;
  enqueuePlaces(queue, hits.pairs, chosen, profile);
  write_.give({.meshes = hits.meshes,
               .counters = hits.counters,
               .hits = entered,
               .states = states_.buffer(),
               .chosen = lists_.buffer(),
               .chosenRoom = room_,
               .pairs = hits.pairs,
               .results = chosen.words(),
               .contactRoom = chosen.contactPlaces()});
  launch(queue, write_, recordGroup_, groups, 1, profile.next(Profile::kChoose));
}

void Reducer::enqueuePlaces(cl_command_queue queue, std::uint32_t pairs, const ChosenBuffer& chosen, Profile& profile) {
  place_.give({.pairs = pairs, .results = chosen.words()});
  launch(queue, place_, placeGroup_, 1, 1, profile.next(Profile::kChoose));
}

}  // namespace otg::opencl
