// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/overlap_stage.h"

#include <algorithm>
#include <bit>
#include <string>

#include "shared/region_grid.h"

namespace otg::opencl {
namespace {

/// With fewer hits the host is sooner done than seven kernels.
constexpr std::uint32_t kLeastHits = 1024;
constexpr std::size_t kHead = sizeof(otg_overlap_state);

/// Where the parts of the results begin, in units behind the head.
struct Parts {
  std::uint32_t vertices, clusters, crossings, small, points, end;
};

Parts partsOf(const otg_overlap_state& head) {
  const otg_uint* counts = head.counts;
  const std::uint32_t small = std::min<std::uint32_t>(counts[OTG_OVERLAP_SMALL], OTG_OVERLAP_MOST_SMALL);
  Parts p{};
  p.vertices = otgUnitsOf(counts[OTG_OVERLAP_CELLS], sizeof(otg_found_cell));
  p.clusters = p.vertices + otgUnitsOf(counts[OTG_OVERLAP_VERTICES], sizeof(otg_found_inside));
  p.crossings = p.clusters + otgUnitsOf(counts[OTG_OVERLAP_CLUSTERS], sizeof(otg_found_inside));
  p.small = p.crossings + otgUnitsOf(counts[OTG_OVERLAP_CROSSINGS], sizeof(otg_found_crossing));
  p.points = p.small + otgUnitsOf(small, sizeof(otg_found_inside));
  p.end = p.points + otgUnitsOf(counts[OTG_OVERLAP_POINTS], sizeof(otg_found_point));
  return p;
}

}  // namespace

OverlapStage::OverlapStage(Context& context, const Tuning& tuning)
    : context_(context),
      group_(tuning.overlapGroup),
      registers_(context.info().registerLimit ? tuning.solidRegisters : 0),
      mostGroups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.overlapGroupsPerUnit)),
      leastHits_(tuning.overlapHits != 0 ? tuning.overlapHits : kLeastHits),
      works_(context.info().doubles && context.info().longAtomics && tuning.solid && tuning.reduce &&
             (tuning.overlapHits != 0 || context.info().kind != DeviceKind::kCpu)),
      outWanted_(std::max(1u, tuning.overlapUnits)) {}

/// Not before they are needed.
void OverlapStage::build() {
  if (results_) return;
  const std::string options = "-DOTG_GROUP=" + std::to_string(group_) +
                              (registers_ != 0 ? " -cl-nv-maxrregcount=" + std::to_string(registers_) : "");
  contour_ = context_.makeKernel("overlap_contour.cl", options, "overlapContour");
  edges_ = context_.makeKernel("overlap_contour.cl", options, "overlapEdges");
  unite_ = context_.makeKernel("overlap_regions.cl", options, "overlapUnite");
  regions_ = context_.makeKernel("overlap_regions.cl", options, "overlapRegions");
  surface_ = context_.makeKernel("overlap_surface.cl", options, "overlapSurface");
  depths_ = context_.makeKernel("overlap_points.cl", options, "overlapDepths");
  results_ = context_.makeKernel("overlap_points.cl", options, "overlapResults");
}

void OverlapStage::reserve(cl_command_queue queue, const Pair& pair) {
  build();
  // What kernels expect to be empty; they leave it so.
  const auto emptied = [&](DeviceList& list, std::uint64_t places, std::size_t size) {
    if (places <= list.places()) return;
    list.reserve(context_, std::bit_ceil(places));
    fillZero(queue, list.get(), list.places() * size);
  };
  if (!state_) {
    state_ = context_.makeBuffer(CL_MEM_READ_WRITE, kHead);
    fillZero(queue, state_.get(), kHead);
  }
  const std::uint64_t slots = 2 * std::bit_ceil(std::uint64_t{pair.hitPlaces});
  emptied(crossings_, slots, sizeof(otg_crossing));
  slots_.reserve(context_, slots);
  hits_.reserve(context_, pair.hitPlaces);
  std::uint32_t element = static_cast<std::uint32_t>(slots), mark = 0;
  const auto take = [](std::uint32_t& next, std::size_t count) {
    const std::uint32_t first = next;
    next += static_cast<std::uint32_t>(count);
    return first;
  };
  const CollisionMesh* const meshes[] = {&pair.a, &pair.b};
  std::uint64_t clusters = 0, vertices = 0;
  sizes_.slots = element;
  for (int m = 0; m < 2; ++m) {
    const std::size_t count = meshes[m]->adjacency().clusters.size() - 1;
    sizes_.clusters[m] = take(element, count);
    sizes_.mixedMarks[m] = take(mark, count);
    clusters += count;
  }
  for (int m = 0; m < 2; ++m) {
    const TriMesh& mesh = meshes[m]->mesh();
    sizes_.vertices[m] = take(element, mesh.vertices().size());
    sizes_.voteMarks[m] = take(mark, mesh.vertices().size());
    sizes_.edgeMarks[m] = take(mark, mesh.topology().edgeCount());
    sizes_.triangleMarks[m] = take(mark, mesh.triangleCount());
    vertices += mesh.vertices().size();
  }
  sizes_.elements = element;
  parents_.reserve(context_, std::bit_ceil(std::uint64_t{element}));
  emptied(marks_, mark, sizeof(otg_uint));
  vertices_.reserve(context_, std::bit_ceil(vertices));
  clusters_.reserve(context_, std::bit_ceil(clusters));
  constexpr std::uint32_t kKeys = OTG_OVERLAP_REGIONS * OTG_GRID_KEYS;
  emptied(cells_, kKeys, sizeof(otg_surface_cell));
  cellList_.reserve(context_, kKeys);
  depthTable_.reserve(context_, kKeys);
  small_.reserve(context_, OTG_OVERLAP_MOST_SMALL);
  out_.reserve(context_, outWanted_, kHead);
  sizes_.outUnits = out_.places();
}

