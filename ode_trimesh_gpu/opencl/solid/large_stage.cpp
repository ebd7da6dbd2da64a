// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/solid/large_stage.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace otg::opencl {
namespace {

/// With fewer hits the CPU is faster than the kernels, part of whose work stays unused.
constexpr std::uint32_t kLeastHits = 256;

otg_overlap_counts countsOf(const CollisionMesh& mesh) {
  return {
      static_cast<otg_uint>(mesh.adjacency().clusters.size() - 1), static_cast<otg_uint>(mesh.mesh().vertices().size()),
      static_cast<otg_uint>(mesh.mesh().topology().edgeCount()), static_cast<otg_uint>(mesh.mesh().triangleCount())};
}

/// Whether it is another mesh than a solid of one component.
bool hasParts(const CollisionMesh* mesh) {
  return mesh->mesh().meshClass() != MeshClass::kSolid || mesh->mesh().topology().componentCount() != 1;
}

std::uint64_t insideOf(const otg_overlap_sizes& sizes) {
  return sizes.elements - sizes.slots;
}

}  // namespace

LargeStage::LargeStage(Context& context, const Tuning& tuning)
    : context_(context),
      group_(tuning.overlapGroup),
      mostGroups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.overlapGroupsPerUnit)),
      leastHits_(tuning.overlapHits != 0 ? tuning.overlapHits : kLeastHits),
      works_(works(context, tuning)),
      outWanted_(std::max(1u, tuning.overlapUnits)) {}

bool LargeStage::works(Context& context, const Tuning& tuning) {
  const DeviceInfo& device = context.info();
  if (context.programs().hasFailed("solid/large/")) return false;
  return device.doubles && device.longAtomics && tuning.solid && tuning.reduce &&
         (tuning.overlapHits != 0 || device.kind != DeviceKind::kCpu);
}

/// Not before they are needed.
void LargeStage::build() {
  if (results_) return;
  const std::string options = "-DOTG_GROUP=" + std::to_string(group_);
  contour_ = context_.makeKernel("solid/large/contour.cl", options, "overlapContour");
  take_ = context_.makeKernel("solid/large/contour.cl", options, "overlapTake");
  enter_ = context_.makeKernel("solid/large/contour.cl", options, "overlapEnter");
  edges_ = context_.makeKernel("solid/large/contour.cl", options, "overlapEdges");
  contained_ = context_.makeKernel("solid/large/contained.cl", options, "overlapContained");
  unite_ = context_.makeKernel("solid/large/regions.cl", options, "overlapUnite");
  votes_ = context_.makeKernel("solid/large/regions.cl", options, "overlapVotes");
  join_ = context_.makeKernel("solid/large/regions.cl", options, "overlapJoin");
  regions_ = context_.makeKernel("solid/large/regions.cl", options, "overlapRegions");
  surface_ = context_.makeKernel("solid/large/surface.cl", options, "overlapSurface");
  depths_ = context_.makeKernel("solid/large/points.cl", options, "overlapDepths");
  unitPlaces_ = context_.makeKernel("solid/large/points.cl", options, "overlapPlaces");
  results_ = context_.makeKernel("solid/large/points.cl", options, "overlapResults");
}

void LargeStage::reserve(cl_command_queue queue, const Sizes& sizes) {
  build();
  // What kernels expect to be empty; they leave it so.
  const auto emptied = [&](DeviceList& list, std::uint64_t places, std::size_t size) {
    if (places <= list.places()) return;
    list.reserve(context_, std::bit_ceil(places));
    fillZero(queue, list.get(), list.places() * size);
  };
  const auto some = [&](DeviceList& list, std::uint64_t places) { list.reserve(context_, std::bit_ceil(places)); };
  count_ = sizes.pairs;
  if (!totals_) {
    totals_ = context_.makeBuffer(CL_MEM_READ_WRITE, sizeof(otg_overlap_totals));
    fillZero(queue, totals_.get(), sizeof(otg_overlap_totals));
  }
  some(pairs_, count_);
  emptied(states_, count_, sizeof(otg_overlap_state));
  emptied(crossings_, sizes.slots, sizeof(otg_crossing));
  some(slots_, sizes.slots);
  hits_.reserve(context_, sizes.hits);
  small_.reserve(context_, sizes.hits);
  some(parents_, sizes.slots + sizes.inside);
  some(balances_, sizes.inside);
  some(inside_, sizes.inside);
  emptied(marks_, sizes.marks, sizeof(otg_uint));
  const std::uint32_t tables = std::max(sizes.tables, tablesWanted_);
  emptied(cells_, tables, OTG_GRID_KEYS * sizeof(otg_surface_cell));
  cellList_.reserve(context_, cells_.places());
  depthTable_.reserve(context_, cells_.places());
  out_.reserve(context_, outWanted_ + headBytes() / 16);
}

void LargeStage::reserve(cl_command_queue queue, const Pair& pair) {
  const std::uint32_t slots = otgSlotsFor(pair.hitPlaces);
  const otg_overlap_sizes sizes = otgOverlapSizes(slots, countsOf(pair.a), countsOf(pair.b));
  reserve(queue, {slots, insideOf(sizes), sizes.marks, pair.hitPlaces, 1, OTG_OVERLAP_REGIONS});
}

