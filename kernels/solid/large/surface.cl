// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids: the surface of their large regions, summed up in cells; as describeByCells() in
// collide/solid/region_cells_build.cpp.
#include "solid/large/grid.h"
//
#include "solid/outline.h"

#define OTG_MOST_CHORDS 32  ///< of one triangle

typedef struct {
  OTG_OVERLAP* o;
  __local const otg_overlap_regions* regions;
  __global otg_surface_cell* cells;
  __global uint* cellList;
  __global otg_overlap_state* state;
} otg_surface;

/// As PieceCells::add.
OTG_INLINED void otgAddSurface(const otg_surface* s, uint r, uint mesh, otg_vec3_d place, otg_vec3_d facing, uint name,
                               otg_vec3_d vector, double area, double moment, otg_vec3_d lo, otg_vec3_d hi) {
  __local const otg_overlap_region* region = s->regions->region + r;
  const uint key = otgGridCell(place, region->lo, region->pieceScale) * 16 + otgMainDirection(facing) * 2 + mesh;
  const size_t at = region->places + key;
  __global otg_surface_cell* c = s->cells + at;
  const ulong bounds[6] = {~otgInOrder(lo.x), ~otgInOrder(lo.y), ~otgInOrder(lo.z),
                           otgInOrder(hi.x),  otgInOrder(hi.y),  otgInOrder(hi.z)};
  // As a rule another lane was there already. That is looked at first, and all at once.
  ulong known[6];
  OTG_UNROLLED(6)
  for (uint k = 0; k < 6; ++k) known[k] = *(volatile __global ulong*)(k < 3 ? c->low + k : c->high + (k - 3));
  const uint knownName = *(volatile __global uint*)&c->name, isUsed = *(volatile __global uint*)&c->used;
  const long units = otgInUnits(area, region->areaUnits);
  atom_add(c->vector, otgInUnits(vector.x, region->areaUnits));
  atom_add(c->vector + 1, otgInUnits(vector.y, region->areaUnits));
  atom_add(c->vector + 2, otgInUnits(vector.z, region->areaUnits));
  atom_add(&c->area, units);
  atom_add(&c->gross, units < 0 ? -units : units);
  atom_add(&c->moment, otgInUnits(moment, region->momentUnits));
  OTG_UNROLLED(6)
  for (uint k = 0; k < 6; ++k) {
    if (bounds[k] > known[k]) atom_max(k < 3 ? c->low + k : c->high + (k - 3), bounds[k]);
  }
  if (~name > knownName) atomic_max(&c->name, ~name);
  if (isUsed == 0 && atomic_xchg(&c->used, 1) == 0) {
    s->cellList[region->places + atomic_inc(s->state->cells + r)] = r << 16 | key;
  }
}

OTG_INLINED void otgAddStar(const otg_surface* s, uint r, uint mesh, uint v) {
  __local const otg_overlap_mesh* m = &s->o->mesh[mesh];
  const otg_vec3_d x = otgSub_d(otgVertexAt(&m->solid, v), s->regions->origin), vector = otgStarOf(m, v);
  otgAddSurface(s, r, mesh, x, vector, v | OTG_NAME_OF_VERTEX, vector, m->stars[4 * (size_t)v + 3], otgDot_d(vector, x),
                x, x);
}

/// A triangle on the contour: what its outlines are made of. All is read before the first outline, so that reads do not
/// wait for each other.
typedef struct {
  uint triangle, mesh, chords;
  uint vertex[3], root[3];
  uint first[3];  ///< crossing of the edge, or OTG_NOT_THERE
  int forward[3];
  otg_vec3_d at[3];
  // Of each chord, in the CPU's order, the triangle of the other mesh, the largest first; and what the chord is.
  uint other[OTG_MOST_CHORDS], start[OTG_MOST_CHORDS], end[OTG_MOST_CHORDS], region[OTG_MOST_CHORDS];
} otg_clipped;

