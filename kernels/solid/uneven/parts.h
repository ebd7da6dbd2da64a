// SPDX-License-Identifier: BSD-3-Clause
// By which ways the vertices and stretches of an uneven region may leave it, one part to a lane: as partOfVertex and
// partOfStretch in collide/solid/leaving.cpp.
#ifndef OTG_UNEVEN_PARTS_H
#define OTG_UNEVEN_PARTS_H
#include "solid/uneven/scratch.h"

/// A vertex or a stretch: of a vertex both ends are the same.
typedef struct {
  otg_vec3_d from, to, position, along;
  double reach, side;  ///< side: turns a way out of the other mesh into one out of B
  uint other;          ///< the mesh to leave
  int isVertex;
} otg_uneven_part;

OTG_INLINED otg_uneven_part otgPartOf(__global const otg_solid_point* p) {
  otg_uneven_part part;
  part.position = otgLoad(p->position);
  part.along = otgLoad(p->along);
  part.reach = p->reach;
  part.isVertex = p->kind == OTG_POINT_VERTEX;
  const otg_vec3_d half_ = otgScale_d(part.along, part.reach);
  part.from = part.isVertex ? part.position : otgSub_d(part.position, half_);
  part.to = part.isVertex ? part.position : otgAdd_d(part.position, half_);
  part.side = p->mesh == 0 ? 1.0 : -1.0;
  part.other = 1 - p->mesh;
  return part;
}

/// Whether a point that lies `way` below a face's plane lies over the face.
OTG_INLINED int otgIsOverFace(__global const otg_uneven_face* f, otg_vec3_d p, double way, double slack) {
  const otg_vec3_d foot = otgAdd_d(p, otgScale_d(otgLoad(f->normal), way));
  return otgBesideFace(f, foot) <= otgMax_d(way, slack);
}

/// Whether a part lies over a face at one end at least, and below its plane; how far below at either end.
OTG_INLINED int otgLiesOver(const otg_uneven* u, __global const otg_uneven_face* f, const otg_uneven_part* part,
                            double* first, double* last) {
  *first = otgBelowFace(f, part->from);
  *last = otgBelowFace(f, part->to);
  if (!(otgMax_d(*first, *last) >= -u->slack)) return 0;
  return otgIsOverFace(f, part->from, *first, u->slack) || otgIsOverFace(f, part->to, *last, u->slack);
}

/// The way of a stretch across an edge of the other mesh, on the side that a sign says; 0: there is none.
OTG_INLINED double otgWayAcross(const otg_uneven_part* part, __global const otg_uneven_edge* e, double sign, double* at,
                                otg_vec3_d* out) {
  const otg_vec3_d along = otgLoad(e->along);
  *out = otgScale_d(otgUnit_d(otgCross_d(part->along, along)), sign);
  if (!otgIsBetween_d(otgLoad(e->faces), otgLoad(e->faces + 3), *out)) return 0;
  const otg_stretch_pass_d pass = otgPassOfStretches_d(otgSub_d(otgLoad(e->middle), part->position), part->along,
                                                       part->reach, along, e->reach, *out);
  *at = pass.at;
  return pass.way > 0 ? pass.way : 0;
}

/// No fewer than the ways of a part.
OTG_INLINED uint otgBoundOfWays(const otg_uneven* u, const otg_uneven_part* part) {
  double first, last, at;
  otg_vec3_d out;
  uint count = OTG_UNEVEN_EXITS;
  for (uint i = otgFirstFace(u, part->other); i < otgEndOfFaces(u, part->other); ++i) {
    count += (uint)otgLiesOver(u, u->faces + i, part, &first, &last);
  }
  if (part->isVertex) return count;
  for (uint i = part->other == 0 ? 0 : u->edgesOfA; i < (part->other == 0 ? u->edgesOfA : u->edgeCount); ++i) {
    for (uint k = 0; k < 2; ++k) count += otgWayAcross(part, u->edges + i, k == 0 ? -1.0 : 1.0, &at, &out) > 0;
  }
  return count;
}

