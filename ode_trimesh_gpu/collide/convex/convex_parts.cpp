// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/convex_parts.h"

#include <algorithm>
#include <chrono>

#include "base/vectors.h"
#include "collide/contact_copies.h"
#include "collide/convex/convex_pair_contacts.h"
#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/merge_regions.h"
#include "collide/solid/part_pairs.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"

namespace otg {
namespace {

bool isConvexThroughout(const CollisionMesh& mesh) {
  if (mesh.parts() == nullptr) return mesh.convex() != nullptr;
  return std::all_of(mesh.parts()->meshes.begin(), mesh.parts()->meshes.end(),
                     [](const auto& part) { return part->convex() != nullptr; });
}

/// What two parts have in common, as far as their contacts tell.
PartRegion regionOf(const PartPair& pair, std::size_t number, std::span<const Contact> all) {
  const std::span<const Contact> contacts = all.subspan(pair.begin, pair.end - pair.begin);
  Vec3d low = contacts.front().position, high = low;
  double depth = 0;
  for (const Contact& c : contacts) {
    low = minimum(low, c.position);
    high = maximum(high, c.position);
    depth = std::max(depth, c.depth);
  }
  const Vec3d across = high - low;
  return {number, pair.begin, pair.end, (low + high) * 0.5, depth * (depth * depth + otgDot(across, across))};
}

}  // namespace

bool areConvexParts(const Query& query) {
  return !isPairwise(query) && query.options.solid.convexPath && query.refiner == nullptr && haveParts(query) &&
         isConvexThroughout(*query.a) && isConvexThroughout(*query.b);
}

bool convexPartContacts(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  if (!areConvexParts(query)) return false;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  requireRigid(query.bInA);
  const SolidHistory::State before = stateBefore(query);
  if (!isUnburdened(before)) return false;
  workspace.contacts.clear();
  workspace.reduced.clear();
  Query parts = query;
  parts.history = nullptr;
  std::vector<PartPair> touching;
  std::vector<PartRegion> regions;
  const std::uint32_t countA = countParts(*query.a), countB = countParts(*query.b);
  for (std::uint32_t i = 0; i < countA; ++i) {
    for (std::uint32_t j = 0; j < countB; ++j) {
      PartPair pair = pairOfParts(parts, i, j);
      pair.begin = workspace.contacts.size();
      const ConvexAnswer answer = addConvexContacts(pair.query, workspace);
      if (answer == ConvexAnswer::kOther) return false;
      if (answer == ConvexAnswer::kApart) continue;
      pair.end = workspace.contacts.size();
      const std::span<Contact> own = std::span(workspace.contacts).subspan(pair.begin);
      for (Contact& c : own) c.region = static_cast<std::uint32_t>(touching.size());
      regions.push_back(regionOf(pair, touching.size(), workspace.contacts));
      touching.push_back(std::move(pair));
    }
  }
  numberAsWhole(touching, workspace.contacts);
  dropWallsInside(touching, regions, workspace.contacts, scratchAhead(workspace));
  dropCopies(workspace.contacts, smallerSize(query), emptyMemory(workspace));
  if (query.options.solid.regionMerge > 0) {
    mergeRegions(query.options.solid.regionMerge, query.options.solid.contactsPerRegion, workspace.contacts);
  }
  rememberPlain(query, before, !touching.empty(), {0, 0, 0});
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  if (mayMeetAhead(query)) lookAhead(query, workspace);
  return finishContacts(query, workspace);
}

bool collideConvexParts(const Query& query, Workspace& workspace) {
  if (!areConvexParts(query)) return false;
  workspace.clear();
  return convexPartContacts(query, workspace);
}

}  // namespace otg
