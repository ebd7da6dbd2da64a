// SPDX-License-Identifier: BSD-3-Clause
// A pair of solids while their overlap is described by one or many work-groups: the meshes, the elements that regions
// are sets of, and what is inside. See shared/layout/overlap_layout.h.
//
// OTG_GROUP: size of work-groups.
#ifndef OTG_OVERLAP_MESH_H
#define OTG_OVERLAP_MESH_H
#define OTG_MESHES_LOCAL
#include "solid/mesh.h"
//
#define OTG_REAL_DOUBLE
#include "shared/contacts/region_grid.h"
#undef OTG_REAL_DOUBLE
#include "shared/layout/overlap_layout.h"

#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#pragma OPENCL EXTENSION cl_khr_int64_extended_atomics : enable

#define OTG_MOST_TIED 32  ///< crossings of one edge of which some lie in one point

typedef struct {
  otg_solid_mesh solid;
  __global const float4* clusters;  ///< OTG_CLUSTER_UNITS each
  __global const uint *clusterVertices, *clusterNeighbours;
  __global const double* stars;  ///< four a vertex: vector and area
  uint clusterCount;
} otg_overlap_mesh;

/// A pair with its own parts of the arrays of all pairs: in local memory.
typedef struct {
  otg_overlap_mesh mesh[2];
  otg_overlap_sizes sizes;
  uint hitCount;
  __global otg_crossing* crossings;
  __global uint* slots;  ///< of crossings
  __global otg_overlap_hit* hits;
  __global uint *parents, *marks;
  __global int* balances;                          ///< of the sets of vertices: votes for inside less votes for outside
  __global otg_found_inside *clusters, *vertices;  ///< that are inside
  __global otg_found_inside* small;                ///< hits of small regions
} otg_overlap;
#define OTG_OVERLAP __local const otg_overlap

/// The arrays of all pairs.
typedef struct {
  __global otg_crossing* crossings;
  __global uint* slots;
  __global otg_overlap_hit* hits;
  __global uint *parents, *marks;
  __global int* balances;
  __global otg_found_inside *inside, *small;
} otg_overlap_arrays;

/// Those that a kernel does not look at are 0.
OTG_INLINED otg_overlap_arrays otgArrays(__global otg_crossing* crossings, __global uint* slots,
                                         __global otg_overlap_hit* hits, __global uint* parents, __global uint* marks,
                                         __global int* balances, __global otg_found_inside* inside,
                                         __global otg_found_inside* small) {
  otg_overlap_arrays a;
  a.crossings = crossings;
  a.slots = slots;
  a.hits = hits;
  a.parents = parents;
  a.marks = marks;
  a.balances = balances;
  a.inside = inside;
  a.small = small;
  return a;
}

OTG_INLINED otg_overlap_mesh otgOverlapMesh(__global const float4* meshes, const otg_device_mesh* place,
                                            otg_transform_d bInA, int isB) {
  otg_overlap_mesh m;
  m.solid = otgSolidMesh(meshes, place, bInA, isB);
  m.clusters = m.solid.bounds + as_uint(m.solid.bounds[OTG_SOLID_CLUSTERS_AT].w);
  m.clusterCount = as_uint(m.solid.bounds[OTG_SOLID_CLUSTER_COUNT].w);
  const uint vertices = as_uint(m.solid.bounds[0].w);
  m.stars = (__global const double*)(m.clusters + OTG_CLUSTER_UNITS * (m.clusterCount + 1));
  m.clusterVertices = (__global const uint*)(m.stars + 4 * (size_t)vertices);
  m.clusterNeighbours = m.clusterVertices + as_uint(m.clusters[OTG_CLUSTER_UNITS * m.clusterCount].w);
  return m;
}

