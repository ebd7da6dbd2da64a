// SPDX-License-Identifier: BSD-3-Clause
// The surface of one region before its points are looked at: planes of its pieces, and what each piece says of where
// out is. As collide/solid/region_normals.cpp, with sums in the same order.
//
// OTG_SOLID_POINTS and OTG_SOLID_FACES: the most points and pieces. With OTG_SOLID_LARGE there may be twice as many
// points, of which so many are left when they are thinned.
#ifndef OTG_SOLID_NORMALS_H
#define OTG_SOLID_NORMALS_H
#include "solid_region.h"

#define OTG_SOLID_DIRECTIONS (1 + 2 * OTG_SOLID_DEEP_FACES + OTG_SOLID_MOST_STRETCHES * OTG_SOLID_MOST_STRETCHES)

// The same memory for what is never needed at the same time. By piece: how it counts.
#define OTG_WEIGHT(s) ((s)->numbers)
// Main directions, seven numbers a cluster (first normal, sum, area), and directions that are compared, with the
// region's extents along them and the ways out.
#define OTG_CLUSTER(s, c) ((s)->numbers + 7 * (c))
#define OTG_DEEP_DIRECTION(s, k) ((s)->numbers + 7 * OTG_SOLID_FACE_CLUSTERS + 3 * (k))
#define OTG_DEEP_EXTENT(s, k) (s)->numbers[7 * OTG_SOLID_FACE_CLUSTERS + 3 * OTG_SOLID_DIRECTIONS + (k)]
#define OTG_DEEP_WAY(s, k) (s)->numbers[7 * OTG_SOLID_FACE_CLUSTERS + 4 * OTG_SOLID_DIRECTIONS + (k)]
#define OTG_DEEP_NUMBERS (7 * OTG_SOLID_FACE_CLUSTERS + 5 * OTG_SOLID_DIRECTIONS)
#if OTG_SOLID_LARGE
// By point, while they are thinned: how deep, and cell.
#define OTG_HINTS(s) ((s)->numbers)
#define OTG_KEYS(s) ((__local uint*)((s)->numbers + 2 * OTG_SOLID_POINTS))
#define OTG_WAY_NUMBERS (3 * OTG_SOLID_POINTS)
#else
#define OTG_WAY_NUMBERS (OTG_DEEP_NUMBERS > OTG_SOLID_FACES ? OTG_DEEP_NUMBERS : OTG_SOLID_FACES)
#endif
#if OTG_SOLID_LARGE && (OTG_WAY_NUMBERS < OTG_DEEP_NUMBERS || OTG_WAY_NUMBERS < OTG_SOLID_FACES)
#error "OTG_SOLID_POINTS is too small"
#endif

/// What a work-group knows of the region that it works on, in local memory.
typedef struct {
  double numbers[OTG_WAY_NUMBERS];  ///< see OTG_WEIGHT and what follows it
#if OTG_SOLID_LARGE
  uint keys[OTG_SOLID_FACES];
#endif
  ushort list[2][OTG_SOLID_FACES];  ///< pieces of A and of B
  ushort order[OTG_SOLID_FACES];    ///< A's by area, then B's
  double reduce[OTG_GROUP], sums[8];
  uint4 counts[(OTG_GROUP + 3) / 4];  ///< a word for each lane: OTG_COUNTS
  double weighted[3], shareOfB;
  uint sharp[2][OTG_SOLID_MOST_STRETCHES];  ///< middles of sharp convex edges, ascending
  uint planes[2], deep[2], listedFaces, bad;
  uint pairs, pairOf[OTG_SOLID_MOST_STRETCHES * OTG_SOLID_MOST_STRETCHES], across;
  uint isFlat, corners, count, allocated;
} otg_solid_ways;

/// Lists the pieces of either mesh and makes their planes. All lanes call it.
OTG_INLINED void otgListPieces(__local otg_solid_ways* s, otg_solid_work* w) {
  const uint lane = get_local_id(0);
  uint running[2], total;
  running[0] = running[1] = 0;
  for (uint base = 0; base < w->pieceCount; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isThere = i < w->pieceCount;
    const uint mesh = isThere ? w->pieces[i].mesh : 2;
    for (uint m = 0; m < 2; ++m) {
      const uint place = running[m] + otgPlaceAmong(OTG_COUNTS(s), mesh == m, &total);
      if (mesh == m) s->list[m][place] = (ushort)i;
      running[m] += total;
    }
  }
  w->facesOfA = w->planesOfA = running[0];
  w->facesOfB = w->planesOfB = running[1];
  OTG_SYNC;
  for (uint k = lane; k < running[0] + running[1]; k += OTG_GROUP) {
    const uint mesh = k >= running[0], j = mesh ? k - running[0] : k;
    __global const otg_solid_piece* p = w->pieces + s->list[mesh][j];
    __global otg_solid_face* face = w->faces + k;
    const otg_vec3_d vector = otgLoad(p->vector);
    const double length = otgNorm_d(vector), offset = p->offset * length;
    for (int c = 0; c < 3; ++c) {
      face->lo[c] = p->lo[c];
      face->hi[c] = p->hi[c];
    }
    const otg_vec3_d n = length > 0 ? otgScale_d(vector, 1 / length) : otgVec_d(0, 0, 0);
    face->normal[0] = n.x;
    face->normal[1] = n.y;
    face->normal[2] = n.z;
    face->offset = length > 0 ? offset / length : 0;
    face->meanOffset = length > 0 ? p->offset * p->area / length : 0;
  }
  w->planes = w->faces;
  w->candidates = w->pointCount;
  w->isGathered = 0;
  OTG_SYNC_ALL;
}

