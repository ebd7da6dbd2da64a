// SPDX-License-Identifier: BSD-3-Clause
// The surface of one region before its points are looked at: planes of its pieces, and what each piece says of where
// out is. As collide/solid/region_normals.cpp, with sums in the same order.
//
// OTG_SOLID_POINTS and OTG_SOLID_FACES: the most points and pieces. With OTG_SOLID_LARGE there may be twice as many
// points, of which so many are left when they are thinned.
#ifndef OTG_SOLID_NORMALS_H
#define OTG_SOLID_NORMALS_H
#include "solid/region.h"

#define OTG_SOLID_DIRECTIONS (2 + 2 * OTG_SOLID_DEEP_FACES + OTG_SOLID_MOST_STRETCHES * OTG_SOLID_MOST_STRETCHES)

// The same memory for what is never needed at the same time. By piece: how it counts.
#define OTG_WEIGHT(s) ((s)->numbers)
// Main directions, four numbers a cluster (sum, area), and directions that are compared, with the
// region's extents along them and the ways out.
#define OTG_CLUSTER(s, c) ((s)->numbers + 4 * (c))
#define OTG_DEEP_DIRECTION(s, k) ((s)->numbers + 4 * OTG_SOLID_FACE_CLUSTERS + 3 * (k))
#define OTG_DEEP_EXTENT(s, k) (s)->numbers[4 * OTG_SOLID_FACE_CLUSTERS + 3 * OTG_SOLID_DIRECTIONS + (k)]
#define OTG_DEEP_WAY(s, k) (s)->numbers[4 * OTG_SOLID_FACE_CLUSTERS + 4 * OTG_SOLID_DIRECTIONS + (k)]
#define OTG_DEEP_NUMBERS (4 * OTG_SOLID_FACE_CLUSTERS + 5 * OTG_SOLID_DIRECTIONS)
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
  uchar label[OTG_SOLID_FACES];     ///< clusters of these
  double reduce[OTG_GROUP], sums[8];
  uint4 counts[(OTG_GROUP + 3) / 4];  ///< a word for each lane: OTG_COUNTS
  double weighted[3], shareOfB;
  uint convex[2][OTG_SOLID_MOST_STRETCHES];  ///< middles of convex edges, ascending
  uint planes[2], deep[2], listedFaces, first, bad;
  uint pairs, pairOf[OTG_SOLID_MOST_STRETCHES * OTG_SOLID_MOST_STRETCHES];
  uint isFlat, corners, count, allocated;
} otg_solid_ways;

/// The plane of a piece, or of several: of their vector area, and the sum of offsets times its length.
OTG_INLINED void otgSetPlane(__global otg_solid_face* face, otg_vec3_d vector, double offset, otg_vec3_d lo,
                             otg_vec3_d hi) {
  const double length = otgNorm_d(vector);
  otgStore(face->lo, lo);
  otgStore(face->hi, hi);
  otgStore(face->normal, length > 0 ? otgScale_d(vector, 1 / length) : otgVec_d(0, 0, 0));
  face->offset = length > 0 ? offset / length : 0;
}

/// Lists the pieces of either mesh. All lanes call it.
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
}

/// The planes of all pieces, which are listed. All lanes call it.
OTG_INLINED void otgMakePlanes(__local otg_solid_ways* s, otg_solid_work* w) {
  for (uint k = get_local_id(0); k < w->facesOfA + w->facesOfB; k += OTG_GROUP) {
    __global const otg_solid_piece* p = w->pieces + (k >= w->facesOfA ? s->list[1][k - w->facesOfA] : s->list[0][k]);
    __global otg_solid_face* face = w->faces + k;
    const otg_vec3_d vector = otgLoad(p->vector);
    const double length = otgNorm_d(vector);
    otgSetPlane(face, vector, p->offset * length, otgLoad(p->lo), otgLoad(p->hi));
    face->meanOffset = length > 0 ? p->offset * p->area / length : 0;
  }
  w->planes = w->faces;
  w->candidates = w->pointCount;
  w->isGathered = 0;
  OTG_SYNC_ALL;
}

