// SPDX-License-Identifier: BSD-3-Clause
// The pipeline on the host, stage after stage.
#include "collide/query.h"
#include "collide/reduction.h"
#include "collide/solid_contacts.h"

namespace otg {

void findIntersectingPairs(const Query& query, Workspace& workspace) {
  middlePhase(query, workspace);
  nearPhase(query, workspace);
}

void collide(const Query& query, Workspace& workspace) {
  findIntersectingPairs(query, workspace);
  if (query.options.contacts == ContactModel::kSolid && query.a->mesh().meshClass() == MeshClass::kSolid &&
      query.b->mesh().meshClass() == MeshClass::kSolid) {
    solidContacts(query, workspace);
    workspace.reduced = limitContacts(workspace.contacts, query.options.maxContacts);
    return;
  }
  pairwiseContacts(query, workspace);
  reduceContacts(query, workspace);
}

}  // namespace otg
