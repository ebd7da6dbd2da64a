// SPDX-License-Identifier: BSD-3-Clause
// Places where a contact may sit: as collide/solid/support_point.cpp.
#ifndef OTG_SOLID_POINT_H
#define OTG_SOLID_POINT_H
#include "solid/mesh.h"

/// Sums of the normals of the faces around a vertex and at an edge, in the mesh's own frame.
OTG_INLINED otg_vec3_d otgNormalOfVertex(OTG_MESH* m, uint v) {
  otg_vec3_d normal = otgVec_d(0, 0, 0);
  for (uint k = m->firstSpoke[v]; k < m->firstSpoke[v + 1]; ++k) {
    normal = otgAdd_d(normal, otgOwnNormal(m, m->spokes[k] / 3));
  }
  return normal;
}
OTG_INLINED otg_vec3_d otgNormalOfEdge(OTG_MESH* m, uint halfEdge) {
  return otgAdd_d(otgOwnNormal(m, halfEdge / 3), otgOwnNormal(m, otgTwinOf(m, halfEdge) / 3));
}

/// A half-edge as the caller numbers triangles.
OTG_INLINED uint otgHalfEdgeOfCaller(OTG_MESH* m, uint halfEdge) {
  return 3 * m->triangles[4 * (size_t)(halfEdge / 3) + 1].w + halfEdge % 3;
}

/// The first half-edge at a vertex or edge, as the caller numbers them.
OTG_INLINED uint otgRankOf(OTG_MESH* m, uint kind, uint feature) {
  uint rank = OTG_NOT_THERE;
  if (kind != OTG_POINT_VERTEX) {
    const uint halfEdge = m->edges[feature].z;
    return min(otgHalfEdgeOfCaller(m, halfEdge), otgHalfEdgeOfCaller(m, otgTwinOf(m, halfEdge)));
  }
  for (uint k = m->firstSpoke[feature]; k < m->firstSpoke[feature + 1]; ++k) {
    rank = min(rank, otgHalfEdgeOfCaller(m, m->spokes[k]));
  }
  return rank;
}

/// The normal of a triangle in A's frame, or zero for OTG_NOT_THERE.
OTG_INLINED otg_vec3_d otgNormalInA(OTG_MESH* m, uint triangle) {
  return triangle == OTG_NOT_THERE ? otgVec_d(0, 0, 0) : otgDirectionInA(m, otgOwnNormal(m, triangle));
}

OTG_INLINED void otgWritePoint(__global otg_solid_point* out, OTG_MESH* m, otg_vec3_d position, otg_vec3_d span,
                               otg_vec3_d normal, otg_vec3_d faceNormal, uint kind, uint feature, uint ordinal,
                               uint own, uint other, int flat) {
  const uint mesh = m->isB ? 1 : 0;
  otgStore(out->position, position);
  otgStore(out->along, otgUnit_d(span));
  out->reach = otgNorm_d(span);
  otgStore(out->surfaceNormal, otgDirectionInA(m, otgUnit_d(normal)));
  otgStore(out->faceNormal, faceNormal);
  out->kind = kind;
  out->mesh = mesh;
  out->feature = feature;
  out->ordinal = ordinal;
  out->triangleA = mesh == 0 ? own : other;
  out->triangleB = mesh == 0 ? other : own;
  out->flat = flat ? 1 : 0;
  out->order =
      (ulong)kind << 62 | (ulong)mesh << 61 | (ulong)otgRankOf(m, kind, feature) << 29 | min(ordinal, 0x1fffffffu);
}

#endif  // OTG_SOLID_POINT_H
