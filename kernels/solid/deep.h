// SPDX-License-Identifier: BSD-3-Clause
// The way out of a deep region: the shortest among the push, the last one and the main face directions; as directRegion
// in collide/solid/escape.cpp, where no region is entangled.
#ifndef OTG_SOLID_DEEP_H
#define OTG_SOLID_DEEP_H
#include "solid/thin.h"
//
#define OTG_REAL_DOUBLE
#include "shared/contacts/edge_pair.h"
#undef OTG_REAL_DOUBLE

/// Whether the two faces of an edge are all that the region has of its mesh.
OTG_INLINED int otgIsAll(__local const otg_solid_ways* s, const otg_solid_work* w, uint mesh,
                         const otg_edge_of_pair_d* e) {
  for (uint j = 0; j < otgFaceCount(w, mesh); ++j) {
    const otg_vec3_d n = otgLoad(w->pieces[s->list[mesh][j]].normal);
    if (otgDot_d(n, e->faces[0]) < OTG_SOLID_SAME_FACE && otgDot_d(n, e->faces[1]) < OTG_SOLID_SAME_FACE) return 0;
  }
  return 1;
}

/// The edge that a point is the middle of.
OTG_INLINED otg_edge_of_pair_d otgEdgeAt(const otg_solid_work* w, OTG_MESH* m, __global const otg_solid_point* p) {
  const uint4 edge = m->edges[p->feature];
  const otg_vec3_d origin = otgLoad(w->region->origin);
  otg_edge_of_pair_d e;
  e.middle = otgLoad(p->position);
  e.along = otgLoad(p->along);
  const double x = otgDot_d(e.along, otgSub_d(otgSub_d(otgVertexAt(m, edge.x), origin), e.middle));
  const double y = otgDot_d(e.along, otgSub_d(otgSub_d(otgVertexAt(m, edge.y), origin), e.middle));
  e.low = otgMin_d(x, y);
  e.high = otgMax_d(x, y);
  e.faces[0] = otgDirectionInA(m, otgOwnNormal(m, edge.z / 3));
  e.faces[1] = otgDirectionInA(m, otgOwnNormal(m, otgTwinOf(m, edge.z) / 3));
  return e;
}

/// As EdgePair in collide/solid/edge_pair.h.
typedef struct {
  otg_vec3_d direction;
  double depth;
  int isAll;
  int counts;  ///< they are across each other, and all of the region unless that is a lump
} otg_edge_pair;

/// As edgePairsOf(). Numbers of the pair: stretch of A, stretch of B.
OTG_INLINED otg_edge_pair otgEdgePair(__local const otg_solid_ways* s, const otg_solid_work* w, OTG_MESH* a,
                                      OTG_MESH* b, uint pair) {
  const otg_edge_of_pair_d e = otgEdgeAt(w, a, w->points + s->convex[0][pair / OTG_SOLID_MOST_STRETCHES]);
  const otg_edge_of_pair_d f = otgEdgeAt(w, b, w->points + s->convex[1][pair % OTG_SOLID_MOST_STRETCHES]);
  otg_edge_pair found;
  found.counts = otgAreAcross_d(&e, &f, &found.direction, &found.depth);
  found.isAll = found.counts && otgIsAll(s, w, 0, &e) && otgIsAll(s, w, 1, &f);
  found.counts = found.isAll || (found.counts && otgIsThick_d(w->thickness, w->diagonal));
  return found;
}

/// s->pairs of edges across each other, in order. All lanes call it.
OTG_INLINED void otgFindEdgePairs(__local otg_solid_ways* s, const otg_solid_work* w, OTG_MESH* a, OTG_MESH* b) {
  const uint lane = get_local_id(0);
  const uint points = w->coherence < OTG_SOLID_ONE_FACE ? w->pointCount : 0;
  uint running[2], total;
  running[0] = running[1] = 0;
  for (uint base = 0; base < points; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isConvex = i < points && w->points[i].kind >= OTG_POINT_MIDDLE && w->points[i].corner;
    const uint mesh = isConvex ? w->points[i].mesh : 2;
    for (uint m = 0; m < 2; ++m) {
      const uint place = running[m] + otgPlaceAmong(OTG_COUNTS(s), mesh == m, &total);
      if (mesh == m && place < OTG_SOLID_MOST_STRETCHES) s->convex[m][place] = i;
      running[m] += total;
    }
  }
  OTG_SYNC;
  const int tooMany = running[0] > OTG_SOLID_MOST_STRETCHES || running[1] > OTG_SOLID_MOST_STRETCHES;
  const uint items = tooMany ? 0 : running[0] * running[1];
  uint pairs = 0;
  for (uint base = 0; base < items; base += OTG_GROUP) {
    const uint item = base + lane;
    uint pair = 0;
    int isPair = 0;
    if (item < items) {
      pair = item / running[1] * OTG_SOLID_MOST_STRETCHES + item % running[1];
      isPair = otgEdgePair(s, w, a, b, pair).counts;
    }
    const uint place = pairs + otgPlaceAmong(OTG_COUNTS(s), isPair, &total);
    if (isPair) s->pairOf[place] = pair;
    pairs += total;
  }
  if (lane == 0) s->pairs = pairs;
  OTG_SYNC;
}