void LargeStage::enqueue(cl_command_queue queue, const Pair& pair, Profile& profile) {
  otg_overlap_pair single{};
  single.bInA = pair.bInA;
  single.mesh[0] = pair.pair.a;
  single.mesh[1] = pair.pair.b;
  single.sizes = otgOverlapSizes(otgSlotsFor(pair.hitPlaces), countsOf(pair.a), countsOf(pair.b));
  // As many as have something to do. Each looks its meshes up first, which takes longer than a few more items.
  const std::uint64_t clusters = single.sizes.vertices[0] - single.sizes.clusters[0];
  const std::uint64_t items = std::max(
      {clusters * OTG_CLUSTER_LANES, 2 * std::uint64_t{pair.hitsExpected}, std::uint64_t{single.sizes.elements} / 4});
  const std::size_t groups = std::clamp<std::size_t>(items / group_, 1, mostGroups_);
  Arguments(contour_) << single << pair.meshes << pair.counters << pair.hits << pair.hitPlaces << pair.records
                      << pairs_.get() << states_.get() << crossings_.get() << slots_.get() << hits_.get()
                      << parents_.get() << marks_.get() << balances_.get();
  launch(queue, contour_, group_, groups, 1, profile.next(Profile::kContacts));
  anyParts_ = !(single.mesh[0].flags & single.mesh[1].flags & OTG_MESH_SOLID);
  enqueueRest(queue, pair.meshes, pair.counters, groups, profile);
}

void LargeStage::reserve(cl_command_queue queue, const Batch& batch) {
  anyParts_ = std::any_of(batch.bodies.begin(), batch.bodies.end(), hasParts);
  Sizes sizes{0, 0, 0, batch.hitPlaces, static_cast<std::uint32_t>(batch.pairs.size()), 0};
  staged_.reserve(context_, queue, batch.pairs.size() * sizeof(otg_listed_overlap));
  auto* const tasks = reinterpret_cast<otg_listed_overlap*>(staged_.data());
  for (std::size_t i = 0; i < batch.pairs.size(); ++i) {
    const otg_listed_overlap& pair = batch.pairs[i];
    tasks[i] = {pair.number, pair.hits, static_cast<otg_uint>(sizes.slots), static_cast<otg_uint>(sizes.inside),
                static_cast<otg_uint>(sizes.marks)};
    const otg_overlap_sizes own =
        otgOverlapSizes(otgSlotsFor(pair.hits), countsOf(*batch.bodies[2 * i]), countsOf(*batch.bodies[2 * i + 1]));
    sizes.slots += own.slots;
    sizes.inside += insideOf(own);
    sizes.marks += own.marks;
  }
  reserve(queue, sizes);
  tasks_.reserve(context_, std::bit_ceil(batch.pairs.size()));
}

void LargeStage::enqueue(cl_command_queue queue, const Batch& batch, Profile& profile) {
  writeLater(queue, tasks_.get(), count_ * sizeof(otg_listed_overlap), staged_.data(), profile.next(Profile::kWrite));
  Arguments(take_) << count_ << tasks_.get() << batch.tasks << batch.places << batch.meshes << batch.states
                   << pairs_.get();
  launch(queue, take_, group_, (count_ + group_ - 1) / group_, 1, profile.next(Profile::kWrite));
  const std::size_t groups = std::clamp<std::size_t>(mostGroups_ / count_, 1, 32);
  Arguments(enter_) << pairs_.get() << batch.meshes << batch.hits << states_.get() << crossings_.get() << slots_.get()
                    << hits_.get() << parents_.get() << marks_.get() << balances_.get();
  launch(queue, enter_, group_, groups, count_, profile.next(Profile::kContacts));
  enqueueRest(queue, batch.meshes, nullptr, groups, profile);
}

