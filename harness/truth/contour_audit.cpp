// SPDX-License-Identifier: BSD-3-Clause
#include "truth/contour_audit.h"

#include <vector>

#include "collide/query.h"
#include "collide/solid/contour.h"
#include "collide/solid/inside.h"
#include "collide/solid/regions.h"
#include "collide/solid/solid_contacts.h"

namespace otg::truth {

ContourAudit auditContour(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = bInA;
  Workspace workspace;
  findIntersectingPairs(query, workspace);
  const PlacedMeshes meshes(query);
  Contour contour;
  traceContour(meshes, workspace.intersecting, contour);

  ContourAudit audit;
  audit.crossings = contour.crossings.size();
  std::vector<int> starts(contour.crossings.size(), 0), ends(contour.crossings.size(), 0);
  for (const Chord& chord : contour.chords) {
    ++starts[chord.start];
    ++ends[chord.end];
  }
  for (std::size_t i = 0; i < contour.crossings.size(); ++i) {
    if (starts[i] == 1 && ends[i] == 1) continue;
    ++audit.openEnds;
    const Crossing& c = contour.crossings[i];
    const std::uint32_t half = meshes.adjacency(c.mesh).halfEdgeOf[c.edge];
    if (meshes.mesh(c.mesh).topology().twin[half] == kNone) ++audit.openOnRims;
  }
  audit.anomalies = contour.anomalies;
  audit.fallsBack = !solidContacts(query, workspace);
  audit.contacts = workspace.contacts.size();
  // What follows is only defined behind a closed contour.
  if (audit.openEnds > 0) return audit;
  InsideFlags inside;
  floodInside(meshes, contour, inside);
  OverlapRegions regions;
  RegionBuilder builder;
  builder.build(meshes, contour, inside, regions);
  audit.anomalies += inside.anomalies + regions.anomalies;
  audit.regions = regions.regions.size();
  for (const Region& region : regions.regions) audit.badRegions += region.bad;
  return audit;
}

}  // namespace otg::truth
