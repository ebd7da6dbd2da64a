// SPDX-License-Identifier: BSD-3-Clause
// One pair of solids: the candidate points of its large regions, the deepest of each kind in a cell, as PointCells; and
// the results.
#include "overlap_grid.h"

typedef struct {
  const otg_overlap* o;
  __local const otg_overlap_regions* regions;
  __global otg_overlap_state* state;
  __global ulong* depths;
  __global otg_found_point* out;  ///< null: the deepest are looked for
  uint room;
} otg_offers;

/// `place` tells the cell.
OTG_INLINED void otgOffer(const otg_offers* s, uint r, otg_vec3_d place, uint kind, uint mesh, int flat, uint feature,
                          uint ordinal, otg_vec3_d position, otg_vec3_d span, uint triangle) {
  __local const otg_overlap_region* region = s->regions->region + r;
  const uint key = otgGridCell(place, region->lo, region->pointScale) * 16 + kind * 4 + mesh * 2 + (flat ? 1 : 0);
  __global ulong* deepest = s->depths + r * OTG_GRID_KEYS + key;
  const ulong depth = otgInOrder((mesh == 0 ? -1 : 1) * otgDot_d(region->up, position));
  if (s->out == 0) {
    otgRaise(deepest, depth);
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

OTG_INLINED void otgOfferVertex(const otg_offers* s, uint r, uint mesh, uint v, otg_vec3_d x, otg_vec3_d place) {
  otgOffer(s, r, place, OTG_POINT_VERTEX, mesh, otgIsFlatVertex(&s->o->mesh[mesh], v), v, 0, x, otgVec_d(0, 0, 0),
           OTG_NOT_THERE);
}

/// The ends of the stretch at a crossing, as far as they are crossings, and its middle, as seedContourPoints.
OTG_INLINED void otgOfferStretch(const otg_offers* s, uint r, uint slot) {
  const otg_overlap* o = s->o;
  __global const otg_crossing* c = o->crossings + slot;
  const otg_vec3_d origin = s->regions->origin;
  const uint mesh = otgMeshOf(c), edge = otgEdgeOfCrossing(c);
  const otg_solid_mesh* m = &o->mesh[mesh].solid;
  uint from, to;
  if (!otgStretchOf(o, slot, &from, &to)) return;
  const uint4 ends = m->edges[edge];
  const int fromVertex = from == OTG_NOT_THERE, toVertex = to == OTG_NOT_THERE, flat = ends.w != 0;
  const otg_vec3_d p = fromVertex ? otgSub_d(otgVertexAt(m, ends.x), origin) : otgPointOfCrossing(o, from, origin);
  const otg_vec3_d q = toVertex ? otgSub_d(otgVertexAt(m, ends.y), origin) : otgPointOfCrossing(o, to, origin);
  const otg_vec3_d d = otgSub_d(q, p);
  const uint stretch = c->exits ? c->rank / 2 : (c->rank + 1) / 2;
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
OTG_INLINED void otgOfferAll(const otg_offers* s, __global const uint* slots, __global const otg_found_inside* vertices,
                             __global const otg_found_inside* clusters) {
  const otg_overlap* o = s->o;
  const uint count = s->state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint r = otgNumberOf(s->regions, otgRoot(o, slots[i]));
    if (r != OTG_NOT_THERE && s->regions->region[r].isLarge) otgOfferStretch(s, r, slots[i]);
  }
  const uint vertexCount = s->state->counts[OTG_OVERLAP_VERTICES];
  for (uint i = get_global_id(0); i < vertexCount; i += get_global_size(0)) {
    const uint r = otgNumberOf(s->regions, vertices[i].region), mesh = vertices[i].what & 1, v = vertices[i].what >> 1;
    if (r == OTG_NOT_THERE || !s->regions->region[r].isLarge) continue;
    const otg_vec3_d x = otgSub_d(otgVertexAt(&o->mesh[mesh].solid, v), s->regions->origin);
    otgOfferVertex(s, r, mesh, v, x, x);
  }
  const uint clusterCount = s->state->counts[OTG_OVERLAP_CLUSTERS], lane = get_global_id(0) % OTG_CLUSTER_LANES;
  for (uint i = get_global_id(0) / OTG_CLUSTER_LANES; i < clusterCount; i += get_global_size(0) / OTG_CLUSTER_LANES) {
    const uint r = otgNumberOf(s->regions, clusters[i].region), mesh = clusters[i].what & 1;
    const uint cluster = clusters[i].what >> 1;
    if (r == OTG_NOT_THERE || !s->regions->region[r].isLarge) continue;
    const otg_overlap_mesh* m = &o->mesh[mesh];
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

/// Sums up what the cells of each region say of where out is, and finds how deep the deepest candidate of each kind in
/// each cell is. Every work-group adds all cells up: they are few.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapDepths(
    const otg_device_pair pair, const otg_transform_d bInA, const otg_overlap_sizes sizes,
    __global const float4* restrict meshes, __global otg_overlap_state* restrict state,
    __global otg_crossing* restrict crossings, __global const uint* restrict slots, __global uint* restrict parents,
    __global const otg_found_inside* restrict vertices, __global const otg_found_inside* restrict clusters,
    __global const otg_surface_cell* restrict cells, __global const uint* restrict cellList,
    __global ulong* restrict depths) {
  __local otg_overlap_regions regions;
  __local long sums[OTG_OVERLAP_REGIONS][3];
  const otg_overlap o = otgOverlapOf(meshes, &pair, bInA, &sizes, crossings, 0, parents, 0);
  const uint lane = get_local_id(0), cellCount = state->counts[OTG_OVERLAP_CELLS];
  otgLoadRegions(&regions, state, crossings);
  for (uint i = lane; i < 3 * OTG_OVERLAP_REGIONS; i += OTG_GROUP) sums[i / 3][i % 3] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  // B's surface counts, and A's against it.
  for (uint i = lane; i < cellCount; i += OTG_GROUP) {
    const uint at = cellList[i], r = at / OTG_GRID_KEYS;
    for (uint k = 0; k < 3; ++k) {
      const long x = cells[at].vector[k];
      atom_add(&sums[r][k], at & 1 ? x : -x);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane < regions.count) {
    const double units = regions.region[lane].areaUnits;
    const otg_vec3_d up = otgUnit_d(otgVec_d(otgFromUnits(sums[lane][0], units), otgFromUnits(sums[lane][1], units),
                                             otgFromUnits(sums[lane][2], units)));
    regions.region[lane].up = up;
    if (get_group_id(0) == 0) otgStore(state->up[lane], up);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  otg_offers s;
  s.o = &o;
  s.regions = &regions;
  s.state = state;
  s.depths = depths;
  s.out = 0;
  s.room = 0;
  otgOfferAll(&s, slots, vertices, clusters);
}

/// Writes the results and empties everything for the next query. The last kernel: its last work-group writes the head.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapResults(
    const otg_device_pair pair, const otg_transform_d bInA, const otg_overlap_sizes sizes,
    __global const float4* restrict meshes, __global uint* restrict counters, uint hitCapacity,
    __global otg_overlap_state* restrict state, __global otg_crossing* restrict crossings,
    __global const uint* restrict slots, __global otg_overlap_hit* restrict hits, __global uint* restrict parents,
    __global uint* restrict marks, __global const otg_found_inside* restrict vertices,
    __global const otg_found_inside* restrict clusters, __global otg_surface_cell* restrict cells,
    __global const uint* restrict cellList, __global const otg_found_inside* restrict small,
    __global ulong* restrict depths, __global uchar* restrict out) {
  __local otg_overlap_regions regions;
  __local uint last;
  const otg_overlap o = otgOverlapOf(meshes, &pair, bInA, &sizes, crossings, hits, parents, marks);
  const uint lane = get_local_id(0), hitCount = min(counters[OTG_COUNT_HITS], hitCapacity);
  const uint crossingCount = state->counts[OTG_OVERLAP_CROSSINGS], cellCount = state->counts[OTG_OVERLAP_CELLS];
  const uint vertexCount = state->counts[OTG_OVERLAP_VERTICES], clusterCount = state->counts[OTG_OVERLAP_CLUSTERS];
  const uint smallCount = min(state->counts[OTG_OVERLAP_SMALL], (uint)OTG_OVERLAP_MOST_SMALL);
  const uint atVertices = otgUnitsOf(cellCount, sizeof(otg_found_cell));
  const uint atClusters = atVertices + otgUnitsOf(vertexCount, sizeof(otg_found_inside));
  const uint atCrossings = atClusters + otgUnitsOf(clusterCount, sizeof(otg_found_inside));
  const uint atSmall = atCrossings + otgUnitsOf(crossingCount, sizeof(otg_found_crossing));
  const uint atPoints = atSmall + otgUnitsOf(smallCount, sizeof(otg_found_inside));
  const int fits = atPoints <= sizes.outUnits;
  __global uchar* body = out + sizeof(otg_overlap_state);
  otgLoadRegions(&regions, state, crossings);
  otg_offers s;
  s.o = &o;
  s.regions = &regions;
  s.state = state;
  s.depths = depths;
  s.out = (__global otg_found_point*)(body + (size_t)atPoints * 16 * fits);
  s.room = fits ? (sizes.outUnits - atPoints) / (sizeof(otg_found_point) / 16) : 0;
  otgOfferAll(&s, slots, vertices, clusters);
  for (uint i = get_global_id(0); i < cellCount; i += get_global_size(0)) {
    const uint at = cellList[i];
    __global otg_surface_cell* c = cells + at;
    if (fits) {
      __global otg_found_cell* f = (__global otg_found_cell*)body + i;
      for (uint k = 0; k < 3; ++k) {
        f->vector[k] = c->vector[k];
        f->lo[k] = otgFromOrder(~c->low[k]);
        f->hi[k] = otgFromOrder(c->high[k]);
      }
      f->area = c->area;
      f->gross = c->gross;
      f->moment = c->moment;
      f->name = ~c->name;
      f->key = at % OTG_GRID_KEYS | at / OTG_GRID_KEYS << 16;
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
  for (uint i = get_global_id(0); i < vertexCount && fits; i += get_global_size(0)) {
    otg_found_inside inside = vertices[i];
    inside.region = otgNumberOf(&regions, inside.region);
    ((__global otg_found_inside*)(body + (size_t)atVertices * 16))[i] = inside;
  }
  for (uint i = get_global_id(0); i < clusterCount && fits; i += get_global_size(0)) {
    otg_found_inside inside = clusters[i];
    inside.region = otgNumberOf(&regions, inside.region);
    ((__global otg_found_inside*)(body + (size_t)atClusters * 16))[i] = inside;
  }
  for (uint i = get_global_id(0); i < smallCount && fits; i += get_global_size(0)) {
    ((__global otg_found_inside*)(body + (size_t)atSmall * 16))[i] = small[i];
  }
  for (uint i = get_global_id(0); i < crossingCount; i += get_global_size(0)) {
    const uint slot = slots[i];
    __global otg_crossing* c = crossings + slot;
    if (fits) {
      __global otg_found_crossing* f = (__global otg_found_crossing*)(body + (size_t)atCrossings * 16) + i;
      otgStore(f->point, otgPointOfCrossing(&o, slot, regions.origin));
      f->region = otgNumberOf(&regions, otgRoot(&o, slot));
    }
    // Nobody else looks at these of this crossing.
    const uint mesh = otgMeshOf(c), edge = otgEdgeOfCrossing(c);
    c->key = 0;
    c->seen = 0;
    const uint4 ends = o.mesh[mesh].solid.edges[edge];
    *otgEdgeMark(&o, mesh, edge) = 0;
    for (uint k = 0; k < 2; ++k) {
      const uint v = k == 0 ? ends.x : ends.y, cluster = otgClusterOf(&o.mesh[mesh], v);
      *otgVotesOf(&o, mesh, v) = 0;
      if (cluster < o.mesh[mesh].clusterCount) *otgMixedMark(&o, mesh, cluster) = 0;
    }
  }
  for (uint i = get_global_id(0); i < hitCount; i += get_global_size(0)) {
    if (hits[i].a == OTG_NOT_THERE || hits[i].start == OTG_NOT_THERE) continue;
    *otgTriangleMark(&o, 0, hits[i].a) = 0;
    *otgTriangleMark(&o, 1, hits[i].b) = 0;
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  if (lane == 0) last = atomic_inc(state->counts + OTG_OVERLAP_DONE) == get_num_groups(0) - 1;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (!last) return;
  __global otg_overlap_state* head = (__global otg_overlap_state*)out;
  if (lane < regions.count) {
    __global otg_found_region* f = head->regions + lane;
    __global const otg_crossing* c = crossings + regions.region[lane].root;
    f->first = c->first;
    otgStore(f->lo, regions.region[lane].lo);
    otgStore(f->hi, regions.region[lane].hi);
    f->largest = as_double(c->largest);
    f->load = c->load;
  }
  for (uint i = lane; i < OTG_OVERLAP_COUNTS; i += OTG_GROUP) {
    head->counts[i] = state->counts[i];
    state->counts[i] = 0;
  }
  for (uint i = lane; i < OTG_COUNTERS; i += OTG_GROUP) {
    if (i < OTG_COUNTERS_READ) head->counters[i] = counters[i];
    counters[i] = 0;
  }
  if (lane < 3) head->origin[lane] = state->origin[lane];
  if (lane == 0) state->first = 0;
}