/// Sorts the pieces of a mesh into s->order, the largest first; equal ones by triangle, then as they are listed, so
/// that no two have one place and none is left as it was. All lanes call it.
OTG_INLINED void otgSortFaces(__local otg_solid_ways* s, const otg_solid_work* w, uint mesh, int isDeep) {
  __local double* areas = s->numbers;  // where nothing lies yet
  const uint lane = get_local_id(0), count = isDeep ? otgFaceCount(w, mesh) : 0;
  OTG_SYNC;
  for (uint j = lane; j < count; j += OTG_GROUP) areas[j] = w->pieces[s->list[mesh][j]].area;
  OTG_SYNC;
  for (uint j = lane; j < count; j += OTG_GROUP) {
    const double area = areas[j];
    uint place = 0, ties = 0;
    OTG_UNROLLED(8)
    for (uint k = 0; k < count; ++k) {
      place += areas[k] > area;
      ties += areas[k] == area;
    }
    for (uint k = 0; k < (ties > 1 ? count : 0); ++k) {
      if (areas[k] != area) continue;
      const uint own = w->pieces[s->list[mesh][j]].triangle, other = w->pieces[s->list[mesh][k]].triangle;
      place += other < own || (other == own && k < j);
    }
    s->order[(mesh == 0 ? 0 : w->facesOfA) + place] = s->list[mesh][j];
  }
}

/// The normal of a piece, in the sense in which it pushes A.
OTG_INLINED otg_vec3_d otgPushOf(__global const otg_solid_piece* p, uint mesh) {
  const otg_vec3_d normal = otgLoad(p->normal);
  return mesh == 0 ? otgScale_d(normal, -1.0) : normal;
}

/// Main directions of the region's faces of one mesh, from pieces in s->order, largest first: one that belongs to no
/// cluster yet begins one, to which all those after it belong whose normals are like its own. Sums go by piece in that
/// order. All lanes call it; `isDeep`: if not, there are none.
OTG_INLINED void otgGatherFaces(__local otg_solid_ways* s, const otg_solid_work* w, uint mesh, int isDeep) {
  __local const ushort* order = s->order + (mesh == 0 ? 0 : w->facesOfA);
  const uint lane = get_local_id(0), count = isDeep ? otgFaceCount(w, mesh) : 0;
  uint clusters = 0;
  for (uint j = lane; j < count; j += OTG_GROUP) s->label[j] = OTG_SOLID_FACE_CLUSTERS;
  // Each lane knows the normal of its first piece by heart.
  const otg_vec3_d mine = lane < count ? otgPushOf(w->pieces + order[lane], mesh) : otgVec_d(0, 0, 0);
  for (int more = 1; more;) {
    OTG_SYNC;
    if (lane == 0) s->first = OTG_NOT_THERE;
    OTG_SYNC;
    for (uint j = lane; j < count; j += OTG_GROUP) {
      if (s->label[j] != OTG_SOLID_FACE_CLUSTERS) continue;
      atomic_min(&s->first, j);
      break;
    }
    OTG_SYNC;
    const uint first = s->first;
    more = first != OTG_NOT_THERE && clusters < OTG_SOLID_FACE_CLUSTERS;
    if (more) {
      if (first % OTG_GROUP == lane) {
        const otg_vec3_d n = first == lane ? mine : otgPushOf(w->pieces + order[first], mesh);
        s->sums[0] = n.x;
        s->sums[1] = n.y;
        s->sums[2] = n.z;
      }
      OTG_SYNC;
      const otg_vec3_d of = otgVec_d(s->sums[0], s->sums[1], s->sums[2]);
      for (uint j = lane; j < count; j += OTG_GROUP) {
        if (s->label[j] != OTG_SOLID_FACE_CLUSTERS) continue;
        const otg_vec3_d n = j == lane ? mine : otgPushOf(w->pieces + order[j], mesh);
        if (j == first || otgDot_d(of, n) >= OTG_SOLID_FACE_COSINE) s->label[j] = (uchar)clusters;
      }
      ++clusters;
    }
  }
  OTG_SYNC;
  for (uint t = lane; t < 4 * clusters; t += OTG_GROUP) {
    const uint cluster = t / 4, k = t % 4;
    double sum = 0;
    // All are read, so that no read waits for a label; 0 changes no sum that began with 0.
    OTG_UNROLLED(8)
    for (uint j = 0; j < count; ++j) {
      __global const otg_solid_piece* p = w->pieces + order[j];
      const otg_vec3_d n = otgPushOf(p, mesh);
      const double term = k == 3 ? p->area : (k == 0 ? n.x : k == 1 ? n.y : n.z) * p->area;
      sum += s->label[j] == cluster ? term : 0.0;
    }
    OTG_CLUSTER(s, cluster)[k] = sum;
  }
  if (lane == 0) s->listedFaces = clusters;
  OTG_SYNC;
}

