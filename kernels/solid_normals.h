// SPDX-License-Identifier: BSD-3-Clause
// What is asked of the surface and the points of one region: ways out through planes, normals, extents. As
// collide/solid/region_normals.cpp and surface_kernels_impl.h, with sums in the same order.
//
// OTG_SOLID_CONTACTS: the most contacts of one region; OTG_SOLID_POINTS and OTG_SOLID_FACES: the most points and
// pieces. With OTG_SOLID_LARGE there may be twice as many points, of which so many are left when they are thinned, and
// pieces lie in global memory.
#ifndef OTG_SOLID_NORMALS_H
#define OTG_SOLID_NORMALS_H
#include "solid_mesh.h"

#define OTG_SOLID_MOST_CONTACTS (OTG_SOLID_REGIONS * OTG_SOLID_CONTACTS)
#define OTG_SOLID_DIRECTIONS (1 + 2 * OTG_SOLID_DEEP_FACES + OTG_SOLID_MOST_STRETCHES * OTG_SOLID_MOST_STRETCHES)
#if OTG_SOLID_LARGE
#define OTG_FACES __global
#define OTG_SOLID_MEASURED (OTG_SOLID_MEASURED_PER_CONTACT * OTG_SOLID_CONTACTS)
#else
#define OTG_FACES __local
#define OTG_SOLID_MEASURED OTG_SOLID_CONTACTS
#endif

// The same memory for what is never needed at the same time. By candidate: depth, rank, distance from those chosen,
// place.
#define OTG_DEPTH(s) ((s)->numbers)
#define OTG_RANK(s) ((s)->numbers + OTG_SOLID_POINTS)
#define OTG_SPREAD(s) ((s)->numbers + 2 * OTG_SOLID_POINTS)
#define OTG_X(s) ((s)->numbers + 3 * OTG_SOLID_POINTS)
#define OTG_Y(s) ((s)->numbers + 4 * OTG_SOLID_POINTS)
#define OTG_Z(s) ((s)->numbers + 5 * OTG_SOLID_POINTS)
// Main directions, seven numbers a cluster (first normal, sum, area), and directions that are compared, with the
// region's extents along them. In place of depth, rank and distance.
#define OTG_CLUSTER(s, c) ((s)->numbers + 7 * (c))
#define OTG_DEEP_DIRECTION(s, k) ((s)->numbers + 7 * OTG_SOLID_FACE_CLUSTERS + 3 * (k))
#define OTG_DEEP_EXTENT(s, k) (s)->numbers[7 * OTG_SOLID_FACE_CLUSTERS + 3 * OTG_SOLID_DIRECTIONS + (k)]
#if 3 * OTG_SOLID_POINTS < 7 * OTG_SOLID_FACE_CLUSTERS + 4 * OTG_SOLID_DIRECTIONS
#error "OTG_SOLID_POINTS is too small"
#endif
// By point, while they are thinned: how deep, and cell. In place of the same three.
#define OTG_HINTS(s) ((s)->numbers)
#define OTG_KEYS(s) ((__local uint*)((s)->numbers + 2 * OTG_SOLID_POINTS))
// Of the pair, by contact: as in contact_choose.h. In place of all six.
#define OTG_SPOT(s) ((__local uint2*)(s)->numbers)
#define OTG_NEAREST(s) ((__local uint*)(OTG_SPOT(s) + OTG_SOLID_MOST_CONTACTS))
#define OTG_SORTED(s) ((__local ushort*)(OTG_NEAREST(s) + OTG_SOLID_MOST_CONTACTS))

