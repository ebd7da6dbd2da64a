// SPDX-License-Identifier: BSD-3-Clause
// Contact model `pairwise`: one contact per intersecting pair of triangles, as published.
#include <chrono>

#include "collide/pairwise/contact_regions.h"
#include "collide/query.h"
#include "collide/stages.h"
#include "shared/contacts/pairwise_contact.h"

namespace otg {

ContactFeature featureOf(int contactKind) {
  switch (contactKind) {
    case OTG_CONTACT_FACE_A:
      return ContactFeature::kFaceA;
    case OTG_CONTACT_FACE_B:
      return ContactFeature::kFaceB;
    default:
      return ContactFeature::kCoplanar;
  }
}

bool contactOfPair(const Query& query, const TrianglePair& pair, Contact& contact) {
  Vec3d a[3], b[3];
  cornersOfA(query.a->mesh(), pair.a, a);
  cornersOfB(query.b->mesh(), query.bInA, pair.b, b);
  const PairContact<double> c = otgPairwiseContact(a, b);
  if (c.kind == OTG_CONTACT_NONE) return false;
  contact = {c.position, c.normal, c.depth, pair.a, pair.b, 0, featureOf(c.kind)};
  return true;
}

void pairwiseContacts(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  workspace.contacts.clear();
  for (const TrianglePair& pair : workspace.intersecting) {
    Contact contact;
    if (contactOfPair(query, pair, contact)) workspace.contacts.push_back(contact);
  }
  assignRegions(query, workspace);
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
}

}  // namespace otg
