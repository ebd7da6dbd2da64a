// SPDX-License-Identifier: BSD-3-Clause
// What is computed of the surface and the points of one region: ways out through planes, normals, extents. As
// collide/solid/region_normals.cpp and surface_kernels_impl.h, with sums in the same order.
#ifndef OTG_SOLID_REGION_H
#define OTG_SOLID_REGION_H
#include "solid/mesh.h"

/// Faces by which one vertex of an uneven region leaves together, at most: a power of two.
#define OTG_UNEVEN_EXITS 8

/// A region as the kernels after solidRegions see it.
typedef struct {
  __global otg_solid_region* region;
  __global otg_solid_piece* pieces;
  __global otg_solid_point* points;
  /// Pieces, and planes of ways out, which may stand for several. A's, then B's from facesOfA on.
  __global otg_solid_face *faces, *planes;
  __global ushort* picks;  ///< the points that are candidates; null: all
  uint pieceCount, pointCount, candidates, facesOfA, facesOfB, planesOfA, planesOfB;
  int isGathered, isFlat, isFixed, isUneven;
  double diagonal, thickness, coherence, radius, shareOfB, leastDepth;
  otg_vec3_d lo;                     ///< of its bounds
  otg_vec3_d mean, weighted, fixed;  ///< `fixed`: the normal everywhere if isFixed
  otg_vec3_d fallback;               ///< where the surfaces do not say where out is
} otg_solid_work;

/// What solidRegions knows of the region at a place in the arena.
OTG_INLINED otg_solid_work otgWorkOn(__global uchar* arena, uint place) {
  otg_solid_work w;
  w.region = (__global otg_solid_region*)(arena + (size_t)place * OTG_ARENA_UNIT);
  w.pieces = (__global otg_solid_piece*)(arena + (size_t)w.region->pieces * OTG_ARENA_UNIT);
  w.points = (__global otg_solid_point*)(arena + (size_t)w.region->points * OTG_ARENA_UNIT);
  w.pieceCount = w.region->pieceCount;
  w.pointCount = w.region->pointCount;
  w.diagonal = w.region->diagonal;
  w.thickness = w.region->thickness;
  w.coherence = w.region->coherence;
  w.lo = otgLoad(w.region->lo);
  w.mean = otgUnit_d(otgLoad(w.region->push));
  w.fallback = w.fixed = w.mean;
  w.isFixed = 0;
  w.leastDepth = 0;
  w.radius = otgNormalReach_d(w.region->areaA + w.region->areaB, w.thickness);
  return w;
}

/// The same, and what solidWays adds.
OTG_INLINED otg_solid_work otgGoOnWith(__global uchar* arena, uint place) {
  otg_solid_work w = otgWorkOn(arena, place);
  const uint flags = w.region->flags, picks = w.region->picks;
  w.faces = (__global otg_solid_face*)(arena + (size_t)w.region->faces * OTG_ARENA_UNIT);
  w.planes = (__global otg_solid_face*)(arena + (size_t)w.region->planes * OTG_ARENA_UNIT);
  w.picks = picks == OTG_NOT_THERE ? 0 : (__global ushort*)(arena + (size_t)picks * OTG_ARENA_UNIT);
  w.candidates = w.region->candidates;
  w.facesOfA = w.region->faceCount[0];
  w.facesOfB = w.region->faceCount[1];
  w.planesOfA = w.region->planeCount[0];
  w.planesOfB = w.region->planeCount[1];
  w.isGathered = (flags & OTG_REGION_GATHERED) != 0;
  w.isFlat = (flags & OTG_REGION_FLAT) != 0;
  w.isFixed = (flags & OTG_REGION_FIXED) != 0;
  w.isUneven = (flags & OTG_REGION_UNEVEN) != 0;
  w.shareOfB = w.region->shareOfB;
  w.leastDepth = w.region->leastDepth;
  w.weighted = otgLoad(w.region->weighted);
  w.fixed = otgLoad(w.region->fixed);
  return w;
}

OTG_INLINED uint otgFaceCount(const otg_solid_work* w, uint mesh) {
  return mesh == 0 ? w->facesOfA : w->facesOfB;
}

