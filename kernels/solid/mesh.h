// SPDX-License-Identifier: BSD-3-Clause
// A mesh as the contact model `solid` sees it: see shared/layout/solid_layout.h.
#ifndef OTG_SOLID_MESH_H
#define OTG_SOLID_MESH_H
#include "solid/inlined.h"
#include "walk/pair_walk.h"
//
#define OTG_REAL_DOUBLE
#include "shared/contacts/solid_model.h"
#undef OTG_REAL_DOUBLE
#include "shared/layout/solid_layout.h"

#define OTG_PRAGMA(x) _Pragma(#x)
#define OTG_UNROLLED(n) OTG_PRAGMA(unroll n)

/// Between lanes. A work-group of one lane needs none, and PoCL does not cope with so many of them.
#if OTG_GROUP > 1
#define OTG_SYNC barrier(CLK_LOCAL_MEM_FENCE)
#define OTG_SYNC_ALL barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#else
#define OTG_SYNC
#define OTG_SYNC_ALL
#endif

typedef struct {
  __global const float4* bounds;    ///< two units, then the samples
  __global const uint4* triangles;  ///< four a triangle
  __global const float4* vertices;
  __global const uint4* edges;
  __global const uint* firstSpoke;
  __global const uint* spokes;       ///< half-edges
  __global const uint2* neighbours;  ///< vertex and edge of each
  __global const uint4* rings;
  otg_transform_d pose;  ///< to A's frame
  otg_pair_point center;
  float radius;
  uint nodes, soup, flags;  ///< as otg_device_mesh
  int isB;
} otg_solid_mesh;

/// Where kernels of one work-group for a pair have its meshes: in local memory, which is nearer than that of a lane.
#ifdef OTG_MESHES_LOCAL
#define OTG_MESH __local const otg_solid_mesh
#else
#define OTG_MESH const otg_solid_mesh
#endif

OTG_INLINED otg_solid_mesh otgSolidMesh(__global const float4* meshes, const otg_device_mesh* place,
                                        otg_transform_d bInA, int isB) {
  otg_solid_mesh m;
  m.rings = (__global const uint4*)(meshes + place->rings);
  m.bounds = meshes + place->rings + place->triangles;
  m.triangles = (__global const uint4*)(m.bounds + OTG_SOLID_TRIANGLES);
  m.vertices = (__global const float4*)(m.triangles + 4 * (size_t)place->triangles);
  m.edges = (__global const uint4*)(m.vertices + as_uint(m.bounds[0].w));
  m.firstSpoke = (__global const uint*)(m.edges + as_uint(m.bounds[1].w));
  m.spokes = m.firstSpoke + as_uint(m.bounds[0].w) + 1;
  const uint words = as_uint(m.bounds[0].w) + 1 + 3 * place->triangles;
  m.neighbours = (__global const uint2*)(m.firstSpoke + (words + 1) / 2 * 2);
  m.pose = bInA;
  m.center = place->center;
  m.radius = place->radius;
  m.nodes = place->nodes;
  m.soup = place->soup;
  m.flags = place->flags;
  m.isB = isB;
  return m;
}

OTG_INLINED otg_vec3_d otgInFrame(OTG_MESH* m, otg_vec3_d x) {
  return m->isB ? otgTransform_d(m->pose, x) : x;
}

OTG_INLINED otg_vec3_d otgVertexAt(OTG_MESH* m, uint v) {
  const float4 p = m->vertices[v];
  return otgInFrame(m, otgVec_d((double)p.x, (double)p.y, (double)p.z));
}

OTG_INLINED void otgCornersAt(OTG_MESH* m, uint triangle, otg_vec3_d* out) {
  const uint4 v = m->triangles[4 * (size_t)triangle];
  out[0] = otgVertexAt(m, v.x);
  out[1] = otgVertexAt(m, v.y);
  out[2] = otgVertexAt(m, v.z);
}

OTG_INLINED uint otgOf3(uint4 x, uint k) {
  return k == 0 ? x.x : k == 1 ? x.y : x.z;
}

OTG_INLINED uint otgCornerOf(OTG_MESH* m, uint halfEdge) {
  return otgOf3(m->triangles[4 * (size_t)(halfEdge / 3)], halfEdge % 3);
}
OTG_INLINED uint otgEdgeOf(OTG_MESH* m, uint halfEdge) {
  return otgOf3(m->triangles[4 * (size_t)(halfEdge / 3) + 1], halfEdge % 3);
}
OTG_INLINED uint otgTwinOf(OTG_MESH* m, uint halfEdge) {
  return otgOf3(m->rings[halfEdge / 3], halfEdge % 3) & OTG_RING_HALF_EDGE;
}

/// In the mesh's own frame.
OTG_INLINED otg_vec3_d otgOwnNormal(OTG_MESH* m, uint triangle) {
  __global const double* n = (__global const double*)(m->triangles + 4 * (size_t)triangle + 2);
  return otgVec_d(n[0], n[1], n[2]);
}
OTG_INLINED double otgAreaOf(OTG_MESH* m, uint triangle) {
  return ((__global const double*)(m->triangles + 4 * (size_t)triangle + 2))[3];
}
OTG_INLINED otg_vec3_d otgDirectionInA(OTG_MESH* m, otg_vec3_d d) {
  return m->isB ? otgRotate_d(m->pose, d) : d;
}
OTG_INLINED otg_vec3_d otgDirectionToOwn(OTG_MESH* m, otg_vec3_d d) {
  return m->isB ? otgRotateBack_d(m->pose, d) : d;
}
OTG_INLINED otg_vec3_d otgPointToOwn(OTG_MESH* m, otg_vec3_d p) {
  return m->isB ? otgRotateBack_d(m->pose, otgSub_d(p, m->pose.t)) : p;
}