/// Sets one of the meshes and what is the pair's; lanes 0 and 1 call it.
OTG_INLINED void otgSetOverlap(__local otg_overlap* o, uint which, __global const float4* meshes,
                               const otg_overlap_pair* pair, otg_overlap_arrays arrays) {
  const otg_device_mesh place = which == 0 ? pair->mesh[0] : pair->mesh[1];
  o->mesh[which] = otgOverlapMesh(meshes, &place, pair->bInA, (int)which);
  if (which != 0) return;
  o->sizes = pair->sizes;
  o->hitCount = pair->hits;
  o->crossings = arrays.crossings + pair->firstSlot;
  o->slots = arrays.slots + pair->firstSlot;
  o->hits = arrays.hits + pair->firstHit;
  o->parents = arrays.parents + pair->firstElement;
  o->marks = arrays.marks + pair->firstMark;
  o->balances = arrays.balances + pair->firstInside;
  o->clusters = arrays.inside + pair->firstInside;
  o->vertices = o->clusters + (pair->sizes.vertices[0] - pair->sizes.clusters[0]);
  o->small = arrays.small + pair->firstHit;
}

/// The pair of the work-group. All lanes call it.
OTG_INLINED void otgTakePair(__local otg_overlap* o, __global const float4* meshes,
                             __global const otg_overlap_pair* pairs, otg_overlap_arrays arrays) {
  for (uint k = get_local_id(0); k < 2; k += OTG_GROUP) {
    const otg_overlap_pair pair = pairs[get_group_id(1)];
    otgSetOverlap(o, k, meshes, &pair, arrays);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// Sums of what lanes have, of whole numbers; OTG_GROUP is a power of two. All lanes call it. The sums lie in room[0],
/// room[OTG_GROUP] and so on, until a lane writes there.
OTG_INLINED void otgSumLanes(__local long* room, const long* own, uint sums) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
  for (uint k = 0; k < sums; ++k) room[k * OTG_GROUP + lane] = own[k];
  OTG_SYNC;
  for (uint half_ = OTG_GROUP / 2; half_ > 0; half_ /= 2) {
    if (lane < half_) {
      for (uint k = 0; k < sums; ++k) room[k * OTG_GROUP + lane] += room[k * OTG_GROUP + lane + half_];
    }
    OTG_SYNC;
  }
}

/// For the second loop of a kernel, so that lanes that had nothing to do in the first one begin it.
OTG_INLINED uint otgIdFromTheEnd(void) {
  return get_global_size(0) - 1 - get_global_id(0);
}

/// For the third one.
OTG_INLINED uint otgIdFromHalf(void) {
  return (get_global_id(0) + get_global_size(0) / 2 / OTG_CLUSTER_LANES * OTG_CLUSTER_LANES) % get_global_size(0);
}

/// Whether a work-group is the last of its pair at a counter. All lanes call it.
OTG_INLINED int otgIsLast(__global uint* counter, __local uint* last) {
  barrier(CLK_GLOBAL_MEM_FENCE);
  if (get_local_id(0) == 0) *last = atomic_inc(counter) == get_num_groups(0) - 1;
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  return *last != 0;
}

OTG_INLINED uint otgFirstOf(__local const otg_overlap_mesh* m, uint cluster) {
  return as_uint(m->clusters[OTG_CLUSTER_UNITS * cluster].w);
}
OTG_INLINED uint otgFirstNeighbourOf(__local const otg_overlap_mesh* m, uint cluster) {
  return as_uint(m->clusters[OTG_CLUSTER_UNITS * cluster + 1].w);
}
OTG_INLINED uint otgClusterOf(__local const otg_overlap_mesh* m, uint vertex) {
  return as_uint(m->solid.vertices[vertex].w) & ~OTG_VERTEX_FLAT;
}
OTG_INLINED int otgIsFlatVertex(__local const otg_overlap_mesh* m, uint vertex) {
  return (as_uint(m->solid.vertices[vertex].w) & OTG_VERTEX_FLAT) != 0;
}
OTG_INLINED otg_vec3_d otgStarOf(__local const otg_overlap_mesh* m, uint vertex) {
  return otgDirectionInA(&m->solid, otgLoad(m->stars + 4 * (size_t)vertex));
}

// Marks ---------------------------------------------------------------------------------------------------------------

OTG_INLINED __global uint* otgMixedMark(OTG_OVERLAP* o, uint mesh, uint cluster) {
  return o->marks + o->sizes.mixedMarks[mesh] + cluster;
}
OTG_INLINED __global uint* otgEdgeMark(OTG_OVERLAP* o, uint mesh, uint edge) {
  return o->marks + o->sizes.edgeMarks[mesh] + edge;
}
/// Whether what hangs together over an edge is to be united by this end of it. An edge of a sheet's rim leads from one
/// of its ends only; of other edges the smaller one does it.
OTG_INLINED int otgUnitesFrom(__local const otg_overlap_mesh* m, uint from, uint to) {
  return from < to || (m->solid.flags & OTG_MESH_SHEET) != 0;
}
OTG_INLINED __global uint* otgTriangleMark(OTG_OVERLAP* o, uint mesh, uint triangle) {
  return o->marks + o->sizes.triangleMarks[mesh] + triangle;
}

OTG_INLINED uint otgMeshOf(__global const otg_crossing* c) {
  return ((uint)(c->key >> 32) - 1) & 1;
}
OTG_INLINED uint otgEdgeOfCrossing(__global const otg_crossing* c) {
  return ((uint)(c->key >> 32) - 1) >> 1;
}

// Sets ----------------------------------------------------------------------------------------------------------------

OTG_INLINED uint otgRoot(OTG_OVERLAP* o, uint e) {
  volatile __global uint* parent = o->parents;
  uint up = parent[e];
  while (up != e) {
    const uint next = parent[up];
    if (next != up) parent[e] = next;
    e = up;
    up = next;
  }
  return e;
}

/// The same without making ways shorter: where roots are written meanwhile, which that would undo.
OTG_INLINED uint otgFindRoot(OTG_OVERLAP* o, uint e) {
  volatile __global const uint* parent = o->parents;
  for (uint up = parent[e]; up != e; up = parent[e]) e = up;
  return e;
}

OTG_INLINED void otgSetRoot(OTG_OVERLAP* o, uint e, uint root) {
  *(volatile __global uint*)(o->parents + e) = root;
}

/// The smallest element names the set: a crossing, if there is one in it. By Rem's algorithm, concurrently: goes up
/// from whichever of the two has the greater parent, until both have one parent, and seldom has to go all the way. See
/// Patwary, Blair and Manne, "Experiments on Union-Find Algorithms for the Disjoint-Set Data Structure", 2010.
OTG_INLINED void otgUniteElements(OTG_OVERLAP* o, uint x, uint y) {
  volatile __global uint* parent = o->parents;
  uint aboveX = parent[x], aboveY = parent[y];
  while (aboveX != aboveY) {
    if (aboveX < aboveY) {
      const uint element = x, above = aboveX;
      x = y;
      aboveX = aboveY;
      y = element;
      aboveY = above;
    }
    if (aboveX == x) {  // a root
      aboveX = atomic_cmpxchg(o->parents + x, x, aboveY);
      if (aboveX == x) return;
    } else {
      const uint next = parent[aboveX];
      if (next != aboveX) parent[x] = next;
      x = aboveX;
      aboveX = next;
    }
  }
}

OTG_INLINED uint otgClusterElement(OTG_OVERLAP* o, uint mesh, uint cluster) {
  return o->sizes.clusters[mesh] + cluster;
}
OTG_INLINED uint otgVertexElement(OTG_OVERLAP* o, uint mesh, uint vertex) {
  return o->sizes.vertices[mesh] + vertex;
}

/// The element that a vertex is: itself where its cluster has a crossed edge, else the cluster.
OTG_INLINED uint otgElementOf(OTG_OVERLAP* o, uint mesh, uint vertex) {
  const uint cluster = otgClusterOf(&o->mesh[mesh], vertex);
  const int byItself = cluster >= o->mesh[mesh].clusterCount || *otgMixedMark(o, mesh, cluster) != 0;
  return byItself ? otgVertexElement(o, mesh, vertex) : otgClusterElement(o, mesh, cluster);
}

/// When votes are counted: whether most of those of the vertices that hang together with this one say inside. Others
/// may be uniting such a set with a crossing.
OTG_INLINED int otgIsVotedInside(OTG_OVERLAP* o, uint mesh, uint vertex) {
  const uint root = otgRoot(o, otgElementOf(o, mesh, vertex));
  return root < o->sizes.slots || o->balances[root - o->sizes.slots] > 0;
}

// Behind overlapRegions, which has made parents of crossings and of vertices inside roots: one read, which nothing has
// to wait for.

/// The root of the region that a crossing is in.
OTG_INLINED uint otgRegionOf(OTG_OVERLAP* o, uint slot) {
  return o->parents[slot];
}

/// The root of the region that a vertex lies inside of the other mesh in, or OTG_NOT_THERE: when all is united, sets
/// with a crossing in them are inside. The vertices of others are still sets of their own.
OTG_INLINED uint otgRegionOfVertex(OTG_OVERLAP* o, uint mesh, uint vertex) {
  const uint root = o->parents[otgVertexElement(o, mesh, vertex)];
  return root < o->sizes.slots ? root : OTG_NOT_THERE;
}

// Ordered numbers -----------------------------------------------------------------------------------------------------

/// Doubles as unsigned integers in the same order.
OTG_INLINED ulong otgInOrder(double x) {
  const ulong bits = as_ulong(x + 0.0);  // -0 and 0 are one
  return bits >> 63 ? ~bits : bits | 0x8000000000000000ul;
}
OTG_INLINED double otgFromOrder(ulong x) {
  return as_double(x >> 63 ? x & 0x7ffffffffffffffful : ~x);
}

/// As a rule another lane was there already: that is looked at first.
OTG_INLINED void otgRaise(__global ulong* to, ulong x) {
  if (x > *(volatile __global ulong*)to) atom_max(to, x);
}

OTG_INLINED otg_vec3_d otgPointOfCrossing(OTG_OVERLAP* o, uint slot, otg_vec3_d origin) {
  return otgSub_d(otgLoad(o->crossings[slot].point), origin);
}

/// The inside stretch that a crossing ends (where the edge leaves the other mesh), or that begins at the last crossing:
/// ends that are crossings, or OTG_NOT_THERE for the edge's own ends. 0 if there is none, or it is another crossing's.
OTG_INLINED int otgStretchOf(OTG_OVERLAP* o, uint slot, uint* from, uint* to) {
  __global const otg_crossing* c = o->crossings + slot;
  *from = c->exits ? c->previous : slot;
  *to = c->exits ? slot : OTG_NOT_THERE;
  return c->stretch != OTG_NOT_THERE;
}

/// Whether a stretch inside begins or ends at a crossing. Where crossings or votes contradict each other some have
/// none.
OTG_INLINED int otgEndsStretch(OTG_OVERLAP* o, uint slot) {
  __global const otg_crossing* c = o->crossings + slot;
  const uint named = c->exits || c->next == OTG_NOT_THERE ? slot : c->next;
  return (named == slot || o->crossings[named].exits) && o->crossings[named].stretch != OTG_NOT_THERE;
}

OTG_INLINED void otgGiveUpOverlap(__global otg_overlap_state* state, uint why) {
  atomic_or(state->counts + OTG_OVERLAP_WHY, why);
}

/// OTG_SOLID_OPEN if that is why a hit or a crossing contradicts itself.
OTG_INLINED uint otgIsOpen(OTG_OVERLAP* o, uint why) {
  const uint isSheet = (o->mesh[0].solid.flags | o->mesh[1].solid.flags) & OTG_MESH_SHEET;
  return isSheet && (why & OTG_SOLID_BROKEN) ? OTG_SOLID_OPEN : 0;
}

#endif  // OTG_OVERLAP_MESH_H
