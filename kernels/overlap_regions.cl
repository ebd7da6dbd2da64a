// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids: which vertices are inside, and the regions that these and crossings belong to.
#include "overlap_mesh.h"

/// Unites what hangs together over edges that are not crossed: whole clusters, and the vertices of those that have a
/// crossed edge. OTG_CLUSTER_LANES to a cluster.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapUnite(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global uint* restrict parents, __global uint* restrict marks) {
  __local otg_overlap o;
  otgTakePair(&o, meshes, pairs, otgArrays(0, 0, 0, parents, marks, 0, 0));
  const uint lane = get_global_id(0) % OTG_CLUSTER_LANES;
  const uint all = o.mesh[0].clusterCount + o.mesh[1].clusterCount;
  for (uint i = get_global_id(0) / OTG_CLUSTER_LANES; i < all; i += get_global_size(0) / OTG_CLUSTER_LANES) {
    const uint mesh = i >= o.mesh[0].clusterCount, cluster = mesh ? i - o.mesh[0].clusterCount : i;
    __local const otg_overlap_mesh* m = &o.mesh[mesh];
    const uint first = otgFirstOf(m, cluster), end = otgFirstOf(m, cluster + 1);
    const int isMixed = *otgMixedMark(&o, mesh, cluster) != 0;
    const uint own = otgClusterElement(&o, mesh, cluster);
    int besideMixed = isMixed;
    if (!isMixed) {
      const uint begin = otgFirstNeighbourOf(m, cluster), stop = otgFirstNeighbourOf(m, cluster + 1);
      for (uint k = begin; k < stop; ++k) {
        const uint other = m->clusterNeighbours[k];
        if (*otgMixedMark(&o, mesh, other)) {
          besideMixed = 1;
        } else if (other > cluster && (k - begin) % OTG_CLUSTER_LANES == lane) {
          otgUniteElements(&o, own, otgClusterElement(&o, mesh, other));
        }
      }
    }
    for (uint k = first + lane; besideMixed && k < end; k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      const uint mine = isMixed ? otgVertexElement(&o, mesh, v) : own;
      for (uint h = m->solid.firstSpoke[v]; h < m->solid.firstSpoke[v + 1]; ++h) {
        const uint2 spoke = m->solid.neighbours[h];
        if (!*otgMixedMark(&o, mesh, otgClusterOf(m, spoke.x))) continue;  // from there
        if (isMixed && (spoke.x < v || *otgEdgeMark(&o, mesh, spoke.y) != 0)) continue;
        otgUniteElements(&o, mine, otgVertexElement(&o, mesh, spoke.x));
      }
    }
  }
}

/// Enlarges the bounds of a region, which are those of its root.
OTG_INLINED void otgInclude(__global otg_crossing* root, otg_vec3_d p) {
  const ulong x = otgInOrder(p.x), y = otgInOrder(p.y), z = otgInOrder(p.z);
  otgLower64(root->low, x);
  otgLower64(root->low + 1, y);
  otgLower64(root->low + 2, z);
  otgRaise(root->high, x);
  otgRaise(root->high + 1, y);
  otgRaise(root->high + 2, z);
}

/// Adds vertices or chords to a region. Whoever makes it a large one takes its table.
OTG_INLINED void otgLoadRegion(__global otg_crossing* root, uint more, __global otg_overlap_totals* totals) {
  const uint before = atomic_add(&root->load, more);
  if (before <= OTG_SOLID_LARGE_REGION && before + more > OTG_SOLID_LARGE_REGION) {
    root->table = atomic_inc(&totals->tables);
  }
}