OTG_INLINED void otgSetWay(__global otg_uneven_way* way, otg_vec3_d at, otg_vec3_d normal, double depth, uint curved,
                           uint group) {
  otgStore(way->at, at);
  otgStore(way->normal, normal);
  way->depth = depth;
  way->curved = curved;
  way->group = group;
}

/// The faces on which the place of the surface lies that is nearest to the part's middle, if it is nearer than `limit`:
/// how many, OTG_UNEVEN_EXITS + 1 if there are too many.
OTG_INLINED uint otgExitsOf(const otg_uneven* u, const otg_uneven_part* part, double limit,
                            __global otg_uneven_way* ways) {
  const uint first = otgFirstFace(u, part->other), end = otgEndOfFaces(u, part->other);
  const otg_vec3_d p = part->position;
  double nearest = limit;
  for (uint i = first; i < end; ++i) {
    if (fabs(otgBelowFace(u->faces + i, p)) > otgAsNear_d(nearest, u->slack)) continue;
    nearest = otgMin_d(otgDistanceOfFace(u->faces + i, p), nearest);
  }
  if (!(nearest < limit)) return 0;
  const double most = otgAsNear_d(nearest, u->slack);
  uint count = 0;
  for (uint i = first; i < end; ++i) {
    __global const otg_uneven_face* f = u->faces + i;
    const double depth = otgBelowFace(f, p);
    if (!(depth > -u->slack) || depth > most || !(otgDistanceOfFace(f, p) <= most)) continue;
    const otg_vec3_d normal = otgScale_d(otgLoad(f->normal), part->side);
    int isNew = 1;
    for (uint k = 0; k < count; ++k) isNew &= !(otgDot_d(otgLoad(ways[k].normal), normal) > OTG_UNEVEN_SAME_NORMAL);
    if (!isNew) continue;
    if (count == OTG_UNEVEN_EXITS) return OTG_UNEVEN_EXITS + 1;
    const double from = otgBelowFace(f, part->from), to = otgBelowFace(f, part->to);
    otgSetWay(ways + count++, to > from ? part->to : part->from, normal, otgDeeperEnd_d(from, to), f->curved,
              OTG_NOT_THERE);
  }
  return count;
}

/// The faces over which a part lies, behind the first `count` ways: how many there are then. Of those that face the
/// same way the one that is left soonest. In the order of the faces.
OTG_INLINED uint otgFacesOver(const otg_uneven* u, const otg_uneven_part* part, __global otg_uneven_way* ways,
                              uint count) {
  const uint before = count;
  for (uint i = otgFirstFace(u, part->other); i < otgEndOfFaces(u, part->other); ++i) {
    __global const otg_uneven_face* f = u->faces + i;
    double first, last;
    if (!otgLiesOver(u, f, part, &first, &last)) continue;
    const double depth = otgDeeperEnd_d(first, last);
    uint place = before;
    while (place < count && ways[place].group != f->sameAs) ++place;
    if (place < count && !(depth < ways[place].depth)) continue;
    if (place < count) --count;
    for (; place < count; ++place) ways[place] = ways[place + 1];
    otgSetWay(ways + count++, last > first ? part->to : part->from, otgScale_d(otgLoad(f->normal), part->side), depth,
              f->curved, f->sameAs);
  }
  return count;
}

/// Keeps the ways behind the first `together` that are not the same half-space as one of those: how many all are then.
OTG_INLINED uint otgWithoutSame(__global otg_uneven_way* ways, uint together, uint count) {
  uint kept = together;
  for (uint k = together; k < count; ++k) {
    const otg_uneven_way way = ways[k];
    int isOther = 1;
    for (uint j = 0; j < together; ++j) {
      isOther &= !(otgDot_d(otgLoad(ways[j].normal), otgLoad(ways[k].normal)) > OTG_UNEVEN_SAME_NORMAL);
    }
    if (isOther) ways[kept++] = way;
  }
  return kept;
}

