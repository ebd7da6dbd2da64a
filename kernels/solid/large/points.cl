// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids: the candidate points of its large regions, the deepest of each kind in a cell, as PointCells; and
// the results.
#include "solid/large/grid.h"
//
#include "walk/take_now.h"

typedef struct {
  OTG_OVERLAP* o;
  __local const otg_overlap_regions* regions;
  __global otg_overlap_state* state;
  __global ulong* depths;
  __global otg_found_point* out;  ///< null: the deepest are looked for
  uint room;
} otg_offers;

/// `place` gives the cell.
OTG_INLINED void otgOffer(const otg_offers* s, uint r, otg_vec3_d place, uint kind, uint mesh, int flat, uint feature,
                          uint ordinal, otg_vec3_d position, otg_vec3_d span, uint triangle) {
  __local const otg_overlap_region* region = s->regions->region + r;
  const uint key = otgGridCell(place, region->lo, region->pointScale) * 16 + kind * 4 + mesh * 2 + (flat ? 1 : 0);
  __global ulong* deepest = s->depths + region->places + key;
  const ulong depth = otgInOrder((mesh == 0 ? -1 : 1) * otgDot_d(region->up, position));
  if (s->out == 0) {
    // Each key has one candidate that was there first, and others that are as deep as the deepest so far.
    ulong before = *(volatile __global ulong*)deepest;
    if (depth > before) before = atom_max(deepest, depth);
    if (before == 0 || before == depth) atomic_inc(s->state->counts + OTG_OVERLAP_MOST_POINTS);
    return;
  }
  if (*deepest != depth) return;
  const uint at = atomic_inc(s->state->counts + OTG_OVERLAP_POINTS);
  if (at >= s->room) return;
  __global otg_found_point* p = s->out + at;
  otgStore(p->position, position);
  otgStore(p->span, span);
  p->key = key | r << 16;
  p->feature = feature;
  p->ordinal = ordinal;
  p->triangle = triangle;
}

OTG_INLINED uint otgCellCount(__global const otg_overlap_state* state) {
  uint cells = 0;
  for (uint r = 0; r < OTG_OVERLAP_REGIONS; ++r) cells += state->cells[r];
  return cells;
}

/// Where the parts of a pair's results begin, once all but the points are counted.
OTG_INLINED otg_overlap_parts otgPartsOfState(__global const otg_overlap_state* state) {
  return otgPartsOf(otgCellCount(state), state->counts[OTG_OVERLAP_VERTICES], state->counts[OTG_OVERLAP_CLUSTERS],
                    state->counts[OTG_OVERLAP_CROSSINGS], state->counts[OTG_OVERLAP_SMALL]);
}

OTG_INLINED void otgOfferVertex(const otg_offers* s, uint r, uint mesh, uint v, otg_vec3_d x, otg_vec3_d place) {
  otgOffer(s, r, place, OTG_POINT_VERTEX, mesh, otgIsFlatVertex(&s->o->mesh[mesh], v), v, 0, x, otgVec_d(0, 0, 0),
           OTG_NOT_THERE);
}

/// The ends of the stretch at a crossing, as far as they are crossings, and its middle, as seedContourPoints.
OTG_INLINED void otgOfferStretch(const otg_offers* s, uint r, uint slot) {
  OTG_OVERLAP* o = s->o;
  __global const otg_crossing* c = o->crossings + slot;
  const otg_vec3_d origin = s->regions->origin;
  const uint mesh = otgMeshOf(c), edge = otgEdgeOfCrossing(c);
  OTG_MESH* m = &o->mesh[mesh].solid;
  uint from, to;
  if (!otgStretchOf(o, slot, &from, &to)) return;
  const uint4 ends = m->edges[edge];
  const int fromVertex = from == OTG_NOT_THERE, toVertex = to == OTG_NOT_THERE, flat = ends.w == OTG_EDGE_FLAT;
  const otg_vec3_d p = fromVertex ? otgSub_d(otgVertexAt(m, ends.x), origin) : otgPointOfCrossing(o, from, origin);
  const otg_vec3_d q = toVertex ? otgSub_d(otgVertexAt(m, ends.y), origin) : otgPointOfCrossing(o, to, origin);
  const otg_vec3_d d = otgSub_d(q, p);
  const uint stretch = c->stretch;
  if (!fromVertex) {
    otgOffer(s, r, p, OTG_POINT_CROSSING, mesh, flat, edge, 2 * stretch, p, d, o->crossings[from].triangle);
  }
  if (!toVertex) {
    otgOffer(s, r, q, OTG_POINT_CROSSING, mesh, flat, edge, 2 * stretch + 1, q, otgScale_d(d, -1.0),
             o->crossings[to].triangle);
  }
  if (flat || (fromVertex && toVertex)) return;
  const otg_vec3_d middle = otgScale_d(otgAdd_d(p, q), 0.5);
  otgOffer(s, r, middle, fromVertex || toVertex ? OTG_POINT_MIDDLE : OTG_POINT_MIDDLE_OF_CONTOUR, mesh, 0, edge,
           stretch, middle, otgScale_d(d, 0.5), OTG_NOT_THERE);
}