/// Its chords: 0 if there are too many.
OTG_INLINED int otgListChords(OTG_OVERLAP* o, uint first, otg_clipped* t) {
  uint count = 0;
  for (uint h = first; h != 0;) {
    const otg_overlap_hit hit = o->hits[h - 1];
    if (count == OTG_MOST_CHORDS) return 0;
    const uint other = t->mesh == 0 ? hit.b : hit.a;
    uint place = count++;
    for (; place > 0 && t->other[place - 1] <= other; --place) {
      t->other[place] = t->other[place - 1];
      t->start[place] = t->start[place - 1];
      t->end[place] = t->end[place - 1];
    }
    t->other[place] = other;
    t->start[place] = hit.start;
    t->end[place] = hit.end;
    h = hit.link[t->mesh];
  }
  for (uint i = 0; i < count; ++i) t->region[i] = otgRegionOf(o, t->start[i]);
  t->chords = count;
  return 1;
}

/// The outline of the part of a triangle that lies in the region of a root: as clipTriangle, in the same order.
OTG_INLINED otg_outline otgOutlineOf(const otg_surface* s, const otg_clipped* t, uint root) {
  OTG_OVERLAP* o = s->o;
  otg_outline outline = otgOutlineFrom(t->at[0]);
  for (uint k = 0; k < 3; ++k) {
    const uint next = k == 2 ? 0 : k + 1;
    const int forward = t->forward[k];
    if (t->first[k] == OTG_NOT_THERE) {
      if (t->root[k] == root && t->root[next] != OTG_NOT_THERE) otgAddToOutline(&outline, t->at[k], t->at[next]);
      continue;
    }
    for (uint slot = t->first[k]; slot != OTG_NOT_THERE;) {
      const uint following = o->crossings[slot].next, region = otgRegionOf(o, slot);
      uint from, to;
      if (otgStretchOf(o, slot, &from, &to) && region == root) {
        // The vertices at the ends of the edge are corners of the triangle.
        const otg_vec3_d p =
            from != OTG_NOT_THERE ? otgPointOfCrossing(o, from, s->regions->origin) : t->at[forward ? k : next];
        const otg_vec3_d q =
            to != OTG_NOT_THERE ? otgPointOfCrossing(o, to, s->regions->origin) : t->at[forward ? next : k];
        if (forward) {
          otgAddToOutline(&outline, p, q);
        } else {
          otgAddToOutline(&outline, q, p);
        }
      }
      slot = following;
    }
  }
  for (uint i = 0; i < t->chords; ++i) {
    if (t->region[i] != root) continue;
    const otg_vec3_d p = otgPointOfCrossing(o, t->start[i], s->regions->origin);
    const otg_vec3_d q = otgPointOfCrossing(o, t->end[i], s->regions->origin);
    if (t->mesh == 0) {
      otgAddToOutline(&outline, p, q);
    } else {
      otgAddToOutline(&outline, q, p);
    }
  }
  return outline;
}

