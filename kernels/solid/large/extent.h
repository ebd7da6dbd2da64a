// SPDX-License-Identifier: BSD-3-Clause
// How far a large region reaches along a direction: all its vertices and crossings, by one or several work-groups. As
// collide/solid/extent.cpp: clusters of vertices are looked at only where their bounds reach farther than what is
// known.
#ifndef OTG_OVERLAP_EXTENT_H
#define OTG_OVERLAP_EXTENT_H
#include "solid/large/found.h"

#define OTG_EXTENT_AHEAD 4   ///< vertices or crossings that a lane reads at once
#define OTG_EXTENT_LIST 128  ///< clusters that reach farthest, to be looked at by all lanes

typedef struct {
  double high[OTG_GROUP], low[OTG_GROUP];
  uint list[OTG_EXTENT_LIST], listed, first[2];
} otg_extent_scratch;

/// The highest and the lowest of what lanes have, in the first places. All lanes call it.
OTG_INLINED void otgSpanOfLanes(__local otg_extent_scratch* s, double high, double low) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
  s->high[lane] = high;
  s->low[lane] = low;
  OTG_SYNC;
  for (uint half_ = OTG_GROUP / 2; half_ > 0; half_ /= 2) {
    if (lane < half_) {
      s->high[lane] = otgMax_d(s->high[lane + half_], s->high[lane]);
      s->low[lane] = otgMin_d(s->low[lane + half_], s->low[lane]);
    }
    OTG_SYNC;
  }
}

OTG_INLINED void otgStretchSpan(double x, double* high, double* low) {
  *high = otgMax_d(x, *high);
  *low = otgMin_d(x, *low);
}

OTG_INLINED void otgSpanOfCluster(OTG_PAIR_MESH* m, uint cluster, uint lane, uint lanes, otg_vec3_d origin,
                                  otg_vec3_d d, double* high, double* low) {
  for (uint k = otgFirstOf(m, cluster) + lane; k < otgFirstOf(m, cluster + 1); k += lanes) {
    otgStretchSpan(otgDot_d(otgSub_d(otgVertexAt(&m->solid, m->clusterVertices[k]), origin), d), high, low);
  }
}

/// Bounds of a cluster along d, in A's frame relative to the origin, rounded.
OTG_INLINED void otgBoundsOfCluster(OTG_PAIR_MESH* m, uint cluster, otg_vec3_d origin, otg_vec3_d d, double* high,
                                    double* low) {
  __global const float4* c = m->clusters + OTG_CLUSTER_UNITS * cluster;
  const float4 low4 = c[0], high4 = c[1];
  const otg_vec3_d own = otgDirectionToOwn(&m->solid, d);
  const otg_vec3_d shift = otgSub_d(otgInFrame(&m->solid, otgVec_d(0, 0, 0)), origin);
  const double x = 0.5 * own.x, y = 0.5 * own.y, z = 0.5 * own.z;
  const double middle = x * ((double)low4.x + (double)high4.x) + y * ((double)low4.y + (double)high4.y) +
                        z * ((double)low4.z + (double)high4.z) + otgDot_d(shift, d);
  const double reach = fabs(x) * ((double)high4.x - (double)low4.x) + fabs(y) * ((double)high4.y - (double)low4.y) +
                       fabs(z) * ((double)high4.z - (double)low4.z);
  *high = middle + reach;
  *low = middle - reach;
}

