// SPDX-License-Identifier: BSD-3-Clause
// The way out of a deep region: the shortest among the push and the main face directions; as directRegion in
// collide/solid/escape.cpp, without a history.
#ifndef OTG_SOLID_DEEP_H
#define OTG_SOLID_DEEP_H
#include "solid_thin.h"

/// The two faces of the edge that a point is the middle of: outward normals.
OTG_INLINED void otgFacesAt(const otg_solid_mesh* m, uint edge, otg_vec3_d* n0, otg_vec3_d* n1) {
  const uint halfEdge = m->edges[edge].z;
  *n0 = otgDirectionInA(m, otgOwnNormal(m, halfEdge / 3));
  *n1 = otgDirectionInA(m, otgOwnNormal(m, otgTwinOf(m, halfEdge) / 3));
}

/// Whether the two faces of an edge are all that the region has of its mesh.
OTG_INLINED int otgIsAll(const otg_solid_work* w, uint mesh, otg_vec3_d n0, otg_vec3_d n1) {
  double own = 0;
  for (uint j = 0; j < w->s->listed[mesh]; ++j) {
    __global const otg_solid_piece* p = w->pieces + w->s->list[mesh][j];
    const otg_vec3_d n = otgLoad(p->normal);
    if (otgDot_d(n, n0) >= OTG_SOLID_SAME_FACE || otgDot_d(n, n1) >= OTG_SOLID_SAME_FACE) own += p->area;
  }
  return own >= OTG_SOLID_FACE_SHARE * (mesh == 0 ? w->region->areaA : w->region->areaB);
}

/// An edge of A across an edge of B: as in edgePairs. Numbers of the pair: stretch of A, stretch of B.
OTG_INLINED int otgAcross(const otg_solid_work* w, const otg_solid_mesh* a, const otg_solid_mesh* b, uint pair,
                          int isDeep, otg_vec3_d* direction, otg_vec3_d* placeA, otg_vec3_d* placeB) {
  __global const otg_solid_point* p = w->points + w->s->sharp[0][pair / OTG_SOLID_MOST_STRETCHES];
  __global const otg_solid_point* q = w->points + w->s->sharp[1][pair % OTG_SOLID_MOST_STRETCHES];
  const otg_vec3_d alongA = otgLoad(p->along), alongB = otgLoad(q->along), across = otgCross_d(alongA, alongB);
  const otg_vec3_d middleA = otgLoad(p->position), middleB = otgLoad(q->position);
  const double sine = otgNorm_d(across);
  otg_vec3_d a0, a1, b0, b1;
  otgFacesAt(a, p->feature, &a0, &a1);
  otgFacesAt(b, q->feature, &b0, &b1);
  if (sine < OTG_SOLID_LEAST_SINE) return 0;
  if (!isDeep && (!otgIsAll(w, 0, a0, a1) || !otgIsAll(w, 1, b0, b1))) return 0;
  otg_vec3_d d = otgScale_d(across, 1 / sine);
  if (otgDot_d(d, otgLoad(w->region->push)) < 0) d = otgScale_d(d, -1.0);
  if (!otgIsBetween_d(a0, a1, otgScale_d(d, -1.0)) || !otgIsBetween_d(b0, b1, d)) return 0;
  // Nearest points of the two lines, within the stretches.
  const otg_vec3_d apart = otgSub_d(middleB, middleA);
  const double u = otgDot_d(otgCross_d(apart, alongB), across) / (sine * sine);
  const double v = otgDot_d(otgCross_d(apart, alongA), across) / (sine * sine);
  if (fabs(u) > p->reach || fabs(v) > q->reach) return 0;
  *direction = d;
  *placeA = otgAdd_d(middleA, otgScale_d(alongA, u));
  *placeB = otgAdd_d(middleB, otgScale_d(alongB, v));
  return 1;
}

