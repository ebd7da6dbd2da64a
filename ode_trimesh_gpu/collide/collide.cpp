// SPDX-License-Identifier: BSD-3-Clause
// The pipeline on the CPU, stage after stage.
#include <algorithm>

#include "collide/consistent_contacts.h"
#include "collide/contact_order.h"
#include "collide/convex/convex_pair_contacts.h"
#include "collide/convex/convex_parts.h"
#include "collide/pair_history.h"
#include "collide/pairwise/reduction.h"
#include "collide/query.h"
#include "collide/shell/shell_contacts.h"
#include "collide/shell/shell_roles.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "collide/surface/surface_contacts.h"

namespace otg {

void findIntersectingPairs(const Query& query, Workspace& workspace) {
  middlePhase(query, workspace);
  nearPhase(query, workspace);
}

bool isPairwise(const Query& query) {
  return query.options.contacts == ContactModel::kPairwise;
}

namespace {

/// collideIntersecting() of pairs of which neither mesh is taken for a convex body.
void collideAnySolids(const Query& query, Workspace& workspace) {
  if (!areShells(query, workspace.intersecting) && solidContacts(query, workspace)) {
    if (mayMeetAhead(query)) lookAhead(query, workspace);
    finishPair(query, workspace);
  } else {
    shellContacts(query, workspace);
  }
}

void collidePairwise(const Query& query, Workspace& workspace) {
  pairwiseContacts(query, workspace);
  reduceContacts(query, workspace);
}

}  // namespace

void collideIntersecting(const Query& query, Workspace& workspace) {
  if (isPairwise(query)) {
    collidePairwise(query, workspace);
  } else if (!(isConvexPair(query) && convexPairContacts(query, workspace)) && !convexPartContacts(query, workspace) &&
             !surfacePairContacts(query, workspace)) {
    collideAnySolids(query, workspace);
  }
}

bool mayNeedNoTriangles(const Query& query) {
  return isConvexPair(query) || areConvexParts(query) || isSurfacePair(query);
}

bool finishContacts(const Query& query, Workspace& workspace) {
  // In the order in which devices leave them: sums round by it.
  std::sort(workspace.contacts.begin(), workspace.contacts.end(), contactDeeper);
  limitByMotion(query, workspace.contacts);
  const bool isJammed = cutContradictions(query, workspace.contacts);
  limitContacts(workspace.contacts, query.options.maxContacts, workspace.reduced);
  return !isJammed;
}

std::vector<Contact> limitContactsOfCaller(const Query& query, std::span<const Contact> contacts, int count) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  std::vector<Contact> all(contacts.begin(), contacts.end());
  for (Contact& c : all) {
    c.triangleA = a.triangleOfCaller(c.triangleA);
    c.triangleB = b.triangleOfCaller(c.triangleB);
  }
  all = limitContacts(all, count);
  for (Contact& c : all) {
    c.triangleA = a.callerTriangle(c.triangleA);
    c.triangleB = b.callerTriangle(c.triangleB);
  }
  return all;
}

std::vector<TrianglePair> pairsOfCaller(const Query& query, const std::vector<TrianglePair>& pairs) {
  std::vector<TrianglePair> out;
  out.reserve(pairs.size());
  for (const TrianglePair& p : pairs) {
    out.push_back({query.a->mesh().callerTriangle(p.a), query.b->mesh().callerTriangle(p.b)});
  }
  std::sort(out.begin(), out.end());
  return out;
}

void numberAsCaller(const Query& query, Workspace& workspace) {
  for (Contact& contact : workspace.reduced) {
    contact.triangleA = query.a->mesh().callerTriangle(contact.triangleA);
    contact.triangleB = query.b->mesh().callerTriangle(contact.triangleB);
  }
}

void collide(const Query& query, Workspace& workspace) {
  if (!collideConvexPair(query, workspace) && !collideConvexParts(query, workspace) &&
      !collideSurfacePair(query, workspace)) {
    findIntersectingPairs(query, workspace);
    isPairwise(query) ? collidePairwise(query, workspace) : collideAnySolids(query, workspace);
  }
  numberAsCaller(query, workspace);
}

}  // namespace otg
