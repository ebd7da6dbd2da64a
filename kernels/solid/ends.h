// SPDX-License-Identifier: BSD-3-Clause
// What is found of one pair of triangles of two solids, exactly, beside whether they meet: where their chord ends; as
// collide/solid/contour.cpp.
#ifndef OTG_SOLID_ENDS_H
#define OTG_SOLID_ENDS_H
#include "pairwise/exact_decision.h"
#include "solid/mesh.h"
//
#include "shared/tests/sos.h"

/// Does the line of edge k of one triangle pass through the other?
OTG_INLINED int otgPasses(const otg_vec3_d* corners, uint mesh, uint k) {
  int sum = 0;
  OTG_ROLLED
  for (uint l = 0; l < 3; ++l) {
    const uint i = mesh == 0 ? k : l, j = mesh == 0 ? l : k;
    const int sign =
        otgSosEdges(&corners[i].x, &corners[(i + 1) % 3].x, &corners[3 + j].x, &corners[3 + (j + 1) % 3].x);
    sum += sign < 0 ? -1 : 1;
  }
  return sum == 3 || sum == -3;
}

/// The ends of a hit's chord, in the order in which the CPU finds them. Returns OTG_SOLID_*, or 0.
OTG_INLINED uint otgFindEnds(OTG_MESH* meshA, OTG_MESH* meshB, otg_solid_hit* hit) {
  otg_vec3_d corners[6];
  int side[6], closed = 0;
  uint found = 0, starts = 0;
  hit->halfEdge[0] = hit->halfEdge[1] = OTG_NOT_THERE;
  hit->how[0] = hit->how[1] = 0;
  otgCornersAt(meshA, hit->a, corners);
  otgCornersAt(meshB, hit->b, corners + 3);
  if (!otgIsExactHere(corners)) return OTG_SOLID_INEXACT;
  OTG_ROLLED
  for (uint i = 0; i < 6; ++i) {
    side[i] = i < 3 ? otgSosSideOfA(&corners[3].x, &corners[4].x, &corners[5].x, &corners[i].x)
                    : otgSosSideOfB(&corners[0].x, &corners[1].x, &corners[2].x, &corners[i].x);
  }
  for (uint mesh = 0; mesh < 2; ++mesh) {
    closed |= side[3 * mesh] == side[3 * mesh + 1] && side[3 * mesh + 1] == side[3 * mesh + 2];
  }
  if (closed) return 0;
  OTG_ROLLED
  for (uint item = 0; item < 6; ++item) {
    const uint k = item / 2, mesh = item % 2;
    const int from = side[3 * mesh + k], to = side[3 * mesh + (k + 1) % 3];
    if (from == to || !otgPasses(corners, mesh, k)) continue;
    const int exits = to > 0, isStart = mesh == 0 ? exits : !exits;
    if (found < 2) {
      hit->halfEdge[found] = (3 * (mesh == 0 ? hit->a : hit->b) + k) << 1 | mesh;
      hit->how[found] = (uint)(exits | isStart << 1);
    }
    ++found;
    starts += isStart;
  }
  return found == 0 || (found == 2 && starts == 1) ? 0 : OTG_SOLID_BROKEN;
}

#endif  // OTG_SOLID_ENDS_H