OTG_INLINED __global otg_solid_face* otgFace(const otg_solid_work* w, uint mesh, uint j) {
  return w->faces + (mesh == 0 ? 0 : w->facesOfA) + j;
}

/// The point of a candidate.
OTG_INLINED __global otg_solid_point* otgPointOf(const otg_solid_work* w, uint candidate) {
  return w->points + (w->picks ? w->picks[candidate] : candidate);
}

OTG_INLINED double otgSquaredDistance(otg_vec3_d x, otg_vec3_d lo, otg_vec3_d hi) {
  const double dx = otgMax_d(otgMax_d(lo.x - x.x, x.x - hi.x), 0), dy = otgMax_d(otgMax_d(lo.y - x.y, x.y - hi.y), 0);
  const double dz = otgMax_d(otgMax_d(lo.z - x.z, x.z - hi.z), 0);
  return dx * dx + dy * dy + dz * dz;
}

/// Way from a point along a unit direction through the nearest of a mesh's planes that faces along. The plane's part,
/// enlarged by `slack` (with round corners or not), must hold the place where it is met; `convex`: through the nearest
/// that faces along.
OTG_INLINED double otgWayOut(__global const otg_solid_face* faces, uint count, otg_vec3_d from, otg_vec3_d d,
                             double slack, int isRound, double* convex) {
  double nearest = INFINITY, any = INFINITY;
  // Without branches, so that one plane does not wait for the one before.
  OTG_UNROLLED(2)
  for (uint j = 0; j < count; ++j) {
    __global const otg_solid_face* p = faces + j;
    const otg_vec3_d n = otgLoad(p->normal), lo = otgLoad(p->lo), hi = otgLoad(p->hi);
    const double cosine = otgDot_d(n, d);
    const int isAhead = cosine > 0.05;
    const double way = otgMax_d((p->offset - otgDot_d(n, from)) / (isAhead ? cosine : 1.0), 0);
    const otg_vec3_d x = otgAdd_d(from, otgScale_d(d, way));
    const int there = isRound ? otgSquaredDistance(x, lo, hi) <= slack * slack
                              : (x.x >= lo.x - slack) & (x.x <= hi.x + slack) & (x.y >= lo.y - slack) &
                                    (x.y <= hi.y + slack) & (x.z >= lo.z - slack) & (x.z <= hi.z + slack);
    any = isAhead & (way < any) ? way : any;
    nearest = isAhead & there & (way < nearest) ? way : nearest;
  }
  *convex = any;
  return nearest;
}

/// Nearest if there is one, else convex.
OTG_INLINED double otgPlaneExit(const otg_solid_work* w, uint mesh, otg_vec3_d from, otg_vec3_d d) {
  double convex;
  const double nearest = otgWayOut(w->planes + (mesh == 0 ? 0 : w->facesOfA), mesh == 0 ? w->planesOfA : w->planesOfB,
                                   from, d, OTG_SOLID_PIECE_SLACK * w->diagonal, 0, &convex);
  return isfinite(nearest) ? nearest : convex;
}

/// Of the region's points.
OTG_INLINED double otgExtentAlong(const otg_solid_work* w, otg_vec3_d d) {
  double lo = INFINITY, hi = -INFINITY;
  for (uint i = 0; i < w->pointCount; ++i) {
    const double at = otgDot_d(otgLoad(w->points[i].position), d);
    lo = otgMin_d(at, lo);
    hi = otgMax_d(at, hi);
  }
  return hi - lo;
}

/// Adds what a face says of the normal at a point: vector and area.
OTG_INLINED void otgAddArea(__global const otg_solid_face* p, int isThere, otg_vec3_d point, double inverse, double* x,
                            double* y, double* z, double* a) {
  const double d = otgSquaredDistance(point, otgLoad(p->lo), otgLoad(p->hi));
  const double near = isThere ? otgMax_d(1 - d * inverse, 0) : 0, weight = near * near;
  *x += p->weighted[0] * weight;
  *y += p->weighted[1] * weight;
  *z += p->weighted[2] * weight;
  *a += p->weightedArea * weight;
}