/// The parts of one triangle in large regions, and what is taken off its corners' stars. `hit`: the first of its list.
OTG_INLINED void otgAddClipped(const otg_surface* s, uint mesh, uint triangle, uint hit) {
  OTG_OVERLAP* o = s->o;
  __local const otg_overlap_mesh* m = &o->mesh[mesh];
  const uint4 corners = m->solid.triangles[4 * (size_t)triangle], edges = m->solid.triangles[4 * (size_t)triangle + 1];
  otg_clipped t;
  uint begins[3];
  t.triangle = triangle;
  t.mesh = mesh;
  OTG_UNROLLED(3)
  for (uint k = 0; k < 3; ++k) {
    const uint edge = otgOf3(edges, k);
    t.vertex[k] = otgOf3(corners, k);
    begins[k] = m->solid.edges[edge].x;
    t.first[k] = *otgEdgeMark(o, mesh, edge);
    t.root[k] = otgRegionOfVertex(o, mesh, t.vertex[k]);
    t.at[k] = otgSub_d(otgVertexAt(&m->solid, t.vertex[k]), s->regions->origin);
  }
  for (uint k = 0; k < 3; ++k) {
    t.forward[k] = t.vertex[k] == begins[k];
    uint c = t.first[k];
    while (c != 0 && o->crossings[c - 1].rank != 0) c = o->crossings[c - 1].link;
    t.first[k] = c - 1;  // OTG_NOT_THERE of 0
  }
  if (!otgListChords(o, hit, &t)) {
    otgGiveUpOverlap(s->state, OTG_SOLID_TOO_MANY);
    return;
  }
  const otg_vec3_d normal = otgDirectionInA(&m->solid, otgOwnNormal(&m->solid, triangle));
  for (uint r = 0; r < s->regions->count; ++r) {
    const uint root = s->regions->region[r].root;
    int touches = 0;
    for (uint k = 0; k < 3; ++k) touches |= t.root[k] == root;
    for (uint i = 0; i < t.chords && !touches; ++i) touches = t.region[i] == root;
    if (!touches || !s->regions->region[r].hasTable) continue;
    const otg_outline outline = otgOutlineOf(s, &t, root);
    const double area = outline.any ? 0.5 * otgDot_d(outline.sum, normal) : 0;
    if (area > 0) {  // else nothing, or a sliver turned over
      otgAddSurface(s, r, mesh, otgScale_d(otgAdd_d(outline.lo, outline.hi), 0.5), normal, triangle,
                    otgScale_d(normal, area), area, otgDot_d(normal, t.at[0]) * area, outline.lo, outline.hi);
    }
    const double third = -otgAreaOf(&m->solid, triangle) / 3;
    for (uint k = 0; k < 3; ++k) {
      if (t.root[k] != root) continue;
      const otg_vec3_d vector = otgScale_d(normal, third);
      otgAddSurface(s, r, mesh, t.at[k], otgStarOf(m, t.vertex[k]), triangle, vector, third, otgDot_d(vector, t.at[k]),
                    t.at[k], t.at[k]);
    }
  }
}

/// A cluster that is inside: by one lane if it is flat, else by a lane for each vertex.
OTG_INLINED void otgAddCluster(const otg_surface* s, uint r, uint mesh, uint cluster, uint lane) {
  __local const otg_overlap_mesh* m = &s->o->mesh[mesh];
  const otg_vec3_d origin = s->regions->origin;
  __global const float4* c = m->clusters + OTG_CLUSTER_UNITS * cluster;
  __global const double* sums = (__global const double*)(c + 2);
  const otg_vec3_d own = otgLoad(sums);
  const uint first = otgFirstOf(m, cluster), end = otgFirstOf(m, cluster + 1);
  if (!(otgDot_d(own, own) >= OTG_FLAT_CLUSTER * sums[3] * sums[3])) {
    for (uint k = first + lane; k < end; k += OTG_CLUSTER_LANES) otgAddStar(s, r, mesh, m->clusterVertices[k]);
    return;
  }
  if (lane != 0) return;
  const otg_vec3_d low = otgVec_d((double)c[0].x, (double)c[0].y, (double)c[0].z);
  const otg_vec3_d high = otgVec_d((double)c[1].x, (double)c[1].y, (double)c[1].z);
  const otg_vec3_d vector = otgDirectionInA(&m->solid, own), nothing = otgVec_d(0, 0, 0);
  const otg_vec3_d shift = otgSub_d(otgInFrame(&m->solid, nothing), origin);
  otg_vec3_d lo, hi;
  otgBoxInA(m, low, high, origin, &lo, &hi);
  otgAddSurface(s, r, mesh, otgScale_d(otgAdd_d(lo, hi), 0.5), vector, m->clusterVertices[first] | OTG_NAME_OF_VERTEX,
                vector, sums[3], sums[4] + otgDot_d(vector, shift), lo, hi);
}

/// There is room for as many as there are hits.
OTG_INLINED void otgListSmall(const otg_surface* s, otg_found_inside found) {
  const uint at = atomic_inc(s->state->counts + OTG_OVERLAP_SMALL);
  if (at < s->o->hitCount) {
    s->o->small[at] = found;
  } else {
    otgGiveUpOverlap(s->state, OTG_SOLID_TOO_MANY);
  }
}

/// Whether the region of a root is left to the CPU, which describes all such regions from their hits alone.
OTG_INLINED int otgIsSmall(const otg_surface* s, uint root) {
  return otgNumberOf(s->regions, root) == OTG_NOT_THERE;
}