/// From the crossings on; `groups` for each pair.
void LargeStage::enqueueRest(cl_command_queue queue, cl_mem meshes, cl_mem counters, std::size_t groups,
                             Profile& profile) {
  const auto run = [&](const Kernel& kernel, Profile::Stage stage) {
    launch(queue, kernel, group_, groups, count_, profile.next(stage));
  };
  const cl_mem pairs = pairs_.get(), states = states_.get(), totals = totals_.get(), crossings = crossings_.get(),
               slots = slots_.get(), hits = hits_.get(), parents = parents_.get(), marks = marks_.get(),
               balances = balances_.get(), inside = inside_.get(), cells = cells_.get(), cellList = cellList_.get(),
               small = small_.get(), depthTable = depthTable_.get();
  Arguments(edges_) << pairs << meshes << states << crossings << slots << hits << parents << marks << inside;
  run(edges_, Profile::kRegions);
  if (anyParts_) {
    Arguments(contained_) << pairs << meshes << states;
    launch(queue, contained_, group_, 1, count_, profile.next(Profile::kRegions));
  }
  // It has few registers, and most to wait for.
  Arguments(unite_) << pairs << meshes << states << crossings << slots << parents << marks << inside;
  launch(queue, unite_, group_, 2 * groups, count_, profile.next(Profile::kRegions));
  Arguments(votes_) << pairs << meshes << states << crossings << slots << parents << marks << balances;
  run(votes_, Profile::kRegions);
  Arguments(join_) << pairs << meshes << states << crossings << slots << hits << parents << marks << balances;
  run(join_, Profile::kRegions);
  Arguments(regions_) << pairs << meshes << states << totals << crossings << slots << hits << parents << marks
                      << inside;
  run(regions_, Profile::kRegions);
  Arguments(surface_) << pairs << meshes << states << crossings << slots << hits << parents << marks << inside << cells
                      << cellList << small << depthTable << tableRoom();
  run(surface_, Profile::kSelect);
  Arguments(depths_) << pairs << meshes << states << crossings << slots << parents << inside << cells << cellList
                     << depthTable << tableRoom();
  run(depths_, Profile::kChoose);
  if (counters == nullptr) {
    Arguments(unitPlaces_) << count_ << states << totals;
    launch(queue, unitPlaces_, group_, (count_ + group_ - 1) / group_, 1, profile.next(Profile::kChoose));
  }
  Arguments(results_) << pairs << meshes << states << totals << crossings << slots << hits << parents << marks << inside
                      << cells << cellList << small << depthTable << tableRoom() << out_.get() << unitRoom()
                      << counters;
  run(results_, Profile::kChoose);
}

void LargeStage::beginHead(cl_command_queue queue, Profile& profile) {
  have_ = headBytes() + std::min(std::size_t{16} * expected_, std::size_t{16} * out_.places() - headBytes());
  host_.reserve(context_, queue, have_);
  clDo(OTG_CL(clEnqueueReadBuffer), queue, out_.get(), cl_bool{CL_FALSE}, std::size_t{0}, have_,
       static_cast<void*>(host_.data()), cl_uint{0}, static_cast<const cl_event*>(nullptr),
       profile.next(Profile::kReadBack));
  clDo(OTG_CL(clFlush), queue);
}

bool LargeStage::endHead(cl_command_queue queue) {
  clDo(OTG_CL(clFinish), queue);
  return fits(*reinterpret_cast<const otg_overlap_totals*>(host_.data()));
}

bool LargeStage::fits(const otg_overlap_totals& totals) {
  const auto enough = [](otg_uint wanted) {
    return static_cast<std::uint32_t>(std::bit_ceil(std::uint64_t{wanted} + wanted / 8));
  };
  const bool unitsFit = totals.units <= unitRoom(), tablesFit = totals.tables <= tableRoom();
  if (!unitsFit) outWanted_ = enough(totals.units);
  if (!tablesFit) tablesWanted_ = enough(totals.tables);
  return unitsFit && tablesFit;
}

const otg_overlap_state& LargeStage::head(std::uint32_t pair) const {
  return reinterpret_cast<const otg_overlap_state*>(host_.data() + sizeof(otg_overlap_totals))[pair];
}

void LargeStage::readRest(cl_command_queue queue, Profile& profile) {
  const std::uint32_t units = reinterpret_cast<const otg_overlap_totals*>(host_.data())->units;
  const std::size_t bytes = headBytes() + std::size_t{16} * units;
  // The next query is likely to have about as much.
  expected_ = std::max(1u << 12, units + units / 8);
  if (bytes <= have_) return;
  host_.reserve(context_, queue, bytes);
  readBlocking(queue, out_.get(), bytes, host_.data(), profile.next(Profile::kReadBack));
  have_ = bytes;
}

FoundOverlap LargeStage::found(std::uint32_t pair) const {
  FoundOverlap found;
  found.head = &head(pair);
  const otg_uint* counts = found.head->counts;
  const otg_overlap_parts parts =
      otgPartsOf(counts[OTG_OVERLAP_CELLS], counts[OTG_OVERLAP_VERTICES], counts[OTG_OVERLAP_CLUSTERS],
                 counts[OTG_OVERLAP_CROSSINGS], counts[OTG_OVERLAP_SMALL]);
  const auto at = [&](std::uint32_t unit) {
    return host_.data() + headBytes() + std::size_t{16} * (std::size_t{found.head->firstUnit} + unit);
  };
  const auto inside = [&](std::uint32_t unit, std::uint32_t count) {
    return std::span(reinterpret_cast<const otg_found_inside*>(at(unit)), count);
  };
  found.cells = {reinterpret_cast<const otg_found_cell*>(at(0)), counts[OTG_OVERLAP_CELLS]};
  found.vertices = inside(parts.vertices, counts[OTG_OVERLAP_VERTICES]);
  found.clusters = inside(parts.clusters, counts[OTG_OVERLAP_CLUSTERS]);
  found.crossings = {reinterpret_cast<const otg_found_crossing*>(at(parts.crossings)), counts[OTG_OVERLAP_CROSSINGS]};
  found.small = inside(parts.small, counts[OTG_OVERLAP_SMALL]);
  found.points = {reinterpret_cast<const otg_found_point*>(at(parts.points)), counts[OTG_OVERLAP_POINTS]};
  return found;
}

}  // namespace otg::opencl