/// Sum of a mesh's weighted areas about a point, in the order of the CPU: four sums in turn.
OTG_INLINED otg_vec3_d otgAreasAbout(const otg_solid_work* w, uint mesh, otg_vec3_d point, double* area) {
  const double inverse = 1 / (w->radius * w->radius);
  const uint count = otgFaceCount(w, mesh);
  double x[4] = {0, 0, 0, 0}, y[4] = {0, 0, 0, 0}, z[4] = {0, 0, 0, 0}, a[4] = {0, 0, 0, 0};
  OTG_ROLLED
  for (uint base = 0; base < count; base += 4) {
    OTG_UNROLLED(4)
    for (uint k = 0; k < 4; ++k) {
      const int isThere = base + k < count;
      otgAddArea(otgFace(w, mesh, isThere ? base + k : base), isThere, point, inverse, x + k, y + k, z + k, a + k);
    }
  }
  *area = (a[0] + a[1]) + (a[2] + a[3]);
  return otgVec_d((x[0] + x[1]) + (x[2] + x[3]), (y[0] + y[1]) + (y[2] + y[3]), (z[0] + z[1]) + (z[2] + z[3]));
}

/// Where not all of a region has one normal: that of a point from the areas about it.
OTG_INLINED otg_vec3_d otgNormalOfAreas(const otg_solid_work* w, otg_vec3_d a, double areaA, otg_vec3_d b,
                                        double areaB) {
  const int isLump = otgIsLump_d(w->thickness, w->diagonal);
  otg_vec3_d n = otgLocalNormal_d(a, areaA, b, areaB, w->shareOfB, isLump);
  if (!(otgDot_d(n, n) > 0)) n = w->fallback;
  if (w->coherence > OTG_SOLID_CURVED) {
    const double part = (w->coherence - OTG_SOLID_CURVED) / (OTG_SOLID_STRAIGHT - OTG_SOLID_CURVED);
    const double share = part < 1 ? part : 1;
    const otg_vec3_d weighted = w->weighted;
    n = otgUnit_d(otgAdd_d(otgScale_d(weighted, share), otgScale_d(n, 1 - share)));
  }
  return isLump && w->coherence >= OTG_SOLID_COHERENT && otgDot_d(n, w->mean) < -0.2 ? w->mean : n;
}

OTG_INLINED otg_vec3_d otgNormalAt(const otg_solid_work* w, otg_vec3_d point) {
  if (w->isFixed) return w->fixed;
  if (w->coherence >= OTG_SOLID_FLAT) return w->mean;
  double areaA, areaB;
  const otg_vec3_d a = otgAreasAbout(w, 0, point, &areaA), b = otgAreasAbout(w, 1, point, &areaB);
  return otgNormalOfAreas(w, a, areaA, b, areaB);
}

/// Larger for a point that lies deeper in the other mesh as far as the region's mean direction can show.
OTG_INLINED double otgDepthHint(const otg_solid_work* w, uint mesh, otg_vec3_d position) {
  return (mesh == 0 ? -1 : 1) * otgDot_d(w->mean, position);
}

/// Clamps both ways and their sum, which is returned, to the region's extent along the normal.
OTG_INLINED double otgClampWays(double limit, double* out, double* back) {
  *out = otgMin_d(limit, *out);
  *back = otgMin_d(limit, *back);
  return otgMin_d(limit, *out + *back);
}

/// The depth of the overlap at a point along a normal, by the planes, and both parts of it.
OTG_INLINED double otgDepthByPlanes(const otg_solid_work* w, otg_vec3_d at, otg_vec3_d normal, double limit,
                                    double* out, double* back) {
  OTG_ROLLED
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const double way = otgPlaneExit(w, mesh, at, otgScale_d(normal, mesh == 0 ? -1.0 : 1.0));
    if (mesh == 0) {
      *back = way;
    } else {
      *out = way;
    }
  }
  return otgClampWays(limit, out, back);
}

#endif  // OTG_SOLID_REGION_H