/// What the CPU cannot know of the triangle of B of a hit of a small region: where among clipped triangles it comes.
OTG_INLINED void otgNoteTriangle(const otg_surface* s, otg_overlap_hit hit) {
  OTG_OVERLAP* o = s->o;
  uint first[2] = {OTG_NOT_THERE, OTG_NOT_THERE};  // in large regions, in small ones
  for (uint h = *otgTriangleMark(o, 1, hit.b); h != 0; h = o->hits[h - 1].link[1]) {
    const otg_overlap_hit other = o->hits[h - 1];
    const int isSmall = otgIsSmall(s, otgRegionOf(o, other.start));
    first[0] = isSmall ? first[0] : min(first[0], other.a);
    first[1] = isSmall ? min(first[1], other.a) : first[1];
  }
  if (hit.a != first[1] || first[0] > first[1]) return;
  otg_found_inside found;
  found.what = hit.b;
  found.region = OTG_FOUND_TRIANGLE | first[0];
  otgListSmall(s, found);
}

/// Whether the CPU, from hits of small regions alone, comes to the same about the end of an edge as from all.
/// `inside`: what the crossing next to it says, of a region that `isSmall`.
OTG_INLINED int otgVotesAlone(const otg_surface* s, uint mesh, uint vertex, int inside, int isSmall) {
  const uint root = otgRegionOfVertex(s->o, mesh, vertex);
  if (root == OTG_NOT_THERE) return !(inside && isSmall);  // it was outvoted, perhaps by crossings of large regions
  return isSmall || !otgIsSmall(s, root);
}

/// What the CPU cannot know of an edge that is crossed in small regions and in large ones: how many stretches of large
/// ones lie before one of a small one, and where among edges it comes. 0 if it cannot describe the small ones by
/// themselves, because it would join crossings of theirs between which there are others.
OTG_INLINED int otgNoteBehind(const otg_surface* s, uint slot) {
  OTG_OVERLAP* o = s->o;
  __global const otg_crossing* all = o->crossings;
  __global const otg_crossing* c = all + slot;
  const int isSmall = otgIsSmall(s, otgRegionOf(o, slot));
  const uint mesh = otgMeshOf(c), edge = otgEdgeOfCrossing(c);
  const uint4 ends = o->mesh[mesh].solid.edges[edge];
  int alone = 1, tied = 0;
  if (c->previous == OTG_NOT_THERE) alone &= otgVotesAlone(s, mesh, ends.x, c->exits != 0, isSmall);
  if (c->next == OTG_NOT_THERE) alone &= otgVotesAlone(s, mesh, ends.y, c->exits == 0, isSmall);
  if (!isSmall) return alone;
  uint others = 0, behind = 0, triangle = OTG_NOT_THERE;
  int isFirst = 1;
  for (uint side = 0; side < 2; ++side) {
    const uint first = side == 0 ? c->previous : c->next;
    uint nearest = OTG_NOT_THERE;
    double last = c->t;
    for (uint d = first; d != OTG_NOT_THERE; d = side == 0 ? all[d].previous : all[d].next) {
      tied |= fabs(all[d].t - last) <= OTG_MOST_TIED * OTG_SOLID_CLOSE_POINTS;
      last = all[d].t;
      if (!otgIsSmall(s, otgRegionOf(o, d))) {
        ++others;
        triangle = min(triangle, all[d].triangle);
        behind += side == 0 && all[d].stretch != OTG_NOT_THERE;
      } else if (nearest == OTG_NOT_THERE) {
        nearest = d;
      }
    }
    if (side == 0) isFirst = nearest == OTG_NOT_THERE;
    // A stretch may lie on this side of it, which the CPU would begin with the nearest crossing of a small region.
    if (first != nearest && (c->exits != 0) == (side == 0)) {
      alone &= nearest != OTG_NOT_THERE && all[nearest].exits == c->exits;
    }
  }
  if (others == 0) return alone;
  otg_found_inside found;
  found.what = edge << 1 | mesh;
  if (isFirst) {
    found.region = OTG_FOUND_EDGE | triangle;
    otgListSmall(s, found);
  }
  alone &= !tied;  // those of large regions may have a part in the order
  if (behind == 0 || c->stretch == OTG_NOT_THERE) return alone;
  found.region = OTG_FOUND_BEHIND | (c->stretch - behind) << OTG_BEHIND_BITS | behind;
  otgListSmall(s, found);
  return alone && c->stretch >> OTG_BEHIND_BITS == 0;  // so many are left to the CPU
}

