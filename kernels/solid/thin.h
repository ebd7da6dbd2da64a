// SPDX-License-Identifier: BSD-3-Clause
// Of regions with many pieces and points: planes that stand for several pieces, and the points that are looked at. As
// collectPlanes and thinned in collide/solid/region_contacts.cpp, and WayOutByPlanes in escape.cpp. Which of them comes
// first is of no account, but sums are those of the CPU: in the order of the pieces.
#ifndef OTG_SOLID_THIN_H
#define OTG_SOLID_THIN_H
#include "solid/normals.h"

#if OTG_SOLID_LARGE

/// The axis along which a direction is longest.
OTG_INLINED uint otgMainAxis(otg_vec3_d n) {
  const double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
  return z > (y > x ? y : x) ? 2 : y > x ? 1 : 0;
}
OTG_INLINED double otgAlongAxis(otg_vec3_d n, uint axis) {
  return axis == 0 ? n.x : axis == 1 ? n.y : n.z;
}

OTG_INLINED uint otgCellAlong(double x, double cell) {
  const double at = x / cell;
  return at > 0 ? (uint)at : 0;
}
OTG_INLINED uint otgCellOf(otg_vec3_d x, otg_vec3_d lo, double cell) {
  return otgCellAlong(x.x - lo.x, cell) | otgCellAlong(x.y - lo.y, cell) << 8 | otgCellAlong(x.z - lo.z, cell) << 16;
}

OTG_INLINED uint otgKeyByPlace(const otg_solid_work* w, __global const otg_solid_piece* p) {
  const otg_vec3_d n = otgLoad(p->normal), middle = otgScale_d(otgAdd_d(otgLoad(p->lo), otgLoad(p->hi)), 0.5);
  const uint axis = otgMainAxis(n);
  return otgCellOf(middle, w->lo, w->diagonal / OTG_SOLID_PLANE_CELLS) |
         (2 * axis + (otgAlongAxis(n, axis) < 0 ? 1 : 0)) << 24;
}

/// Cell of a direction on the faces of a cube.
OTG_INLINED uint otgKeyByNormal(otg_vec3_d n) {
  const uint axis = otgMainAxis(n);
  const double longest = otgAlongAxis(n, axis), length = fabs(longest);
  const uint u = (uint)((otgAlongAxis(n, (axis + 1) % 3) / length + 1) * (0.5 * OTG_SOLID_NORMAL_CELLS));
  const uint v = (uint)((otgAlongAxis(n, (axis + 2) % 3) / length + 1) * (0.5 * OTG_SOLID_NORMAL_CELLS));
  return (2 * axis + (longest < 0 ? 1 : 0)) << 16 | u << 8 | v;
}

/// Which of up to 32 keys are the same as one, a bit each: compared together, so that no read waits for another one.
OTG_INLINED uint otgSameKeys(__local const uint* keys, uint count, uint key) {
  uint same = 0;
  OTG_UNROLLED(8)
  for (uint k = 0; k < count; ++k) same |= (uint)(keys[k] == key) << k;
  return same;
}

/// Puts planes for the pieces of a mesh behind `out`: how many. All lanes call it.
OTG_INLINED uint otgGather(__local otg_solid_ways* s, const otg_solid_work* w, uint mesh, int byNormal,
                           __global otg_solid_face* out) {
  __local uint* keys = s->keys;
  const uint lane = get_local_id(0), count = otgFaceCount(w, mesh);
  uint planes = 0, total;
  OTG_SYNC;
  for (uint j = lane; j < count; j += OTG_GROUP) {
    __global const otg_solid_piece* p = w->pieces + s->list[mesh][j];
    keys[j] = byNormal ? otgKeyByNormal(otgLoad(p->normal)) : otgKeyByPlace(w, p);
  }
  OTG_SYNC;
  for (uint base = 0; base < count; base += OTG_GROUP) {
    const uint j = base + lane, key = j < count ? keys[j] : 0;
    int isFirst = j < count;
    otg_vec3_d vector = otgVec_d(0, 0, 0), lo = vector, hi = vector;
    double offset = 0;
    for (uint from = 0; from < count && isFirst; from += 32) {
      for (uint same = otgSameKeys(keys + from, min(count - from, 32u), key); same != 0 && isFirst; same &= same - 1) {
        const uint k = from + otgLowestBit(same);
        isFirst = k >= j;
        if (!isFirst) continue;
        __global const otg_solid_piece* p = w->pieces + s->list[mesh][k];
        const otg_vec3_d own = otgLoad(p->vector);
        lo = k == j ? otgLoad(p->lo) : otgLower(lo, otgLoad(p->lo));
        hi = k == j ? otgLoad(p->hi) : otgHigher(hi, otgLoad(p->hi));
        vector = otgAdd_d(vector, byNormal ? otgScale_d(otgLoad(p->normal), p->area) : own);
        offset += p->offset * (byNormal ? p->area : otgNorm_d(own));
      }
    }
    const double length = otgNorm_d(vector);
    const int isPlane = isFirst && length > 0;
    const uint place = planes + otgPlaceAmong(OTG_COUNTS(s), isPlane, &total);
    planes += total;
    if (!isPlane) continue;
    __global otg_solid_face* face = out + place;
    const otg_vec3_d n = otgScale_d(vector, 1 / length);
    for (uint k = 0; k < 3; ++k) {
      face->normal[k] = otgAlongAxis(n, k);
      face->lo[k] = otgAlongAxis(lo, k);
      face->hi[k] = otgAlongAxis(hi, k);
    }
    face->offset = offset / length;
    face->meanOffset = offset / length;
  }
  OTG_SYNC_ALL;
  return planes;
}