/// What a work-group knows of the region that it works on, in local memory.
typedef struct {
  double numbers[6 * OTG_SOLID_POINTS];  ///< see OTG_DEPTH and what follows it
  // By candidate: a point, or one of the points that are left.
  int step[OTG_SOLID_POINTS];
  uchar alive[OTG_SOLID_POINTS];
  ushort order[OTG_SOLID_POINTS];  ///< candidates as they are ranked
#if OTG_SOLID_LARGE
  ushort pick[OTG_SOLID_POINTS];  ///< their points
#else
  otg_solid_face face[OTG_SOLID_FACES];  ///< A's, then B's, in the order of the lists
#endif
  ushort list[2][OTG_SOLID_FACES];  ///< pieces of A and of B
  uint listed[2], planes[2], deep[2], listedFaces;
  ushort picked[OTG_SOLID_MEASURED];
  double ways[2 * OTG_SOLID_MEASURED];  ///< out of B and back out of A, by place in the order
  double reduce[OTG_GROUP], sums[8];
  uint4 counts[(OTG_GROUP + 3) / 4];  ///< a word for each lane: OTG_COUNTS
  double weighted[3], shareOfB, highest;
  uint sharp[2][OTG_SOLID_MOST_STRETCHES], sharpCount[2];  ///< middles of sharp convex edges, ascending
  double places[6];  ///< where the two edges come nearest to each other, across which the normal points
  uint pairs, pairOf[OTG_SOLID_MOST_STRETCHES * OTG_SOLID_MOST_STRETCHES], across;
  uint isFlat, corners, bad, count, contacts, allocated;
  uint low[3], high[3], seeds, seen;
} otg_solid_choice;

typedef struct {
  __local otg_solid_choice* s;
  __global const otg_solid_region* region;
  __global otg_solid_piece* pieces;
  __global otg_solid_point* points;
  /// Pieces; planes of ways out, which may stand for several; the same for deep regions. A's, then B's from listed[0].
  OTG_FACES otg_solid_face *faces, *planes, *deep;
  uint pieceCount, pointCount, candidates;
  int isGathered;  ///< planes stand for several pieces
  double diagonal, thickness, coherence, radius;
  otg_vec3_d mean, fixed;
  int isFixed;  ///< `fixed` is the normal everywhere
} otg_solid_work;

/// The larger of a value of each lane and 0. All lanes call it.
OTG_INLINED double otgLargestOf(__local otg_solid_choice* s, double x) {
  double most = 0;
  OTG_SYNC;
  s->reduce[get_local_id(0)] = x;
  OTG_SYNC;
  for (uint k = 0; k < OTG_GROUP; ++k) most = otgMax_d(s->reduce[k], most);
  return most;
}

OTG_INLINED OTG_FACES otg_solid_face* otgFace(const otg_solid_work* w, uint mesh, uint j) {
  return w->faces + (mesh == 0 ? 0 : w->s->listed[0]) + j;
}

/// The point of a candidate.
OTG_INLINED __global otg_solid_point* otgPointOf(const otg_solid_work* w, uint candidate) {
#if OTG_SOLID_LARGE
  return w->points + w->s->pick[candidate];
#else
  return w->points + candidate;
#endif
}

OTG_INLINED otg_vec3_d otgOfFace(OTG_FACES const double* p) {
  return otgVec_d(p[0], p[1], p[2]);
}

OTG_INLINED otg_vec3_d otgOf(__local const double* p) {
  return otgVec_d(p[0], p[1], p[2]);
}

OTG_INLINED double otgSquaredDistance(otg_vec3_d x, otg_vec3_d lo, otg_vec3_d hi) {
  const double dx = otgMax_d(otgMax_d(lo.x - x.x, x.x - hi.x), 0), dy = otgMax_d(otgMax_d(lo.y - x.y, x.y - hi.y), 0);
  const double dz = otgMax_d(otgMax_d(lo.z - x.z, x.z - hi.z), 0);
  return dx * dx + dy * dy + dz * dz;
}

/// Way from a point along a unit direction through the nearest of a mesh's planes that faces along and has its part,
/// enlarged by `slack` (with round corners or not), where it is met; `convex`: through the nearest that faces along.
OTG_INLINED double otgWayOut(OTG_FACES const otg_solid_face* faces, uint count, otg_vec3_d from, otg_vec3_d d,
                             double slack, int isRound, double* convex) {
  double nearest = INFINITY, any = INFINITY;
  for (uint j = 0; j < count; ++j) {
    OTG_FACES const otg_solid_face* p = faces + j;
    const otg_vec3_d n = otgOfFace(p->normal);
    const double cosine = otgDot_d(n, d);
    if (!(cosine > 0.05)) continue;
    const double way = otgMax_d((p->offset - otgDot_d(n, from)) / cosine, 0);
    any = otgMin_d(way, any);
    if (!(way < nearest)) continue;
    const otg_vec3_d x = otgAdd_d(from, otgScale_d(d, way)), lo = otgOfFace(p->lo), hi = otgOfFace(p->hi);
    const int there = isRound ? otgSquaredDistance(x, lo, hi) <= slack * slack
                              : x.x >= lo.x - slack && x.x <= hi.x + slack && x.y >= lo.y - slack &&
                                    x.y <= hi.y + slack && x.z >= lo.z - slack && x.z <= hi.z + slack;
    if (there) nearest = way;
  }
  *convex = any;
  return nearest;
}

