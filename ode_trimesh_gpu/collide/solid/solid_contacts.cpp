// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/solid_contacts.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/scratch_memory.h"
#include "base/vectors.h"
#include "collide/boxes_apart.h"
#include "collide/contact_copies.h"
#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/shell/shell_approach.h"
#include "collide/shell/shell_contacts.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/solid/contour.h"
#include "collide/solid/escape.h"
#include "collide/solid/found_overlap.h"
#include "collide/solid/inside.h"
#include "collide/solid/merge_regions.h"
#include "collide/solid/part_pairs.h"
#include "collide/solid/region_contacts.h"
#include "collide/solid/region_refiner.h"
#include "collide/solid/regions.h"
#include "collide/stages.h"

namespace otg {

struct SolidScratch {
  SolidScratch() { regions.memory = small.regions.memory = &ofRegion; }
  Contour contour;
  InsideFlags inside;
  RegionBuilder builder;
  OverlapRegions regions;
  SmallRegions small;
  ScratchMemory ofRegion;
  std::vector<std::uint8_t> ends;  ///< of the contour's crossings
};

Workspace::Workspace() = default;
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

void Workspace::clear() {
  candidates.clear();
  intersecting.clear();
  contacts.clear();
  reduced.clear();
  stats = {};
}

namespace {

PairMotion motionOf(const Query& query, const SolidHistory::State& state) {
  PairMotion motion;
  Vec3d approach = query.relativeVelocity;
  if (state.hasPose) {
    const Vec3d moved = motionSince(query, state.pose);
    motion.step = norm(moved);
    if (!(otgDot(approach, approach) > 0)) approach = moved;
  }
  const double speed = norm(approach);
  if (speed > 0) motion.back = otgScale(approach, -1 / speed);
  if (state.escapeLeft > 0) motion.escape = otgRotate(query.bInA, state.escape);
  motion.deepNormal = otgRotate(query.bInA, state.deepNormal);
  return motion;
}

/// Every crossing begins one chord and ends one.
bool isClosed(const Contour& contour, std::vector<std::uint8_t>& ends) {
  if (contour.anomalies > 0) return false;
  ends.assign(contour.crossings.size(), 0);
  for (const Chord& chord : contour.chords) {
    if ((ends[chord.start] & 1) != 0 || (ends[chord.end] & 2) != 0) return false;
    ends[chord.start] |= 1;
    ends[chord.end] |= 2;
  }
  return std::all_of(ends.begin(), ends.end(), [](std::uint8_t e) { return e == 3; });
}

}  // namespace

bool isUnburdened(const SolidHistory::State& before) {
  return before.clampLeft <= 1;
}

Vec3d deepDirectionBefore(const Query& query) {
  return query.history == nullptr ? Vec3d{0, 0, 0} : otgRotate(query.bInA, stateBefore(query).deepNormal);
}

void rememberPlain(const Query& query, const SolidHistory::State& before, bool hasContacts, const Vec3d& deep) {
  if (!query.history || isPairwise(query) || !haveSolidContacts(query.a->mesh(), query.b->mesh())) return;
  SolidHistory::State state = oneQueryLater(before);
  if (otgDot(deep, deep) > 0) state.deepNormal = otgRotateBack(query.bInA, deep);
  if (!hasContacts) state.side = sideBehind(query, state);
  keepState(query, before, state);
  if (!hasContacts) keepDeepest(query, 0);
}

namespace {

/// From the regions of the overlap to contacts, one region after the other; keeps what the pair remembers.
class PairContacts {
 public:
  PairContacts(const Query& query, Workspace& workspace)
      : query_(query),
        workspace_(workspace),
        size_(smallerSize(query)),
        before_(stateBefore(query)),
        state_(oneQueryLater(before_)),
        motion_(motionOf(query, before_)) {
    motion_.isJammed = query.isJammed;
  }

  /// Whether all regions have to be known before the first is added, for the direction in which they leave.
  bool seeksEscape() const { return motion_.isJammed && !(otgDot(motion_.escape, motion_.escape) > 0); }
  void setEscape(const EscapeOfAll& of) { motion_.escape = of.direction(motion_); }