/// Sums the surface of large regions up, and lists the hits of small ones. Empties the tables of candidates, `depths`.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapSurface(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings,
    __global uint* restrict slots, __global otg_overlap_hit* restrict hits, __global uint* restrict parents,
    __global uint* restrict marks, __global otg_found_inside* restrict inside,
    __global otg_surface_cell* restrict cells, __global uint* restrict cellList,
    __global otg_found_inside* restrict small, __global ulong* restrict depths, uint tableRoom) {
  __local otg_overlap o;
  __local otg_overlap_regions regions;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, 0, inside, small));
  otgLoadRegions(&regions, state, o.crossings, tableRoom);
  otg_surface s;
  s.o = &o;
  s.regions = &regions;
  s.cells = cells;
  s.cellList = cellList;
  s.state = state;
  for (uint r = 0; r < regions.count; ++r) {
    const uint keys = regions.region[r].hasTable ? OTG_GRID_KEYS : 0;
    for (uint i = get_global_id(0); i < keys; i += get_global_size(0)) depths[regions.region[r].places + i] = 0;
  }
  // Where a crossing lies nowhere its edge has no order. That pair was given up; its surface is not needed, and
  // following its edges would not end.
  if (state->counts[OTG_OVERLAP_WHY] != 0) return;
  for (uint i = get_global_id(0); i < 2 * o.hitCount; i += get_global_size(0)) {
    const uint mesh = i & 1;
    const otg_overlap_hit hit = o.hits[i >> 1];
    if (hit.a == OTG_NOT_THERE || hit.start == OTG_NOT_THERE) continue;
    if (mesh == 0 && otgIsSmall(&s, otgRegionOf(&o, hit.start))) {
      otg_found_inside found;
      found.what = hit.a;
      found.region = hit.b;
      otgListSmall(&s, found);
      otgNoteTriangle(&s, hit);
    }
    const uint triangle = mesh == 0 ? hit.a : hit.b;
    if (*otgTriangleMark(&o, mesh, triangle) == (i >> 1) + 1) otgAddClipped(&s, mesh, triangle, (i >> 1) + 1);
  }
  const int isMixed = regions.count > 0 && regions.count < state->counts[OTG_OVERLAP_REGION_COUNT] &&
                      (state->counts[OTG_OVERLAP_SHARED] || state->counts[OTG_OVERLAP_AT_ODDS]);
  const uint crossingCount = isMixed ? state->counts[OTG_OVERLAP_CROSSINGS] : 0;
  for (uint i = get_global_id(0); i < crossingCount; i += get_global_size(0)) {
    if (!otgNoteBehind(&s, o.slots[i])) otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
  }
  const uint vertexCount = state->counts[OTG_OVERLAP_VERTICES];
  for (uint i = otgIdFromTheEnd(); i < vertexCount; i += get_global_size(0)) {
    const uint r = otgNumberOf(&regions, o.vertices[i].region);
    if (r == OTG_NOT_THERE || !regions.region[r].hasTable) continue;
    otgAddStar(&s, r, o.vertices[i].what & 1, o.vertices[i].what >> 1);
  }
  const uint clusterCount = state->counts[OTG_OVERLAP_CLUSTERS], lane = get_global_id(0) % OTG_CLUSTER_LANES;
  for (uint i = otgIdFromHalf() / OTG_CLUSTER_LANES; i < clusterCount; i += get_global_size(0) / OTG_CLUSTER_LANES) {
    const uint r = otgNumberOf(&regions, o.clusters[i].region);
    if (r == OTG_NOT_THERE || !regions.region[r].hasTable) continue;
    otgAddCluster(&s, r, o.clusters[i].what & 1, o.clusters[i].what >> 1, lane);
  }
}
