// SPDX-License-Identifier: BSD-3-Clause
// Solids that have come so deep into each other that their contacts contradict each other, as in a fall that no time
// step resolves. Contacts without depth would hold them where they are, for good.
#include <algorithm>
#include <iterator>
#include <vector>

#include "base/vectors.h"
#include "collide/consistent_contacts.h"
#include "collide/contact_order.h"
#include "collide/pair_history.h"
#include "collide/pairwise/reduction.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"

namespace otg {
namespace {

/// Cosine from which on a contact does not oppose a direction: what is square to it may tremble.
constexpr double kSquare = -0.05;

/// The deepest contact of each region.
std::vector<double> deepestByRegion(const std::vector<Contact>& contacts, std::size_t regions) {
  std::vector<double> deepest(regions, 0);
  for (const Contact& c : contacts) deepest[c.region] = std::max(deepest[c.region], c.depth);
  return deepest;
}

/// Contacts of all regions along one direction, by which the pair leaves -> workspace.contacts. False without any.
bool makeLeaving(const Query& query, Workspace& workspace) {
  Query jammed = query;
  jammed.isJammed = true;
  if (workspace.intersecting.empty()) findIntersectingPairs(jammed, workspace);  // a device had them
  workspace.stats.unevenRegions = 0;
  return solidContacts(jammed, workspace) && !workspace.contacts.empty();
}

/// Which regions hold the pair: deep ones, and others whose contacts oppose the direction in which it leaves, or lose
/// their depth. `all` contacts of the pair, and `kept` of them after contradictions are cut. Deep is from `deep` on.
std::vector<std::uint8_t> heldRegions(const std::vector<Contact>& all, const std::vector<Contact>& kept,
                                      const std::vector<Contact>& leaving, double deep) {
  std::size_t regions = 0;
  for (const auto* list : {&all, &leaving}) {
    for (const Contact& c : *list) regions = std::max<std::size_t>(regions, c.region + 1);
  }
  const std::vector<double> was = deepestByRegion(all, regions), is = deepestByRegion(kept, regions);
  std::vector<std::uint8_t> isHeld(regions, 0);
  for (const Contact& c : all) {
    const bool opposes = otgDot(c.normal, leaving.front().normal) < kSquare;
    if (opposes || was[c.region] >= deep || is[c.region] < was[c.region]) isHeld[c.region] = 1;
  }
  return isHeld;
}

}  // namespace

void finishPair(const Query& query, Workspace& workspace) {
  if (!isSolid(query.a->mesh()) || !isSolid(query.b->mesh())) {
    finishContacts(query, workspace);
    return;
  }
  const bool wasJammed = query.history != nullptr && stateBefore(query).isJammed;
  if (wasJammed) query.history->current.isJammed = false;
  std::vector<Contact>& contacts = workspace.contacts;
  std::sort(contacts.begin(), contacts.end(), contactDeeper);
  if (!wasJammed && !contradict(contacts, smallerRadius(query))) {
    limitContacts(contacts, query.options.maxContacts, workspace.reduced);
    return;
  }
  std::vector<Contact> all = contacts;
  const bool isFree = finishContacts(query, workspace);
  if (contacts.empty() || (isFree && !wasJammed)) return;
  const std::vector<Contact> kept = contacts, reduced = workspace.reduced;
  if (!makeLeaving(query, workspace)) {
    contacts = kept;
    workspace.reduced = reduced;
    return;
  }
  const std::vector<Contact> leaving = contacts;
  const double most = SolidHistory::kClampedDepth * smallerSize(query);
  const std::vector<std::uint8_t> isHeld = heldRegions(all, kept, leaving, most);
  const auto take = [&](const std::vector<Contact>& from, bool held) {
    std::copy_if(from.begin(), from.end(), std::back_inserter(contacts),
                 [&](const Contact& c) { return (isHeld[c.region] != 0) == held; });
  };
  contacts.clear();
  take(leaving, true);
  const bool isDeepStill = isDeep(query, contacts);
  if (query.history != nullptr) query.history->current.isJammed = isDeepStill;
  take(all, false);
  if (finishContacts(query, workspace)) return;
  contacts = leaving;  // nothing else lets it go
  finishContacts(query, workspace);
}

}  // namespace otg