/// Offers all candidates of large regions.
OTG_INLINED void otgOfferAll(const otg_offers* s) {
  OTG_OVERLAP* o = s->o;
  const uint count = s->state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint r = otgNumberOf(s->regions, otgRegionOf(o, o->slots[i]));
    if (r != OTG_NOT_THERE && s->regions->region[r].hasTable) otgOfferStretch(s, r, o->slots[i]);
  }
  const uint vertexCount = s->state->counts[OTG_OVERLAP_VERTICES];
  for (uint i = otgIdFromTheEnd(); i < vertexCount; i += get_global_size(0)) {
    const uint r = otgNumberOf(s->regions, o->vertices[i].region), mesh = o->vertices[i].what & 1,
               v = o->vertices[i].what >> 1;
    if (r == OTG_NOT_THERE || !s->regions->region[r].hasTable) continue;
    const otg_vec3_d x = otgSub_d(otgVertexAt(&o->mesh[mesh].solid, v), s->regions->origin);
    otgOfferVertex(s, r, mesh, v, x, x);
  }
  const uint clusterCount = s->state->counts[OTG_OVERLAP_CLUSTERS], lane = get_global_id(0) % OTG_CLUSTER_LANES;
  for (uint i = otgIdFromHalf() / OTG_CLUSTER_LANES; i < clusterCount; i += get_global_size(0) / OTG_CLUSTER_LANES) {
    const uint r = otgNumberOf(s->regions, o->clusters[i].region), mesh = o->clusters[i].what & 1;
    const uint cluster = o->clusters[i].what >> 1;
    if (r == OTG_NOT_THERE || !s->regions->region[r].hasTable) continue;
    __local const otg_overlap_mesh* m = &o->mesh[mesh];
    __global const float4* c = m->clusters + OTG_CLUSTER_UNITS * cluster;
    otg_vec3_d lo, hi;
    otgBoxInA(m, otgVec_d((double)c[0].x, (double)c[0].y, (double)c[0].z),
              otgVec_d((double)c[1].x, (double)c[1].y, (double)c[1].z), s->regions->origin, &lo, &hi);
    const otg_vec3_d middle = otgScale_d(otgAdd_d(lo, hi), 0.5);
    for (uint k = otgFirstOf(m, cluster) + lane; k < otgFirstOf(m, cluster + 1); k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      otgOfferVertex(s, r, mesh, v, otgSub_d(otgVertexAt(&m->solid, v), s->regions->origin), middle);
    }
  }
}