  void add(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
    if (region.diagonal < OTG_SOLID_LEAST_DIAGONAL * size_ ||
        region.areaA + region.areaB < OTG_SOLID_LEAST_AREA * size_ * size_)
      return;
    workspace_.solid->ofRegion.reset();
    RegionNormals normals(all, region);
    RegionExtent extent(all, region);
    const RegionDirection direction = directRegion(meshes, all, region, motion_, normals, extent);
    remember(direction);
    const double extra = direction.escaping ? motion_.step : 0;
    const std::size_t first = workspace_.contacts.size();
    const bool isRefined = query_.refiner && query_.refiner->direct(meshes, all, region, direction, normals);
    const RegionTask task{meshes,
                          all,
                          region,
                          number_++,
                          normals,
                          extent,
                          query_.options.solid.contactsPerRegion,
                          isRefined ? 0 : direction.depth,
                          direction.pierced ? direction.depth : std::numeric_limits<double>::infinity(),
                          extra};
    const bool isUneven = contactsOfRegion(task, workspace_.contacts);
    if (isUneven || region.apart || direction.pierced) ++workspace_.stats.unevenRegions;
    if (query_.refiner) query_.refiner->refine(workspace_.contacts, first);
    if (partRegions_ != nullptr && workspace_.contacts.size() > first) {
      const Vec3d middle = otgAdd(all.origin, otgScale(otgAdd(region.lo, region.hi), 0.5));
      partRegions_->push_back({partPair_, first, workspace_.contacts.size(), middle, region.volume});
    }
  }

  /// Regions from now on are those of a pair of parts.
  void noteRegions(std::vector<PartRegion>& of, std::size_t pair) {
    partRegions_ = &of;
    partPair_ = pair;
  }

  /// A region whose contacts were made elsewhere.
  void add(const otg_found_contacts& region, std::span<const Contact> contacts) {
    if ((region.status & OTG_FOUND_COUNTS) == 0) return;
    RegionDirection direction;
    direction.entangled = (region.status & OTG_FOUND_ENTANGLED) != 0;
    direction.escaping = (region.status & OTG_FOUND_ESCAPING) != 0;
    direction.deep = (region.status & OTG_FOUND_DEEP) != 0;
    direction.direction = {region.direction[0], region.direction[1], region.direction[2]};
    remember(direction);
    for (const Contact& contact : contacts) {
      workspace_.contacts.push_back(contact);
      workspace_.contacts.back().region = number_;
    }
    ++number_;
  }

  void finish() {
    dropHints();
    if (query_.options.solid.regionMerge > 0) {
      mergeRegions(query_.options.solid.regionMerge, query_.options.solid.contactsPerRegion, workspace_.contacts);
    }
    if (entangled_) state_.clampLeft = SolidHistory::kClampQueries;
    if (state_.clampLeft > 0) {
      const double most = std::max(SolidHistory::kClampedDepth * size_, 2 * motion_.step);
      for (Contact& contact : workspace_.contacts) cutDepth(contact, most);
    }
    if (query_.history && isSolidOnPieces(query_)) {
      state_.side = 0;  // the front that contacts of shells left is of another place
    } else if (query_.history && workspace_.contacts.empty()) {
      state_.side = sideBehind(query_, state_);
    }
    keepState(query_, before_, state_);
    workspace_.stats.contactsBeforeReduction = workspace_.contacts.size();
  }

 private:
  /// Where no part of a region has to leave, and its surface gives no direction, its contact is as good as any: better
  /// than none, and worse than those of other regions, which it may contradict.
  void dropHints() {
    const auto isHint = [](const Contact& c) {
      return c.feature == ContactFeature::kNone && c.depth == 0 && c.coherence < OTG_SOLID_COHERENT;
    };
    std::vector<Contact>& contacts = workspace_.contacts;
    if (std::all_of(contacts.begin(), contacts.end(), isHint)) return;
    std::erase_if(contacts, isHint);
  }

  void remember(const RegionDirection& direction) {
    entangled_ = entangled_ || direction.entangled;
    if (direction.escaping && state_.escapeLeft == 0) {
      state_.escape = otgRotateBack(query_.bInA, direction.direction);
      state_.escapeLeft = SolidHistory::kEscapeQueries;
    }
    if (direction.deep) state_.deepNormal = otgRotateBack(query_.bInA, direction.direction);
  }