void OverlapStage::enqueue(cl_command_queue queue, const Pair& pair, Profile& profile) {
  // As many as have something to do. Each looks its meshes up first, which takes longer than a few more items.
  const std::uint64_t clusters = sizes_.vertices[0] - sizes_.clusters[0];
  const std::uint64_t items = std::max(
      {clusters * OTG_CLUSTER_LANES, 2 * std::uint64_t{pair.hitsExpected}, std::uint64_t{sizes_.elements} / 4});
  const std::size_t groups = std::clamp<std::size_t>(items / group_, 1, mostGroups_);
  const auto run = [&](const Kernel& kernel, Profile::Stage stage) {
    launch(queue, kernel, group_, groups, 1, profile.next(stage));
  };
  Arguments(contour_) << pair.pair << pair.bInA << sizes_ << pair.meshes << pair.counters << pair.hits << pair.hitPlaces
                      << pair.records << state_.get() << crossings_.get() << slots_.get() << hits_.get()
                      << parents_.get() << marks_.get();
  run(contour_, Profile::kContacts);
  Arguments(edges_) << pair.pair << pair.bInA << sizes_ << pair.meshes << pair.counters << pair.hitPlaces
                    << state_.get() << crossings_.get() << slots_.get() << hits_.get() << parents_.get() << marks_.get()
                    << depthTable_.get();
  run(edges_, Profile::kRegions);
  Arguments(unite_) << pair.pair << pair.bInA << sizes_ << pair.meshes << crossings_.get() << parents_.get()
                    << marks_.get();
  run(unite_, Profile::kRegions);
  Arguments(regions_) << pair.pair << pair.bInA << sizes_ << pair.meshes << pair.counters << pair.hitPlaces
                      << state_.get() << crossings_.get() << slots_.get() << hits_.get() << parents_.get()
                      << marks_.get() << vertices_.get() << clusters_.get();
  run(regions_, Profile::kRegions);
  Arguments(surface_) << pair.pair << pair.bInA << sizes_ << pair.meshes << pair.counters << pair.hitPlaces
                      << state_.get() << crossings_.get() << hits_.get() << parents_.get() << marks_.get()
                      << vertices_.get() << clusters_.get() << cells_.get() << cellList_.get() << small_.get();
  run(surface_, Profile::kSelect);
  Arguments(depths_) << pair.pair << pair.bInA << sizes_ << pair.meshes << state_.get() << crossings_.get()
                     << slots_.get() << parents_.get() << vertices_.get() << clusters_.get() << cells_.get()
                     << cellList_.get() << depthTable_.get();
  run(depths_, Profile::kChoose);
  Arguments(results_) << pair.pair << pair.bInA << sizes_ << pair.meshes << pair.counters << pair.hitPlaces
                      << state_.get() << crossings_.get() << slots_.get() << hits_.get() << parents_.get()
                      << marks_.get() << vertices_.get() << clusters_.get() << cells_.get() << cellList_.get()
                      << small_.get() << depthTable_.get() << out_.get();
  run(results_, Profile::kChoose);
}

void OverlapStage::read(cl_command_queue queue, std::size_t bytes, Profile& profile) {
  host_.reserve(context_, queue, bytes);
  readBlocking(queue, out_.get(), bytes, host_.data(), profile.next(Profile::kReadBack));
  have_ = bytes;
}

const otg_overlap_state* OverlapStage::readHead(cl_command_queue queue, Profile& profile) {
  read(queue, kHead + std::size_t{16} * std::min(expected_, out_.places()), profile);
  return reinterpret_cast<const otg_overlap_state*>(host_.data());
}

bool OverlapStage::fits() {
  const Parts parts = partsOf(*reinterpret_cast<const otg_overlap_state*>(host_.data()));
  if (parts.end <= out_.places()) return true;
  outWanted_ = std::bit_ceil(parts.end + parts.end / 8);
  return false;
}

FoundOverlap OverlapStage::readRest(cl_command_queue queue, Profile& profile) {
  Parts parts = partsOf(*reinterpret_cast<const otg_overlap_state*>(host_.data()));
  if (kHead + std::size_t{16} * parts.end > have_) read(queue, kHead + std::size_t{16} * parts.end, profile);
  // The next query is likely to have about as much.
  expected_ = std::max(1u << 12, parts.end + parts.end / 8);
  FoundOverlap found;
  found.head = reinterpret_cast<const otg_overlap_state*>(host_.data());
  const otg_uint* counts = found.head->counts;
  const auto at = [&](std::uint32_t unit) { return host_.data() + kHead + std::size_t{16} * unit; };
  const auto inside = [&](std::uint32_t unit, std::uint32_t count) {
    return std::span(reinterpret_cast<const otg_found_inside*>(at(unit)), count);
  };
  found.cells = {reinterpret_cast<const otg_found_cell*>(at(0)), counts[OTG_OVERLAP_CELLS]};
  found.vertices = inside(parts.vertices, counts[OTG_OVERLAP_VERTICES]);
  found.clusters = inside(parts.clusters, counts[OTG_OVERLAP_CLUSTERS]);
  found.crossings = {reinterpret_cast<const otg_found_crossing*>(at(parts.crossings)), counts[OTG_OVERLAP_CROSSINGS]};
  found.small = inside(parts.small, std::min<std::uint32_t>(counts[OTG_OVERLAP_SMALL], OTG_OVERLAP_MOST_SMALL));
  found.points = {reinterpret_cast<const otg_found_point*>(at(parts.points)), counts[OTG_OVERLAP_POINTS]};
  return found;
}

}  // namespace otg::opencl