/// Nearest if there is one, else convex.
OTG_INLINED double otgPlaneExit(const otg_solid_work* w, uint mesh, otg_vec3_d from, otg_vec3_d d) {
  double convex;
  const double nearest = otgWayOut(w->planes + (mesh == 0 ? 0 : w->s->listed[0]), w->s->planes[mesh], from, d,
                                   OTG_SOLID_PIECE_SLACK * w->diagonal, 0, &convex);
  return isfinite(nearest) ? nearest : convex;
}

/// Of the region's points.
OTG_INLINED double otgExtentAlong(const otg_solid_work* w, otg_vec3_d d) {
  double lo = INFINITY, hi = -INFINITY;
  for (uint i = 0; i < w->pointCount; ++i) {
#if OTG_SOLID_LARGE
    const double at = otgDot_d(otgLoad(w->points[i].position), d);
#else
    const double at = otgDot_d(otgVec_d(OTG_X(w->s)[i], OTG_Y(w->s)[i], OTG_Z(w->s)[i]), d);
#endif
    lo = otgMin_d(at, lo);
    hi = otgMax_d(at, hi);
  }
  return hi - lo;
}

/// Sum of a mesh's weighted areas about a point, in the order of the host: four sums in turn.
OTG_INLINED otg_vec3_d otgAreasAbout(const otg_solid_work* w, uint mesh, otg_vec3_d point, double* area) {
  const double inverse = 1 / (w->radius * w->radius);
  double x[4], y[4], z[4], a[4];
  OTG_ROLLED
  for (uint k = 0; k < 4; ++k) {
    double sx = 0, sy = 0, sz = 0, sa = 0;
    for (uint j = k; j < w->s->listed[mesh]; j += 4) {
      OTG_FACES const otg_solid_face* p = otgFace(w, mesh, j);
      const double d = otgSquaredDistance(point, otgOfFace(p->lo), otgOfFace(p->hi));
      const double near = otgMax_d(1 - d * inverse, 0), weight = near * near;
      sx += p->weighted[0] * weight;
      sy += p->weighted[1] * weight;
      sz += p->weighted[2] * weight;
      sa += p->weightedArea * weight;
    }
    x[k] = sx;
    y[k] = sy;
    z[k] = sz;
    a[k] = sa;
  }
  *area = (a[0] + a[1]) + (a[2] + a[3]);
  return otgVec_d((x[0] + x[1]) + (x[2] + x[3]), (y[0] + y[1]) + (y[2] + y[3]), (z[0] + z[1]) + (z[2] + z[3]));
}

OTG_INLINED otg_vec3_d otgNormalAt(const otg_solid_work* w, otg_vec3_d point) {
  if (w->isFixed) return w->fixed;
  if (w->coherence >= OTG_SOLID_FLAT) return w->mean;
  const int isLump = otgIsLump_d(w->thickness, w->diagonal);
  double areaA, areaB;
  const otg_vec3_d a = otgAreasAbout(w, 0, point, &areaA), b = otgAreasAbout(w, 1, point, &areaB);
  otg_vec3_d n = otgLocalNormal_d(a, areaA, b, areaB, w->s->shareOfB, isLump);
  if (!(otgDot_d(n, n) > 0)) n = w->mean;
  if (w->coherence > OTG_SOLID_CURVED) {
    const double part = (w->coherence - OTG_SOLID_CURVED) / (OTG_SOLID_STRAIGHT - OTG_SOLID_CURVED);
    const double share = part < 1 ? part : 1;
    const otg_vec3_d weighted = otgOf(w->s->weighted);
    n = otgUnit_d(otgAdd_d(otgScale_d(weighted, share), otgScale_d(n, 1 - share)));
  }
  return isLump && otgDot_d(n, w->mean) < -0.2 ? w->mean : n;
}