  const Query& query_;
  Workspace& workspace_;
  const double size_;
  const SolidHistory::State before_;
  SolidHistory::State state_;
  PairMotion motion_;
  bool entangled_ = false;
  std::uint32_t number_ = 0;
  std::vector<PartRegion>* partRegions_ = nullptr;
  std::size_t partPair_ = 0;
};

void addRegions(const PlacedMeshes& meshes, const OverlapRegions& regions, PairContacts& contacts) {
  for (const Region& region : regions.regions) contacts.add(meshes, regions, region);
}

/// The regions of two meshes from their pairs of triangles that meet -> scratch.regions. False where the contour does
/// not close.
bool describe(const PlacedMeshes& meshes, const std::vector<TrianglePair>& meeting, SolidScratch& scratch) {
  scratch.regions.regions.clear();
  traceContour(meshes, meeting, scratch.contour);
  if (!(meshes.isSolid(0) && meshes.isSolid(1)) && !isClosed(scratch.contour, scratch.ends)) return false;
  floodInside(meshes, scratch.contour, scratch.inside);
  if (meeting.empty() && scratch.inside.contained[0].empty() && scratch.inside.contained[1].empty()) return true;
  scratch.builder.build(meshes, scratch.contour, scratch.inside, scratch.regions);
  addContained(meshes, scratch.inside, scratch.regions);
  return true;
}

bool addOverlap(const Query& query, const std::vector<TrianglePair>& meeting, SolidScratch& scratch,
                PairContacts& contacts) {
  const PlacedMeshes meshes(query);
  if (!describe(meshes, meeting, scratch)) return false;
  if (contacts.seeksEscape()) {
    EscapeOfAll escape;
    escape.add(meshes, scratch.regions);
    contacts.setEscape(escape);
  }
  addRegions(meshes, scratch.regions, contacts);
  return true;
}

bool areApart(const PartPair& pair) {
  const Query& query = pair.query;
  return pair.meeting.empty() &&
         areBoxesApart(query.a->mesh(), query.b->mesh(), query.bInA, rotationDefect(query.bInA));
}

bool findEscapeOfParts(const std::vector<PartPair>& pairs, SolidScratch& scratch, PairContacts& contacts) {
  EscapeOfAll escape;
  for (const PartPair& pair : pairs) {
    if (areApart(pair)) continue;
    const PlacedMeshes meshes(pair.query);
    if (!describe(meshes, pair.meeting, scratch)) return false;
    escape.add(meshes, scratch.regions);
  }
  contacts.setEscape(escape);
  return true;
}

bool addOverlapsOfParts(const Query& query, Workspace& workspace, PairContacts& contacts) {
  std::vector<PartPair> pairs = pairsOfParts(query, workspace.intersecting);
  if (contacts.seeksEscape() && !findEscapeOfParts(pairs, *workspace.solid, contacts)) return false;
  std::vector<PartRegion> regions;
  for (PartPair& pair : pairs) {
    pair.begin = pair.end = workspace.contacts.size();
    if (areApart(pair)) continue;
    contacts.noteRegions(regions, static_cast<std::size_t>(&pair - pairs.data()));
    if (!addOverlap(pair.query, pair.meeting, *workspace.solid, contacts)) return false;
    pair.end = workspace.contacts.size();
  }
  numberAsWhole(pairs, workspace.contacts);
  dropWallsInside(pairs, regions, workspace.contacts, scratchAhead(workspace));
  dropCopies(workspace.contacts, smallerSize(query), emptyMemory(workspace));
  return true;
}

}  // namespace

bool solidContacts(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  workspace.contacts.clear();
  if (!haveSolidContacts(query.a->mesh(), query.b->mesh())) return false;
  if (!workspace.solid) workspace.solid = std::make_unique<SolidScratch>();
  PairContacts contacts(query, workspace);
  const bool isClosed = haveParts(query) ? addOverlapsOfParts(query, workspace, contacts)
                                         : addOverlap(query, workspace.intersecting, *workspace.solid, contacts);
  if (!isClosed) {
    workspace.contacts.clear();
    return false;
  }
  contacts.finish();
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  return true;
}

bool haveParts(const Query& query) {
  return query.a->parts() != nullptr || query.b->parts() != nullptr;
}

bool solidContactsOf(const Query& query, const FoundOverlap& found, Workspace& workspace) {
  workspace.contacts.clear();
  if (!workspace.solid) workspace.solid = std::make_unique<SolidScratch>();
  SolidScratch& scratch = *workspace.solid;
  const PlacedMeshes meshes(query);
  if (!takeOverlap(meshes, found, scratch.small, scratch.regions)) return false;
  PairContacts contacts(query, workspace);
  addRegions(meshes, scratch.regions, contacts);
  contacts.finish();
  return true;
}

PairMotion motionBefore(const Query& query) {
  return motionOf(query, stateBefore(query));
}

bool solidContactsOf(const Query& query, const FoundContacts& found, Workspace& workspace) {
  workspace.contacts.clear();
  if (!workspace.solid) workspace.solid = std::make_unique<SolidScratch>();
  SmallRegions& small = workspace.solid->small;
  const otg_overlap_state& state = found.head->state;
  for (std::uint32_t r = 0; r < state.counts[OTG_OVERLAP_LARGE]; ++r) {
    if ((found.head->regions[r].status & (OTG_FOUND_DONE | OTG_FOUND_COUNTS)) == OTG_FOUND_COUNTS) return false;
  }
  const PlacedMeshes meshes(query);
  if (!describeSmall(meshes, state, found.small, small)) return false;
  PairContacts contacts(query, workspace);
  for (const FoundRegion& next : regionsInOrder(state, small)) {
    if (!next.isLarge) {
      contacts.add(meshes, small.regions, small.regions.regions[next.number]);
      continue;
    }
    const otg_found_contacts& region = found.head->regions[next.number];
    contacts.add(region, found.contacts.subspan(region.first, region.count));
  }
  contacts.finish();
  return true;
}

}  // namespace otg