/// Sums up what the cells of each region say of where out is. Finds how deep the deepest candidate of each kind in each
/// cell is. Every work-group adds all cells of its pair up: they are few. The last one of a pair takes the room for its
/// results.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapDepths(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings,
    __global uint* restrict slots, __global uint* restrict parents, __global otg_found_inside* restrict inside,
    __global const otg_surface_cell* restrict cells, __global const uint* restrict cellList,
    __global ulong* restrict depths, uint tableRoom) {
  __local otg_overlap o;
  __local otg_overlap_regions regions;
  __local long sums[3 * OTG_GROUP];
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, 0, parents, 0, 0, inside, 0));
  const uint lane = get_local_id(0);
  otgLoadRegions(&regions, state, o.crossings, tableRoom);
  // B's surface counts, and A's against it.
  for (uint r = 0; r < regions.count; ++r) {
    __global const uint* list = cellList + regions.region[r].places;
    const uint count = state->cells[r];
    long own[3] = {0, 0, 0};
    OTG_UNROLLED(2)
    for (uint i = lane; i < count; i += OTG_GROUP) {
      const uint key = list[i] & 0xffff;
      __global const otg_surface_cell* c = cells + regions.region[r].places + key;
      for (uint k = 0; k < 3; ++k) own[k] += key & 1 ? c->vector[k] : -c->vector[k];
    }
    otgSumLanes(sums, own, 3);
    if (lane == 0) {
      const double units = regions.region[r].areaUnits;
      const otg_vec3_d up = otgUnit_d(otgVec_d(otgFromUnits(sums[0], units), otgFromUnits(sums[OTG_GROUP], units),
                                               otgFromUnits(sums[2 * OTG_GROUP], units)));
      regions.region[r].up = up;
      // Other work-groups load it meanwhile, and do not use it.
      if (get_group_id(0) == 0) {
        state->up[r][0] = up.x;  // unordered
        state->up[r][1] = up.y;  // unordered
        state->up[r][2] = up.z;  // unordered
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  otg_offers s;
  s.o = &o;
  s.regions = &regions;
  s.state = state;
  s.depths = depths;
  s.out = 0;
  s.room = 0;
  otgOfferAll(&s);
}

/// Units that the results of a pair take.
OTG_INLINED uint otgUnitsOfState(__global const otg_overlap_state* state) {
  return otgPartsOfState(state).points + otgUnitsOf(state->counts[OTG_OVERLAP_MOST_POINTS], sizeof(otg_found_point));
}

/// Takes the room for the results of each pair of a batch. Those of one pair alone begin at 0.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapPlaces(
    uint count, __global otg_overlap_state* restrict states, __global otg_overlap_totals* restrict totals) {
  const uint i = get_global_id(0);
  if (i < count) states[i].firstUnit = atomic_add(&totals->units, otgUnitsOfState(states + i));
}

/// What the host gets to know of a large region.
OTG_INLINED void otgReportRegion(__global otg_found_region* found, __global const otg_crossing* root,
                                 __local const otg_overlap_region* region) {
  found->first = root->first;
  otgStore(found->lo, region->lo);
  otgStore(found->hi, region->hi);
  found->largest = as_double(root->largest);
  found->load = root->load;
  found->pair = get_group_id(1);
}

/// Writes the results and empties everything for the next query. The last kernel: the last work-group of a pair writes
/// the pair's head, that of the last pair the totals. `counters`, if there are any, are those of one pair alone, which
/// end with it, too.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapResults(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_overlap_totals* restrict totals,
    __global otg_crossing* restrict crossings, __global uint* restrict slots, __global otg_overlap_hit* restrict hits,
    __global uint* restrict parents, __global uint* restrict marks, __global otg_found_inside* restrict inside,
    __global otg_surface_cell* restrict cells, __global const uint* restrict cellList,
    __global otg_found_inside* restrict small, __global ulong* restrict depths, uint tableRoom,
    __global uchar* restrict out, uint unitRoom, __global uint* restrict counters) {
  __local otg_overlap o;
  __local otg_overlap_regions regions;
  __local uint last;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, 0, inside, small));
  const uint lane = get_local_id(0), crossingCount = state->counts[OTG_OVERLAP_CROSSINGS];
  const uint vertexCount = state->counts[OTG_OVERLAP_VERTICES], clusterCount = state->counts[OTG_OVERLAP_CLUSTERS];
  const uint smallCount = min(state->counts[OTG_OVERLAP_SMALL], o.hitCount);  // more: the pair was given up
  const otg_overlap_parts parts = otgPartsOfState(state);
  const uint first = state->firstUnit, units = otgUnitsOfState(state);
  const int fits = first <= unitRoom && unitRoom - first >= units;
  __global uchar* body = out + OTG_OVERLAP_HEAD(get_num_groups(1)) + (fits ? (size_t)first * 16 : 0);
  otgLoadRegions(&regions, state, o.crossings, tableRoom);
  if (fits) {
    otg_offers s;
    s.o = &o;
    s.regions = &regions;
    s.state = state;
    s.depths = depths;
    s.out = (__global otg_found_point*)(body + (size_t)parts.points * 16);
    s.room = state->counts[OTG_OVERLAP_MOST_POINTS];
    otgOfferAll(&s);
  }
  uint cellCount = 0;
  for (uint r = 0; r < regions.count; ++r) {
    __global const uint* list = cellList + regions.region[r].places;
    const uint own = state->cells[r];
    for (uint i = get_global_id(0); i < own; i += get_global_size(0)) {
      __global otg_surface_cell* c = cells + regions.region[r].places + (list[i] & 0xffff);
      if (fits) {
        __global otg_found_cell* f = (__global otg_found_cell*)body + cellCount + i;
        for (uint k = 0; k < 3; ++k) {
          f->vector[k] = c->vector[k];
          f->lo[k] = otgFromOrder(~c->low[k]);
          f->hi[k] = otgFromOrder(c->high[k]);
        }
        f->area = c->area;
        f->gross = c->gross;
        f->moment = c->moment;
        f->name = ~c->name;
        f->key = list[i];
      }
      for (uint k = 0; k < 3; ++k) {
        c->vector[k] = 0;
        c->low[k] = 0;
        c->high[k] = 0;
      }
      c->area = 0;
      c->gross = 0;
      c->moment = 0;
      c->name = 0;
      c->used = 0;
    }
    cellCount += own;
  }
  for (uint i = get_global_id(0); i < vertexCount && fits; i += get_global_size(0)) {
    otg_found_inside found = o.vertices[i];
    found.region = otgNumberOf(&regions, found.region);
    ((__global otg_found_inside*)(body + (size_t)parts.vertices * 16))[i] = found;
  }
  for (uint i = get_global_id(0); i < clusterCount && fits; i += get_global_size(0)) {
    otg_found_inside found = o.clusters[i];
    found.region = otgNumberOf(&regions, found.region);
    ((__global otg_found_inside*)(body + (size_t)parts.clusters * 16))[i] = found;
  }
  for (uint i = get_global_id(0); i < smallCount && fits; i += get_global_size(0)) {
    ((__global otg_found_inside*)(body + (size_t)parts.small * 16))[i] = o.small[i];
  }
  for (uint i = get_global_id(0); i < crossingCount; i += get_global_size(0)) {
    const uint slot = o.slots[i];
    __global otg_crossing* c = o.crossings + slot;
    if (fits) {
      __global otg_found_crossing* f = (__global otg_found_crossing*)(body + (size_t)parts.crossings * 16) + i;
      otgStore(f->point, otgPointOfCrossing(&o, slot, regions.origin));
      f->region = otgEndsStretch(&o, slot) ? otgNumberOf(&regions, otgRegionOf(&o, slot)) : OTG_NOT_THERE;
    }
    // No other lane looks at these of this crossing.
    const uint mesh = otgMeshOf(c), edge = otgEdgeOfCrossing(c);
    c->key = 0;
    c->seen = 0;
    const uint4 ends = o.mesh[mesh].solid.edges[edge];
    if (ends.w == OTG_EDGE_INNER) {
      const uint r = otgNumberOf(&regions, otgRegionOf(&o, slot));
      if (r != OTG_NOT_THERE) atomic_or(&state->corners, 1u << r);
    }
    *otgEdgeMark(&o, mesh, edge) = 0;
    for (uint k = 0; k < 2; ++k) {
      const uint v = k == 0 ? ends.x : ends.y, cluster = otgClusterOf(&o.mesh[mesh], v);
      if (cluster < o.mesh[mesh].clusterCount) *otgMixedMark(&o, mesh, cluster) = 0;
    }
  }
  for (uint i = get_global_id(0); i < o.hitCount; i += get_global_size(0)) {
    if (o.hits[i].a == OTG_NOT_THERE || o.hits[i].start == OTG_NOT_THERE) continue;
    *otgTriangleMark(&o, 0, o.hits[i].a) = 0;
    *otgTriangleMark(&o, 1, o.hits[i].b) = 0;
  }
  __global otg_overlap_state* head = (__global otg_overlap_state*)(out + sizeof(otg_overlap_totals)) + get_group_id(1);
  // No work-group returns before the last barrier: PoCL 5 makes one work-item's conditions behind it those of all.
  const int endsPair = otgIsLast(state->counts + OTG_OVERLAP_DONE, &last);
  if (endsPair) {
    if (lane < regions.count) {
      otgReportRegion(head->regions + lane, o.crossings + regions.region[lane].root, regions.region + lane);
    }
    for (uint i = lane; i < OTG_OVERLAP_COUNTS; i += OTG_GROUP) {
      const uint counted = otgTakeNow(state->counts + i);
      head->counts[i] = i == OTG_OVERLAP_CELLS ? cellCount : counted;
    }
    for (uint r = lane; r < OTG_OVERLAP_REGIONS; r += OTG_GROUP) state->cells[r] = 0;  // unordered: by the last
    if (lane < 3) head->origin[lane] = state->origin[lane];
    if (lane == 0) {
      head->firstUnit = first;
      head->corners = otgTakeNow(&state->corners);
      state->first = 0;
      state->firstUnit = 0;  // unordered: by the last
      for (uint k = 0; k < OTG_SOLID_MOST_PARTS / 32; ++k) state->crossedParts[0][k] = state->crossedParts[1][k] = 0;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (lane == 0) last = endsPair && atomic_inc(&totals->done) == get_num_groups(1) - 1;
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (!last) return;
  for (uint i = lane; i < OTG_COUNTERS && counters != 0; i += OTG_GROUP) {
    const uint counted = otgTakeNow(counters + i);
    if (i < OTG_COUNTERS_READ) head->counters[i] = counted;
  }
  if (lane == 0) {
    __global otg_overlap_totals* totalsOut = (__global otg_overlap_totals*)out;
    const uint unitsOfAll = otgTakeNow(&totals->units);
    totalsOut->tables = otgTakeNow(&totals->tables);
    totalsOut->units = get_num_groups(1) == 1 ? first + units : unitsOfAll;
    totalsOut->done = otgTakeNow(&totals->done);
    totalsOut->unused = 0;
  }
}