OTG_INLINED uint otgEdgesPassed(const otg_uneven* u, const otg_uneven_part* part, __global otg_uneven_way* ways,
                                uint count) {
  for (uint i = part->other == 0 ? 0 : u->edgesOfA; i < (part->other == 0 ? u->edgesOfA : u->edgeCount); ++i) {
    for (uint k = 0; k < 2; ++k) {
      double at;
      otg_vec3_d out;
      const double way = otgWayAcross(part, u->edges + i, k == 0 ? -1.0 : 1.0, &at, &out);
      if (!(way > 0)) continue;
      otgSetWay(ways + count++, otgAdd_d(part->position, otgScale_d(part->along, at)), otgScale_d(out, part->side), way,
                0, OTG_NOT_THERE);
    }
  }
  return count;
}

/// Moves a way to the place of one before it, and those from there on behind it.
OTG_INLINED void otgMoveWay(__global otg_uneven_way* ways, uint from, uint to) {
  const otg_uneven_way way = ways[from];
  for (uint k = from; k > to; --k) ways[k] = ways[k - 1];
  ways[to] = way;
}

/// The faces nearest to a stretch's middle, behind its `count` ways: how many, if it leaves by all of them at once. 0
/// if that is not far shorter than the soonest of those: as leaveByMiddle in collide/solid/leaving.cpp.
OTG_INLINED uint otgLeaveByMiddle(__local otg_uneven_scratch* s, const otg_uneven* u, const otg_uneven_part* part,
                                  __global otg_uneven_way* ways, uint count, double soonest) {
  const uint exits = otgExitsOf(u, part, soonest / OTG_SOLID_NEIGHBOURHOOD, ways + count);
  if (exits > OTG_UNEVEN_EXITS) {
    s->bad = 1;  // unordered: no lane writes anything else
    return 0;
  }
  double deepest = 0;
  for (uint k = 0; k < exits; ++k) deepest = otgMax_d(ways[count + k].depth, deepest);
  return deepest < soonest ? exits : 0;
}

/// The ways of a stretch, the first `together` of which hold it: how many there are.
OTG_INLINED uint otgWaysOfStretch(__local otg_uneven_scratch* s, const otg_uneven* u, const otg_uneven_part* part,
                                  __global otg_uneven_way* ways, uint* together) {
  const uint count = otgEdgesPassed(u, part, ways, otgFacesOver(u, part, ways, 0));
  uint soonest = 0;  // the first of several
  for (uint k = 1; k < count; ++k) soonest = ways[k].depth < ways[soonest].depth ? k : soonest;
  const uint exits = otgLeaveByMiddle(s, u, part, ways, count, count > 0 ? ways[soonest].depth : INFINITY);
  *together = exits > 0 ? exits : 1;
  for (uint k = 0; k < exits; ++k) otgMoveWay(ways, count + k, k);
  if (exits == 0 && count > 0) otgMoveWay(ways, soonest, 0);
  return count + exits;
}

/// The ways of part `i`, for which there is room.
OTG_INLINED void otgFindWaysOf(__local otg_uneven_scratch* s, const otg_uneven* u, const otg_uneven_part* part,
                               uint i) {
  __global otg_uneven_way* ways = u->ways + s->first[i];
  uint count, together = 1;
  if (part->isVertex) {
    together = otgExitsOf(u, part, INFINITY, ways);
    if (together > OTG_UNEVEN_EXITS) {
      s->bad = 1;  // unordered: no lane writes anything else
      together = 0;
    }
    count = together == 0 ? 0 : otgFacesOver(u, part, ways, together);
  } else {
    count = otgWaysOfStretch(s, u, part, ways, &together);
  }
  if (count > 0) count = otgWithoutSame(ways, together, count);
  const double soonest = count > 0 ? ways[0].depth : 0;
  s->soonest[i] = soonest;
  s->count[i] = soonest > 0 && (part->isVertex || part->reach > u->behind) ? (ushort)count : 0;
  s->together[i] = (ushort)together;
}

#endif  // OTG_UNEVEN_PARTS_H