/// The highest and the lowest along d of one of several parts of what there is, in the first places of s->high and
/// s->low. All lanes call it.
OTG_INLINED void otgSpanOfPart(__local otg_extent_scratch* s, const otg_found_lists* l, OTG_PAIR_MESH* mesh,
                               otg_vec3_d d, uint part, uint parts) {
  const uint lane = get_local_id(0), first = part * OTG_GROUP + lane, step = parts * OTG_GROUP;
  const uint crossings = l->head->counts[OTG_OVERLAP_CROSSINGS];
  const uint vertices = l->head->counts[OTG_OVERLAP_VERTICES], clusters = l->head->counts[OTG_OVERLAP_CLUSTERS];
  const otg_vec3_d origin = otgLoad(l->head->origin);
  double high = -INFINITY, low = INFINITY, top, bottom;
  // Several are read before the first of them is looked at: a lane waits for memory once for all of them.
  for (uint from = first; from < crossings; from += OTG_EXTENT_AHEAD * step) {
    otg_found_crossing c[OTG_EXTENT_AHEAD];
    OTG_UNROLLED(OTG_EXTENT_AHEAD)
    for (uint k = 0; k < OTG_EXTENT_AHEAD; ++k) c[k] = l->crossings[min(from + k * step, crossings - 1)];
    OTG_UNROLLED(OTG_EXTENT_AHEAD)
    for (uint k = 0; k < OTG_EXTENT_AHEAD; ++k) {
      const double x = otgDot_d(otgVec_d(c[k].point[0], c[k].point[1], c[k].point[2]), d);
      if (c[k].region == l->region) otgStretchSpan(x, &high, &low);
    }
  }
  for (uint from = first; from < vertices; from += OTG_EXTENT_AHEAD * step) {
    otg_found_inside inside[OTG_EXTENT_AHEAD];
    float4 at[OTG_EXTENT_AHEAD];
    OTG_UNROLLED(OTG_EXTENT_AHEAD)
    for (uint k = 0; k < OTG_EXTENT_AHEAD; ++k) inside[k] = l->vertices[min(from + k * step, vertices - 1)];
    OTG_UNROLLED(OTG_EXTENT_AHEAD)
    for (uint k = 0; k < OTG_EXTENT_AHEAD; ++k) at[k] = mesh[inside[k].what & 1].solid.vertices[inside[k].what >> 1];
    OTG_UNROLLED(OTG_EXTENT_AHEAD)
    for (uint k = 0; k < OTG_EXTENT_AHEAD; ++k) {
      const otg_vec3_d p =
          otgInFrame(&mesh[inside[k].what & 1].solid, otgVec_d((double)at[k].x, (double)at[k].y, (double)at[k].z));
      const double x = otgDot_d(otgSub_d(p, origin), d);
      if (inside[k].region == l->region) otgStretchSpan(x, &high, &low);
    }
  }
  // The cluster that reaches farthest for each lane and side first.
  uint farthest[2];
  double most = -INFINITY, least = INFINITY;
  farthest[0] = farthest[1] = OTG_NOT_THERE;
  OTG_UNROLLED(4)
  for (uint i = first; i < clusters; i += step) {
    const otg_found_inside inside = l->clusters[i];
    const int isOwn = inside.region == l->region;
    otgBoundsOfCluster(mesh + (inside.what & 1), inside.what >> 1, origin, d, &top, &bottom);
    farthest[0] = isOwn & (top > most) ? inside.what : farthest[0];
    most = isOwn & (top > most) ? top : most;
    farthest[1] = isOwn & (bottom < least) ? inside.what : farthest[1];
    least = isOwn & (bottom < least) ? bottom : least;
  }
  otgSpanOfLanes(s, most, least);
  const double highest = s->high[0], lowest = s->low[0];
  if (lane == 0) s->first[0] = s->first[1] = OTG_NOT_THERE;
  OTG_SYNC;
  if (farthest[0] != OTG_NOT_THERE && most == highest) atomic_min(s->first, farthest[0]);
  if (farthest[1] != OTG_NOT_THERE && least == lowest) atomic_min(s->first + 1, farthest[1]);
  OTG_SYNC;
  for (uint side = 0; side < 2; ++side) {
    const uint what = s->first[side];
    if (what != OTG_NOT_THERE) {
      otgSpanOfCluster(mesh + (what & 1), what >> 1, lane, OTG_GROUP, origin, d, &high, &low);
    }
  }
  otgSpanOfLanes(s, high, low);
  high = s->high[0];
  low = s->low[0];
  OTG_SYNC;
  if (lane == 0) s->listed = 0;
  OTG_SYNC;
  // Bounds round: none is left out that may reach farther.
  const double radii = (double)(mesh[0].solid.radius + mesh[1].solid.radius);
  const double slack = 1e-9 * (radii + otgNorm_d(origin) + otgNorm_d(mesh[1].solid.pose.t));
  double ownHigh = high, ownLow = low;
  OTG_UNROLLED(4)
  for (uint i = first; i < clusters; i += step) {
    const otg_found_inside inside = l->clusters[i];
    otgBoundsOfCluster(mesh + (inside.what & 1), inside.what >> 1, origin, d, &top, &bottom);
    if (inside.region != l->region || (!(top > high - slack) && !(bottom < low + slack))) continue;
    const uint place = atomic_inc(&s->listed);
    if (place < OTG_EXTENT_LIST) {
      s->list[place] = inside.what;
    } else {
      otgSpanOfCluster(mesh + (inside.what & 1), inside.what >> 1, 0, 1, origin, d, &ownHigh, &ownLow);
    }
  }
  OTG_SYNC;
  const uint listed = min(s->listed, (uint)OTG_EXTENT_LIST);
#if OTG_GROUP >= OTG_CLUSTER_LANES
  for (uint k = lane / OTG_CLUSTER_LANES; k < listed; k += OTG_GROUP / OTG_CLUSTER_LANES) {
    otgSpanOfCluster(mesh + (s->list[k] & 1), s->list[k] >> 1, lane % OTG_CLUSTER_LANES, OTG_CLUSTER_LANES, origin, d,
                     &ownHigh, &ownLow);
  }
#else
  for (uint k = lane; k < listed; k += OTG_GROUP) {
    otgSpanOfCluster(mesh + (s->list[k] & 1), s->list[k] >> 1, 0, 1, origin, d, &ownHigh, &ownLow);
  }
#endif
  otgSpanOfLanes(s, ownHigh, ownLow);
}

/// By one work-group. All lanes call it.
OTG_INLINED double otgExtentOfRegion(__local otg_extent_scratch* s, const otg_found_lists* l, OTG_PAIR_MESH* mesh,
                                     otg_vec3_d d) {
  otgSpanOfPart(s, l, mesh, d, 0, 1);
  const double extent = s->high[0] - s->low[0];
  OTG_SYNC;
  return extent;
}

#endif  // OTG_OVERLAP_EXTENT_H