/// What each piece says of where out is, by how near the other surface lies behind it. All lanes call it.
OTG_INLINED void otgWeighPieces(__local otg_solid_ways* s, const otg_solid_work* w) {
  const uint lane = get_local_id(0);
  const int weighs = w->thickness > 0 && w->coherence < OTG_SOLID_FLAT;
  const uint faces = w->facesOfA + w->facesOfB;
  for (uint k = lane; k < faces; k += OTG_GROUP) {
    __global otg_solid_face* face = w->faces + k;
    double weight = 1;
    if (weighs) {
      const otg_vec3_d n = otgLoad(face->normal);
      const otg_vec3_d middle = otgScale_d(otgAdd_d(otgLoad(face->lo), otgLoad(face->hi)), 0.5);
      const otg_vec3_d from = otgAdd_d(middle, otgScale_d(n, face->offset - otgDot_d(n, middle)));
      double convex;
      const uint other = k >= w->facesOfA ? 0 : 1;
      const double nearest = otgWayOut(otgFace(w, other, 0), otgFaceCount(w, other), from, otgScale_d(n, -1.0),
                                       OTG_SOLID_PIECE_SLACK * w->diagonal, 1, &convex);
      const double way = nearest < w->diagonal ? nearest : w->diagonal < convex ? w->diagonal : convex;
      weight = otgDepthWeight_d(way, w->thickness);
    }
    __global const otg_solid_piece* p = w->pieces + (k >= w->facesOfA ? s->list[1][k - w->facesOfA] : s->list[0][k]);
    // Terms of the sums, for a moment.
    face->weighted[0] = p->vector[0] * weight;
    face->weighted[1] = p->vector[1] * weight;
    face->weighted[2] = p->vector[2] * weight;
    face->weightedArea = weight * p->area;
    OTG_WEIGHT(s)[k] = weight;
  }
  OTG_SYNC_ALL;
  for (uint k = lane; k < 8; k += OTG_GROUP) {
    const uint mesh = k < 6 ? k / 3 : k - 6;
    double sum = 0;
    OTG_UNROLLED(4)
    for (uint j = 0; j < otgFaceCount(w, mesh); ++j) {
      __global const otg_solid_face* face = otgFace(w, mesh, j);
      sum += k < 6 ? face->weighted[k % 3] : face->weightedArea;
    }
    s->sums[k] = sum;
  }
  OTG_SYNC;
  const double cap = w->radius * w->radius;
  for (uint k = lane; k < faces; k += OTG_GROUP) {
    __global otg_solid_face* face = w->faces + k;
    const uint mesh = k >= w->facesOfA;
    __global const otg_solid_piece* p = w->pieces + (mesh ? s->list[1][k - w->facesOfA] : s->list[0][k]);
    // A large part counts no more than one of the size of the reach.
    const double weight = OTG_WEIGHT(s)[k] * (p->area > cap ? cap / p->area : 1.0);
    const otg_vec3_d weighted = otgScale_d(otgLoad(p->vector), mesh == 0 ? -weight : weight);
    face->weighted[0] = weighted.x;
    face->weighted[1] = weighted.y;
    face->weighted[2] = weighted.z;
    face->weightedArea = weight * p->area;
  }
  if (lane == 0) {
    const otg_vec3_d a = otgVec_d(s->sums[0], s->sums[1], s->sums[2]), b = otgVec_d(s->sums[3], s->sums[4], s->sums[5]);
    const double coherenceA = s->sums[6] > 0 ? otgNorm_d(a) / s->sums[6] : 0;
    const double coherenceB = s->sums[7] > 0 ? otgNorm_d(b) / s->sums[7] : 0;
    const double coherence = coherenceA < coherenceB ? coherenceB : coherenceA;
    otg_vec3_d weighted = w->mean;
    s->shareOfB = 0.5;
    if (weighs) {
      const otg_vec3_d ofA = otgScale_d(otgUnit_d(a), -1.0), ofB = otgUnit_d(b);
      const double share = otgShareOfB_d(ofA, ofB, w->mean, coherenceA, coherenceB);
      const otg_vec3_d chosen = otgUnit_d(otgAdd_d(otgScale_d(ofA, 1 - share), otgScale_d(ofB, share)));
      s->shareOfB = share;
      if (otgDot_d(chosen, chosen) > 0) weighted = chosen;
    }
    s->weighted[0] = weighted.x;
    s->weighted[1] = weighted.y;
    s->weighted[2] = weighted.z;
    s->isFlat = w->coherence >= OTG_SOLID_FLAT || (weighs && coherence >= OTG_SOLID_CURVED);
  }
  OTG_SYNC_ALL;
}

#endif  // OTG_SOLID_NORMALS_H