/// Lists the pieces of either mesh and makes their planes. All lanes call it.
OTG_INLINED void otgListPieces(otg_solid_work* w) {
  __local otg_solid_choice* s = w->s;
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
  if (lane == 0) {
    for (uint m = 0; m < 2; ++m) {
      s->listed[m] = running[m];
      s->planes[m] = running[m];
      s->deep[m] = running[m];
    }
  }
  OTG_SYNC;
  for (uint k = lane; k < s->listed[0] + s->listed[1]; k += OTG_GROUP) {
    const uint mesh = k >= s->listed[0], j = mesh ? k - s->listed[0] : k;
    __global const otg_solid_piece* p = w->pieces + s->list[mesh][j];
    OTG_FACES otg_solid_face* face = w->faces + k;
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
  w->planes = w->deep = w->faces;
  w->candidates = w->pointCount;
  w->isGathered = 0;
#if !OTG_SOLID_LARGE
  for (uint i = lane; i < w->pointCount; i += OTG_GROUP) {
    OTG_X(s)[i] = w->points[i].position[0];
    OTG_Y(s)[i] = w->points[i].position[1];
    OTG_Z(s)[i] = w->points[i].position[2];
  }
#endif
  OTG_SYNC_ALL;
}

/// What each piece says of where out is, by how near the other surface lies behind it. All lanes call it.
OTG_INLINED void otgWeighPieces(const otg_solid_work* w) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0);
  const int weighs = w->thickness > 0 && w->coherence < OTG_SOLID_FLAT;
  const uint faces = s->listed[0] + s->listed[1];
  for (uint k = lane; k < faces; k += OTG_GROUP) {
    OTG_FACES otg_solid_face* face = w->faces + k;
    double weight = 1;
    if (weighs) {
      const otg_vec3_d n = otgOfFace(face->normal);
      const otg_vec3_d middle = otgScale_d(otgAdd_d(otgOfFace(face->lo), otgOfFace(face->hi)), 0.5);
      const otg_vec3_d from = otgAdd_d(middle, otgScale_d(n, face->offset - otgDot_d(n, middle)));
      double convex;
      const uint other = k >= s->listed[0] ? 0 : 1;
      const double nearest = otgWayOut(otgFace(w, other, 0), s->listed[other], from, otgScale_d(n, -1.0),
                                       OTG_SOLID_PIECE_SLACK * w->diagonal, 1, &convex);
      const double way = nearest < w->diagonal ? nearest : w->diagonal < convex ? w->diagonal : convex;
      weight = otgDepthWeight_d(way, w->thickness);
    }
    __global const otg_solid_piece* p = w->pieces + (k >= s->listed[0] ? s->list[1][k - s->listed[0]] : s->list[0][k]);
    // Terms of the sums, for a moment.
    face->weighted[0] = p->vector[0] * weight;
    face->weighted[1] = p->vector[1] * weight;
    face->weighted[2] = p->vector[2] * weight;
    face->weightedArea = weight * p->area;
    OTG_SPREAD(s)[k] = weight;
  }
  OTG_SYNC_ALL;
  for (uint k = lane; k < 8; k += OTG_GROUP) {
    const uint mesh = k < 6 ? k / 3 : k - 6;
    double sum = 0;
    for (uint j = 0; j < s->listed[mesh]; ++j) {
      OTG_FACES const otg_solid_face* face = otgFace(w, mesh, j);
      sum += k < 6 ? face->weighted[k % 3] : face->weightedArea;
    }
    s->sums[k] = sum;
  }
  OTG_SYNC;
  const double cap = w->radius * w->radius;
  for (uint k = lane; k < faces; k += OTG_GROUP) {
    OTG_FACES otg_solid_face* face = w->faces + k;
    const uint mesh = k >= s->listed[0];
    __global const otg_solid_piece* p = w->pieces + (mesh ? s->list[1][k - s->listed[0]] : s->list[0][k]);
    // A large part counts no more than one of the size of the reach.
    const double weight = OTG_SPREAD(s)[k] * (p->area > cap ? cap / p->area : 1.0);
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