/// s->pairs of edges across each other, in order. All lanes call it.
OTG_INLINED void otgFindEdgePairs(const otg_solid_work* w, const otg_solid_mesh* a, const otg_solid_mesh* b,
                                  int isDeep) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0);
  const uint points = w->coherence < OTG_SOLID_ONE_FACE ? w->pointCount : 0;
  uint running[2], total;
  running[0] = running[1] = 0;
  for (uint base = 0; base < points; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isSharp = i < points && w->points[i].kind >= OTG_POINT_MIDDLE && w->points[i].sharp;
    const uint mesh = isSharp ? w->points[i].mesh : 2;
    for (uint m = 0; m < 2; ++m) {
      const uint place = running[m] + otgPlaceAmong(OTG_COUNTS(s), mesh == m, &total);
      if (mesh == m && place < OTG_SOLID_MOST_STRETCHES) s->sharp[m][place] = i;
      running[m] += total;
    }
  }
  OTG_SYNC;
  if (lane == 0) {
    s->pairs = 0;
    s->across = OTG_NOT_THERE;
    const int tooMany = running[0] > OTG_SOLID_MOST_STRETCHES || running[1] > OTG_SOLID_MOST_STRETCHES;
    for (uint x = 0; x < running[0] && !tooMany; ++x) {
      for (uint y = 0; y < running[1]; ++y) {
        otg_vec3_d d, placeA, placeB;
        const uint pair = x * OTG_SOLID_MOST_STRETCHES + y;
        if (otgAcross(w, a, b, pair, isDeep, &d, &placeA, &placeB)) s->pairOf[s->pairs++] = pair;
      }
    }
  }
  OTG_SYNC;
}

/// Up to OTG_SOLID_DEEP_FACES mean directions of the region's faces of one mesh, in the sense in which they push A,
/// from pieces in s->order, largest first. By one lane. Appends them to `count` directions.
OTG_INLINED void otgGatherFaces(const otg_solid_work* w, uint mesh) {
  __local otg_solid_choice* s = w->s;
  __local const ushort* order = s->order + (mesh == 0 ? 0 : s->listed[0]);
  uint clusters = 0;
  for (uint j = 0; j < s->listed[mesh]; ++j) {
    __global const otg_solid_piece* p = w->pieces + order[j];
    const otg_vec3_d normal = otgLoad(p->normal), n = mesh == 0 ? otgScale_d(normal, -1.0) : normal;
    uint c = 0;
    while (c < clusters) {
      __local const double* x = OTG_CLUSTER(s, c);
      if (x[0] * n.x + x[1] * n.y + x[2] * n.z >= OTG_SOLID_FACE_COSINE) break;
      ++c;
    }
    __local double* x = OTG_CLUSTER(s, c);
    if (c == clusters) {
      if (clusters == OTG_SOLID_FACE_CLUSTERS) continue;
      ++clusters;
      x[0] = n.x;
      x[1] = n.y;
      x[2] = n.z;
      x[3] = x[4] = x[5] = x[6] = 0;
    }
    x[3] += n.x * p->area;
    x[4] += n.y * p->area;
    x[5] += n.z * p->area;
    x[6] += p->area;
  }
  s->listedFaces = clusters;
}

/// Appends the clusters that have the most area. By one lane.
OTG_INLINED void otgTakeFaces(const otg_solid_work* w, double least) {
  __local otg_solid_choice* s = w->s;
  for (uint k = 0; k < OTG_SOLID_DEEP_FACES; ++k) {
    uint best = OTG_NOT_THERE;
    for (uint c = 0; c < s->listedFaces; ++c) {
      const double area = OTG_CLUSTER(s, c)[6];
      if (area > least && (best == OTG_NOT_THERE || area > OTG_CLUSTER(s, best)[6])) best = c;
    }
    if (best == OTG_NOT_THERE) return;
    __local double* x = OTG_CLUSTER(s, best);
    const otg_vec3_d d = otgUnit_d(otgVec_d(x[3], x[4], x[5]));
    x[6] = -1;  // taken
    __local double* out = OTG_DEEP_DIRECTION(s, s->count);
    out[0] = d.x;
    out[1] = d.y;
    out[2] = d.z;
    ++s->count;
  }
}

/// How far A must go along d until a point is out, by the planes of the region's pieces.
OTG_INLINED double otgWayOfPoint(const otg_solid_work* w, otg_vec3_d d, otg_vec3_d p, double far) {
  double exits[2];
  for (uint mesh = 0; mesh < 2; ++mesh) {
    double least = far;
    OTG_FACES const otg_solid_face* list = w->deep + (mesh == 0 ? 0 : w->s->listed[0]);
    for (uint j = 0; j < w->s->deep[mesh]; ++j) {
      OTG_FACES const otg_solid_face* face = list + j;
      const otg_vec3_d n = otgOfFace(face->normal);
      const double cosine = mesh == 1 ? otgDot_d(n, d) : -otgDot_d(n, d);
      if (!(cosine > 0.05)) continue;
      least = otgMin_d(face->meanOffset / cosine - otgDot_d(otgScale_d(n, 1 / cosine), p), least);
    }
    exits[mesh] = least;
  }
  return otgMax_d(exits[0], 0) + otgMax_d(exits[1], 0);
}