/// Appends the clusters that have the most area. By one lane.
OTG_INLINED void otgTakeFaces(__local otg_solid_ways* s, double least) {
  for (uint k = 0; k < OTG_SOLID_DEEP_FACES; ++k) {
    uint best = OTG_NOT_THERE;
    for (uint c = 0; c < s->listedFaces; ++c) {
      const double area = OTG_CLUSTER(s, c)[3];
      if (area > least && (best == OTG_NOT_THERE || area > OTG_CLUSTER(s, best)[3])) best = c;
    }
    if (best == OTG_NOT_THERE) return;
    __local double* x = OTG_CLUSTER(s, best);
    const otg_vec3_d d = otgUnit_d(otgVec_d(x[0], x[1], x[2]));
    x[3] = -1;  // taken
    __local double* out = OTG_DEEP_DIRECTION(s, s->count);
    out[0] = d.x;
    out[1] = d.y;
    out[2] = d.z;
    ++s->count;
  }
}

/// A plane that lies ahead along d, scaled so that its value is the way to it. 0 if it does not.
OTG_INLINED int otgIsAhead(__global const otg_solid_face* face, uint mesh, otg_vec3_d d, otg_vec3_d* n,
                           double* offset) {
  const otg_vec3_d normal = otgLoad(face->normal);
  const double cosine = mesh == 1 ? otgDot_d(normal, d) : -otgDot_d(normal, d);
  if (!(cosine > 0.05)) return 0;
  *n = otgScale_d(normal, 1 / cosine);
  *offset = face->meanOffset / cosine;
  return 1;
}

/// How far A must go along d until a point is out, by the planes of the region's pieces.
OTG_INLINED double otgWayOfPoint(__local const otg_solid_ways* s, const otg_solid_work* w,
                                 __global const otg_solid_face* deep, otg_vec3_d d, otg_vec3_d p, double far) {
  double exits[2];
  for (uint mesh = 0; mesh < 2; ++mesh) {
    double least = far;
    __global const otg_solid_face* list = deep + (mesh == 0 ? 0 : w->facesOfA);
    for (uint j = 0; j < s->deep[mesh]; ++j) {
      otg_vec3_d n;
      double offset;
      if (otgIsAhead(list + j, mesh, d, &n, &offset)) least = otgMin_d(offset - otgDot_d(n, p), least);
    }
    exits[mesh] = least;
  }
  return otgMax_d(exits[0], 0) + otgMax_d(exits[1], 0);
}

/// Sets w->fixed and w->leastDepth if two edges are all of the region: by the pair that is left soonest. All lanes call
/// it.
OTG_INLINED void otgLeaveAcross(__local const otg_solid_ways* s, otg_solid_work* w, OTG_MESH* a, OTG_MESH* b) {
  for (uint k = 0; k < s->pairs; ++k) {
    const otg_edge_pair pair = otgEdgePair(s, w, a, b, s->pairOf[k]);
    if (!pair.isAll || (w->isFixed && !(pair.depth < w->leastDepth))) continue;
    w->fixed = pair.direction;
    w->isFixed = 1;
    w->leastDepth = pair.depth;
  }
}