/// The candidates: all points, or of those in one cell, of one kind and mesh the one that lies deepest. All lanes call
/// it.
OTG_INLINED void otgThinPoints(__local otg_solid_ways* s, otg_solid_work* w) {
  __local double* hints = OTG_HINTS(s);
  __local uint* keys = OTG_KEYS(s);
  const uint lane = get_local_id(0), count = w->pointCount;
  uint candidates = 0, total;
  const int thins = count > OTG_SOLID_MOST_POINTS;
  const double cell = w->diagonal / OTG_SOLID_POINT_CELLS;
  OTG_SYNC;
  for (uint i = lane; i < count; i += OTG_GROUP) {
    __global const otg_solid_point* p = w->points + i;
    const otg_vec3_d x = otgLoad(p->position);
    hints[i] = otgDepthHint(w, p->mesh, x);
    keys[i] = thins ? otgCellOf(x, w->lo, cell) | p->kind << 24 | p->mesh << 28 : i;
  }
  OTG_SYNC;
  for (uint base = 0; base < count; base += OTG_GROUP) {
    const uint i = base + lane;
    int stays = i < count;
    if (stays && thins) {
      const uint key = keys[i];
      const double hint = hints[i];
      for (uint from = 0; from < count && stays; from += 32) {
        for (uint same = otgSameKeys(keys + from, min(count - from, 32u), key); same != 0; same &= same - 1) {
          const uint j = from + otgLowestBit(same);
          if (hints[j] > hint || (hints[j] == hint && j < i)) stays = 0;
        }
      }
    }
    const uint place = candidates + otgPlaceAmong(OTG_COUNTS(s), stays, &total);
    candidates += total;
    if (stays && place < OTG_SOLID_POINTS) w->picks[place] = (ushort)i;
  }
  if (lane == 0 && candidates > OTG_SOLID_POINTS) s->bad = 1;
  w->candidates = min(candidates, (uint)OTG_SOLID_POINTS);
  OTG_SYNC;
}

#endif  // OTG_SOLID_LARGE

/// Planes and candidates of a region that has many. All lanes call it. `planes` and `picks`: room for them.
OTG_INLINED void otgThinRegion(__local otg_solid_ways* s, otg_solid_work* w, __global otg_solid_face* planes,
                               __global ushort* picks) {
#if OTG_SOLID_LARGE
  w->planes = planes;
  w->picks = picks;
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const uint count = otgFaceCount(w, mesh), first = mesh == 0 ? 0 : w->facesOfA;
    if (count > OTG_SOLID_MOST_PLANES) {
      const uint gathered = otgGather(s, w, mesh, 0, planes + first);
      if (mesh == 0) {
        w->planesOfA = gathered;
      } else {
        w->planesOfB = gathered;
      }
      w->isGathered = 1;
    } else {
      for (uint j = get_local_id(0); j < count; j += OTG_GROUP) planes[first + j] = w->faces[first + j];
    }
  }
  OTG_SYNC_ALL;
  otgThinPoints(s, w);
#else
  (void)s;
  (void)w;
  (void)planes;
  (void)picks;
#endif
}

/// Planes for the ways out of a deep region, where there are many: A's, then B's from facesOfA on. All lanes call it.
OTG_INLINED __global otg_solid_face* otgGatherByNormal(__local otg_solid_ways* s, const otg_solid_work* w,
                                                       __global otg_solid_face* room) {
#if OTG_SOLID_LARGE
  if (w->pieceCount > OTG_SOLID_DEEP_PIECES) {
    for (uint mesh = 0; mesh < 2; ++mesh) {
      const uint planes = otgGather(s, w, mesh, 1, room + (mesh == 0 ? 0 : w->facesOfA));
      if (get_local_id(0) == 0) s->deep[mesh] = planes;
    }
    OTG_SYNC;
    return room;
  }
#else
  (void)room;
#endif
  if (get_local_id(0) == 0) {
    s->deep[0] = w->facesOfA;
    s->deep[1] = w->facesOfB;
  }
  OTG_SYNC;
  return w->faces;
}

#endif  // OTG_SOLID_THIN_H