/// Lists what is inside, and measures regions: bounds, load, largest part.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapRegions(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_overlap_totals* restrict totals,
    __global otg_crossing* restrict crossings, __global uint* restrict slots, __global otg_overlap_hit* restrict hits,
    __global uint* restrict parents, __global uint* restrict marks, __global otg_found_inside* restrict inside) {
  __local otg_overlap o;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, inside, 0));
  const uint count = state->counts[OTG_OVERLAP_CROSSINGS];
  const ulong firstChord = ~state->first;
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint slot = o.slots[i], root = otgRoot(&o, slot);
    const uint previous = o.crossings[slot].previous;
    otgInclude(o.crossings + root, otgLoad(o.crossings[slot].point));
    if (previous != OTG_NOT_THERE && otgRoot(&o, previous) != root) state->counts[OTG_OVERLAP_SHARED] = 1;
    if (root != slot) continue;
    const uint place = atomic_inc(state->counts + OTG_OVERLAP_REGION_COUNT);
    if (place < OTG_OVERLAP_REGIONS) {
      state->roots[place] = slot;
    } else {
      otgGiveUpOverlap(state, OTG_SOLID_TOO_MANY);
    }
  }
  for (uint i = get_global_id(0); i < o.hitCount; i += get_global_size(0)) {
    const otg_overlap_hit hit = o.hits[i];
    if (hit.a == OTG_NOT_THERE || hit.start == OTG_NOT_THERE) continue;
    const uint root = otgRoot(&o, hit.start);
    const ulong key = (ulong)hit.a << 32 | hit.b;
    otgLower64(&o.crossings[root].first, key);
    otgLoadRegion(o.crossings + root, 1, totals);
    for (uint mesh = 0; mesh < 2; ++mesh) {
      OTG_MESH* m = &o.mesh[mesh].solid;
      const uint triangle = mesh == 0 ? hit.a : hit.b;
      otgRaise(&o.crossings[root].largest, as_ulong(otgAreaOf(m, triangle)));
      // A contour that stays within one triangle whose corners are all inside hangs together with them.
      const uint4 corners = m->triangles[4 * (size_t)triangle];
      const uint x = otgRegionOfVertex(&o, mesh, corners.x);
      if (x != OTG_NOT_THERE && x != root && otgRegionOfVertex(&o, mesh, corners.y) != OTG_NOT_THERE &&
          otgRegionOfVertex(&o, mesh, corners.z) != OTG_NOT_THERE) {
        otgGiveUpOverlap(state, OTG_SOLID_ODD);
      }
    }
    if (key != firstChord) continue;
    // The host's first crossing: the edges of both triangles in turn, A's first.
    uint first = OTG_NOT_THERE;
    for (uint item = 0; item < 6 && first == OTG_NOT_THERE; ++item) {
      const uint mesh = item % 2, triangle = mesh == 0 ? hit.a : hit.b;
      const uint edge = otgEdgeOf(&o.mesh[mesh].solid, 3 * triangle + item / 2);
      const ulong wanted = (ulong)((edge << 1 | mesh) + 1) << 32 | (mesh == 0 ? hit.b : hit.a);
      if (o.crossings[hit.start].key == wanted) first = hit.start;
      if (o.crossings[hit.end].key == wanted) first = hit.end;
    }
    if (first != OTG_NOT_THERE) otgStore(state->origin, otgLoad(o.crossings[first].point));
  }
  const uint lane = get_global_id(0) % OTG_CLUSTER_LANES;
  const uint all = o.mesh[0].clusterCount + o.mesh[1].clusterCount;
  for (uint i = get_global_id(0) / OTG_CLUSTER_LANES; i < all; i += get_global_size(0) / OTG_CLUSTER_LANES) {
    const uint mesh = i >= o.mesh[0].clusterCount, cluster = mesh ? i - o.mesh[0].clusterCount : i;
    __local const otg_overlap_mesh* m = &o.mesh[mesh];
    const int isMixed = *otgMixedMark(&o, mesh, cluster) != 0;
    const uint ofCluster = isMixed ? OTG_NOT_THERE : otgRoot(&o, otgClusterElement(&o, mesh, cluster));
    if (!isMixed && ofCluster >= o.sizes.slots) continue;
    const uint first = otgFirstOf(m, cluster), end = otgFirstOf(m, cluster + 1);
    if (!isMixed && lane == 0) {
      otg_found_inside found;
      found.what = cluster << 1 | mesh;
      found.region = ofCluster;
      o.clusters[atomic_inc(state->counts + OTG_OVERLAP_CLUSTERS)] = found;
      otgLoadRegion(o.crossings + ofCluster, end - first, totals);
      const double area = ((__global const double*)(m->clusters + OTG_CLUSTER_UNITS * cluster + 2))[3];
      otgRaise(&o.crossings[ofCluster].largest, as_ulong(area));
    }
    for (uint k = first + lane; k < end; k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      const uint root = isMixed ? otgRoot(&o, otgVertexElement(&o, mesh, v)) : ofCluster;
      if (root >= o.sizes.slots) continue;
      const otg_vec3_d p = otgVertexAt(&m->solid, v);
      otgInclude(o.crossings + root, p);
      if (!otgInBounds(&o.mesh[1 - mesh].solid, p)) otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
      if (!isMixed) continue;
      if (*otgVotesOf(&o, mesh, v) & OTG_VOTE_OUT) otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
      otg_found_inside found;
      found.what = v << 1 | mesh;
      found.region = root;
      o.vertices[atomic_inc(state->counts + OTG_OVERLAP_VERTICES)] = found;
      otgLoadRegion(o.crossings + root, 1, totals);
      otgRaise(&o.crossings[root].largest, as_ulong(m->stars[4 * (size_t)v + 3]));
    }
  }
}