/// Is the point (in A's frame) in the mesh's bounds, a little enlarged? Behind a sheet there is no end.
OTG_INLINED int otgInBounds(OTG_MESH* m, otg_vec3_d p) {
  if (m->flags & OTG_MESH_SHEET) return 1;
  const otg_vec3_d x = otgPointToOwn(m, p);
  const float4 lo = m->bounds[0], hi = m->bounds[1];
  const double slack = 1e-9 * (double)m->radius;
  return x.x >= (double)lo.x - slack && x.x <= (double)hi.x + slack && x.y >= (double)lo.y - slack &&
         x.y <= (double)hi.y + slack && x.z >= (double)lo.z - slack && x.z <= (double)hi.z + slack;
}

OTG_INLINED otg_vec3_d otgLoad(__global const double* p) {
  return otgVec_d(p[0], p[1], p[2]);
}
OTG_INLINED void otgStore(__global double* p, otg_vec3_d v) {
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}
OTG_INLINED otg_vec3_d otgLower(otg_vec3_d a, otg_vec3_d b) {
  return otgVec_d(b.x < a.x ? b.x : a.x, b.y < a.y ? b.y : a.y, b.z < a.z ? b.z : a.z);
}
OTG_INLINED otg_vec3_d otgHigher(otg_vec3_d a, otg_vec3_d b) {
  return otgVec_d(a.x < b.x ? b.x : a.x, a.y < b.y ? b.y : a.y, a.z < b.z ? b.z : a.z);
}

/// Item `g` of the lists `first` to `end` of a stage, or OTG_NOT_THERE. `lists`: OTG_SOLID_BINS for each stage.
OTG_INLINED uint otgListed(__global const uint* counters, __global const uint* lists, uint pairs, uint stage,
                           uint first, uint end, uint g) {
  for (uint bin = first; bin < end; ++bin) {
    const uint count = counters[OTG_COUNT_SOLID + stage * OTG_SOLID_BINS + bin];
    if (g < count) return lists[((size_t)stage * OTG_SOLID_BINS + bin) * pairs + g];
    g -= count;
  }
  return OTG_NOT_THERE;
}

OTG_INLINED void otgList(__global uint* counters, __global uint* lists, uint pairs, uint stage, uint bin, uint pair) {
  const uint place = atomic_inc(counters + OTG_COUNT_SOLID + stage * OTG_SOLID_BINS + bin);
  lists[((size_t)stage * OTG_SOLID_BINS + bin) * pairs + place] = pair;
}

/// Flags of a pair of a batch of solids that gets contacts of the model `pairwise`. solidPairwise can make those that
/// lie side by side.
OTG_INLINED uint otgPairwiseFlags(__global const otg_pair_state* state, uint flags) {
  const int byHost = state->reduction == OTG_NOT_THERE || (flags & OTG_PAIR_MANY);
  return byHost ? OTG_PAIR_PAIRWISE | OTG_PAIR_TO_HOST : OTG_PAIR_PAIRWISE;
}

#define OTG_COUNTS(s) ((__local uint*)(s)->counts)

/// The place of the lowest bit that is set.
OTG_INLINED uint otgLowestBit(uint bits) {
  return 31 - clz(bits & -bits);
}

/// How many of the lanes' counts come before this lane's; `total` is their sum. `counts` lies at a multiple of 16
/// bytes. All lanes call it.
OTG_INLINED uint otgPlaceAmong(__local uint* counts, uint count, uint* total) {
#if OTG_GROUP > 1
  const uint lane = get_local_id(0);
  uint before = 0, sum = 0;
  OTG_SYNC;
  counts[lane] = count;
  OTG_SYNC;
  __local const uint4* four = (__local const uint4*)counts;
  for (uint k = 0; k < OTG_GROUP; k += 4) {
    const uint4 c = four[k / 4];
    before += (k < lane ? c.x : 0) + (k + 1 < lane ? c.y : 0) + (k + 2 < lane ? c.z : 0) + (k + 3 < lane ? c.w : 0);
    sum += c.x + c.y + c.z + c.w;
  }
  *total = sum;
  return before;
#else
  *total = count;
  return 0;
#endif
}

/// The larger of a value of each lane and 0. All lanes call it.
OTG_INLINED double otgLargestOf(__local double* reduce, double x) {
#if OTG_GROUP > 64
  const uint lane = get_local_id(0);
  OTG_SYNC;
  reduce[lane] = otgMax_d(x, 0);
  OTG_SYNC;
  for (uint half_ = OTG_GROUP / 2; half_ > 0; half_ /= 2) {
    if (lane < half_) reduce[lane] = otgMax_d(reduce[lane + half_], reduce[lane]);
    OTG_SYNC;
  }
  return reduce[0];
#else
  double most = 0;
  OTG_SYNC;
  reduce[get_local_id(0)] = x;
  OTG_SYNC;
  for (uint k = 0; k < OTG_GROUP; ++k) most = otgMax_d(reduce[k], most);
  return most;
#endif
}

#ifdef OTG_MESHES_LOCAL
/// A and B of a pair to `pair`. All lanes call it.
OTG_INLINED void otgTakeMeshes(__local otg_solid_mesh* pair, __global const float4* meshes,
                               __global const otg_batch_task* task, __global const otg_device_mesh* places) {
  for (uint k = get_local_id(0); k < 2; k += OTG_GROUP) {
    const otg_device_mesh place = places[k == 0 ? task->meshA : task->meshB];
    pair[k] = otgSolidMesh(meshes, &place, task->bInA, (int)k);
  }
  OTG_SYNC;
}
#endif

#endif  // OTG_SOLID_MESH_H