/// Sets w->fixed to the shortest of `directions` ways out. The first is the mean one, which needs none. Nor does an
/// uneven region that has no short one. Those from `faces` on are across two edges. `hasLast`: the second is that of the
/// pair's last deep region.
OTG_INLINED void otgTakeShortest(__local const otg_solid_ways* s, otg_solid_work* w, uint faces, uint directions,
                                 int hasLast) {
  double least = OTG_SOLID_PUSH_SHARE * otgMax_d(OTG_DEEP_WAY(s, 0), OTG_DEEP_EXTENT(s, 0));
  double factor = 1;
  for (uint k = 1; k < directions; ++k) {
    __local const double* x = OTG_DEEP_DIRECTION(s, k);
    const otg_vec3_d d = otgVec_d(x[0], x[1], x[2]);
    // The vector area of two edges' overlap points across both, as long as no third face is in it: without a bias
    // towards the mean.
    if (k == faces && !w->isFixed) factor = OTG_SOLID_ACROSS_SHARE;
    if (otgDot_d(d, w->mean) < OTG_SOLID_DEEP_AGAINST) continue;
    const double share = hasLast && k == 1 ? OTG_SOLID_LAST_SHARE : factor;
    const double extent = OTG_DEEP_EXTENT(s, k), enough = least / share;
    const double cost = share * (extent >= enough ? extent : otgMax_d(OTG_DEEP_WAY(s, k), extent));
    if (cost >= least) continue;
    least = cost;
    w->fixed = d;
    w->isFixed = 1;
  }
  if (w->isUneven && otgIsLongWayOut_d(least, w->thickness)) w->isFixed = 0;
}

/// Sets w->fixed if a direction is a shorter way out than the mean one. All lanes call it. `last`: the direction of the
/// pair's last deep region, or zero. `room`: for planes.
OTG_INLINED void otgFindWayOut(__local otg_solid_ways* s, otg_solid_work* w, OTG_MESH* a, OTG_MESH* b, double far,
                               otg_vec3_d last, __global otg_solid_face* room) {
  const uint lane = get_local_id(0);
  otgFindEdgePairs(s, w, a, b);
  otgLeaveAcross(s, w, a, b);
  const int isThick = otgIsThick_d(w->thickness, w->diagonal), hasLast = otgDot_d(last, last) > 0;
  const int isDeep = isThick && !w->isFixed && w->pieceCount > 0;
  if (lane == 0) {
    s->count = 0;
    s->listedFaces = 0;
  }
  __global const otg_solid_face* deep = w->faces;
  if (isDeep) deep = otgGatherByNormal(s, w, room);
  for (uint mesh = 0; mesh < 2; ++mesh) otgSortFaces(s, w, mesh, isDeep);
  OTG_SYNC;
  if (lane == 0 && isDeep) {
    __local double* out = OTG_DEEP_DIRECTION(s, 0);
    out[0] = w->mean.x;
    out[1] = w->mean.y;
    out[2] = w->mean.z;
    if (hasLast) {
      out[3] = last.x;
      out[4] = last.y;
      out[5] = last.z;
    }
    s->count = hasLast ? 2 : 1;
  }
  for (uint mesh = 0; mesh < 2; ++mesh) {
    otgGatherFaces(s, w, mesh, isDeep);
    if (lane == 0 && isDeep) otgTakeFaces(s, 0.01 * (w->region->areaA + w->region->areaB));
    OTG_SYNC;
  }
  for (uint k = lane; k < (isDeep ? s->pairs : 0); k += OTG_GROUP) {
    const otg_vec3_d d = otgEdgePair(s, w, a, b, s->pairOf[k]).direction;
    __local double* out = OTG_DEEP_DIRECTION(s, s->count + k);
    out[0] = d.x;
    out[1] = d.y;
    out[2] = d.z;
  }
  OTG_SYNC;
  const uint faces = s->count, directions = isDeep ? faces + s->pairs : 0;
  const uint most = w->pointCount / OTG_SOLID_DEEP_POINTS, stride = most > 1 ? most : 1;
  for (uint k = lane; k < directions; k += OTG_GROUP) {
    __local const double* d = OTG_DEEP_DIRECTION(s, k);
    OTG_DEEP_EXTENT(s, k) = otgExtentAlong(w, otgVec_d(d[0], d[1], d[2]));
  }
  for (uint k = 0; k < directions; ++k) {
    __local const double* x = OTG_DEEP_DIRECTION(s, k);
    const otg_vec3_d d = otgVec_d(x[0], x[1], x[2]);
    double way = 0;
    for (uint i = lane * stride; i < w->pointCount; i += OTG_GROUP * stride) {
      way = otgMax_d(otgWayOfPoint(s, w, deep, d, otgLoad(w->points[i].position), far), way);
    }
    way = otgLargestOf(s->reduce, way);
    if (lane == 0) OTG_DEEP_WAY(s, k) = way;
  }
  OTG_SYNC;
  if (isDeep) otgTakeShortest(s, w, faces, directions, hasLast);
}

#endif  // OTG_SOLID_DEEP_H