/// Sets w->fixed if a direction is a shorter way out than the mean one. All lanes call it.
OTG_INLINED void otgFindWayOut(otg_solid_work* w, const otg_solid_mesh* a, const otg_solid_mesh* b, double far) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0);
  const int isLump = w->thickness > OTG_SOLID_DEEP * w->diagonal;
  otgFindEdgePairs(w, a, b, isLump);
  const int isDeep = (isLump || s->pairs > 0) && w->pieceCount > 0;
  const double areas = w->region->areaA + w->region->areaB;
  if (lane == 0) {
    s->count = 0;
    s->listedFaces = 0;
  }
  if (isDeep) otgGatherByNormal(w);
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const uint count = isDeep ? s->listed[mesh] : 0;
    for (uint j = lane; j < count; j += OTG_GROUP) {
      const uint i = s->list[mesh][j];
      const double area = w->pieces[i].area;
      const uint triangle = w->pieces[i].triangle;
      uint place = 0;
      for (uint k = 0; k < count; ++k) {
        __global const otg_solid_piece* q = w->pieces + s->list[mesh][k];
        place += q->area > area || (q->area == area && q->triangle < triangle);
      }
      s->order[(mesh == 0 ? 0 : s->listed[0]) + place] = (ushort)i;
    }
  }
  OTG_SYNC;
  if (lane == 0 && isDeep) {
    __local double* out = OTG_DEEP_DIRECTION(s, 0);
    out[0] = w->mean.x;
    out[1] = w->mean.y;
    out[2] = w->mean.z;
    s->count = 1;
    for (uint mesh = 0; mesh < 2; ++mesh) {
      otgGatherFaces(w, mesh);
      otgTakeFaces(w, 0.01 * areas);
    }
    for (uint k = 0; k < s->pairs; ++k) {
      otg_vec3_d d, placeA, placeB;
      otgAcross(w, a, b, s->pairOf[k], isLump, &d, &placeA, &placeB);
      out = OTG_DEEP_DIRECTION(s, s->count + k);
      out[0] = d.x;
      out[1] = d.y;
      out[2] = d.z;
    }
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
      way = otgMax_d(otgWayOfPoint(w, d, otgLoad(w->points[i].position), far), way);
    }
    way = otgLargestOf(s, way);
    if (lane == 0) s->ways[k] = way;
  }
  OTG_SYNC;
  double least = directions > 0 ? OTG_SOLID_PUSH_SHARE * otgMax_d(s->ways[0], OTG_DEEP_EXTENT(s, 0)) : 0;
  double factor = 1;
  for (uint k = 1; k < directions; ++k) {
    __local const double* x = OTG_DEEP_DIRECTION(s, k);
    const otg_vec3_d d = otgVec_d(x[0], x[1], x[2]);
    // The vector area of two edges' overlap points across both, as long as no third face is in it: without a bias
    // towards the mean.
    if (k == faces && !w->isFixed) factor = OTG_SOLID_ACROSS_SHARE;
    if (otgDot_d(d, w->mean) < OTG_SOLID_DEEP_AGAINST) continue;
    const double extent = OTG_DEEP_EXTENT(s, k), enough = least / factor;
    const double cost = factor * (extent >= enough ? extent : otgMax_d(s->ways[k], extent));
    if (cost >= least) continue;
    least = cost;
    w->fixed = d;
    w->isFixed = 1;
    if (k >= faces && lane == 0) s->across = s->pairOf[k - faces];
  }
  OTG_SYNC;
  if (lane == 0 && s->across != OTG_NOT_THERE) {
    otg_vec3_d d, placeA, placeB;
    otgAcross(w, a, b, s->across, isLump, &d, &placeA, &placeB);
    s->places[0] = placeA.x;
    s->places[1] = placeA.y;
    s->places[2] = placeA.z;
    s->places[3] = placeB.x;
    s->places[4] = placeB.y;
    s->places[5] = placeB.z;
  }
  OTG_SYNC;
}

#endif  // OTG_SOLID_DEEP_H