/// Where the way back from a plane begins: on it, in its middle.
OTG_INLINED otg_vec3_d otgMiddleOfPlane(__global const otg_solid_face* face) {
  const otg_vec3_d n = otgLoad(face->normal);
  const otg_vec3_d middle = otgScale_d(otgAdd_d(otgLoad(face->lo), otgLoad(face->hi)), 0.5);
  return otgAdd_d(middle, otgScale_d(n, face->offset - otgDot_d(n, middle)));
}

/// What a piece says of where out is, from the ways back from it.
OTG_INLINED double otgWeightOfWays(const otg_solid_work* w, double nearest, double convex) {
  const double way = nearest < w->diagonal ? nearest : w->diagonal < convex ? w->diagonal : convex;
  return otgDepthWeight_d(way, w->thickness);
}

/// How a face counts for normals, from its own vector and area: a large one counts no more than one of the size of the
/// reach.
OTG_INLINED void otgSetWeighted(const otg_solid_work* w, __global otg_solid_face* face, uint mesh, otg_vec3_d vector,
                                double area, double ownWeight) {
  const double cap = w->radius * w->radius, weight = ownWeight * (area > cap ? cap / area : 1.0);
  otgStore(face->weighted, otgScale_d(vector, mesh == 0 ? -weight : weight));
  face->weightedArea = weight * area;
}

/// What the sums of weighted vectors of A and of B, and of areas, say of the region. By one lane. `weighs`: whether
/// there are weights.
OTG_INLINED void otgSettleSides(__local const double* sums, const otg_solid_work* w, int weighs, __local double* out,
                                __local double* shareOfB, __local uint* isFlat) {
  const otg_vec3_d a = otgVec_d(sums[0], sums[1], sums[2]), b = otgVec_d(sums[3], sums[4], sums[5]);
  const double coherenceA = sums[6] > 0 ? otgNorm_d(a) / sums[6] : 0;
  const double coherenceB = sums[7] > 0 ? otgNorm_d(b) / sums[7] : 0;
  const double coherence = coherenceA < coherenceB ? coherenceB : coherenceA;
  otg_vec3_d weighted = w->mean;
  *shareOfB = 0.5;
  if (weighs) {
    const otg_vec3_d ofA = otgScale_d(otgUnit_d(a), -1.0), ofB = otgUnit_d(b);
    const double share = otgShareOfB_d(ofA, ofB, w->mean, coherenceA, coherenceB);
    const otg_vec3_d chosen = otgUnit_d(otgAdd_d(otgScale_d(ofA, 1 - share), otgScale_d(ofB, share)));
    *shareOfB = share;
    if (otgDot_d(chosen, chosen) > 0) weighted = chosen;
  }
  out[0] = weighted.x;
  out[1] = weighted.y;
  out[2] = weighted.z;
  *isFlat = w->coherence >= OTG_SOLID_FLAT || (weighs && coherence >= OTG_SOLID_CURVED);
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
      double convex;
      const uint other = k >= w->facesOfA ? 0 : 1;
      const double nearest =
          otgWayOut(otgFace(w, other, 0), otgFaceCount(w, other), otgMiddleOfPlane(face),
                    otgScale_d(otgLoad(face->normal), -1.0), OTG_SOLID_PIECE_SLACK * w->diagonal, 1, &convex);
      weight = otgWeightOfWays(w, nearest, convex);
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
      sum += k < 6 ? face->weighted[k % 3] : face->weightedArea;  // unordered: before they are written
    }
    s->sums[k] = sum;
  }
  OTG_SYNC;
  for (uint k = lane; k < faces; k += OTG_GROUP) {
    const uint mesh = k >= w->facesOfA;
    __global const otg_solid_piece* p = w->pieces + (mesh ? s->list[1][k - w->facesOfA] : s->list[0][k]);
    otgSetWeighted(w, w->faces + k, mesh, otgLoad(p->vector), p->area, OTG_WEIGHT(s)[k]);
  }
  if (lane == 0) otgSettleSides(s->sums, w, weighs, s->weighted, &s->shareOfB, &s->isFlat);
  OTG_SYNC_ALL;
}

#endif  // OTG_SOLID_NORMALS_H
