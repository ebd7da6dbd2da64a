// SPDX-License-Identifier: BSD-3-Clause
// The pipeline on the host, stage after stage.
#include "collide/query.h"

namespace otg {

void findIntersectingPairs(const Query& query, Workspace& workspace) {
  middlePhase(query, workspace);
  nearPhase(query, workspace);
}

void collide(const Query& query, Workspace& workspace) {
  findIntersectingPairs(query, workspace);
  pairwiseContacts(query, workspace);
  reduceContacts(query, workspace);
}

}  // namespace otg
