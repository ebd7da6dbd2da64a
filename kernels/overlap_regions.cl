// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids: which vertices are inside, and the regions that these and crossings belong to.
#include "overlap_mesh.h"

/// The change of t of a crossing as A moves.
OTG_INLINED otg_vec3_d otgDriftOf(OTG_OVERLAP* o, uint slot) {
  __global const otg_crossing* c = o->crossings + slot;
  const uint mesh = otgMeshOf(c);
  OTG_MESH *mine = &o->mesh[mesh].solid, *theirs = &o->mesh[1 - mesh].solid;
  const uint4 ends = mine->edges[otgEdgeOfCrossing(c)];
  otg_vec3_d corners[3], drift;
  otgCornersAt(theirs, c->triangle, corners);
  otgHitPlane_d((int)mesh, otgVertexAt(mine, ends.x), otgVertexAt(mine, ends.y), corners, &drift);
  return drift;
}

/// Puts the crossings of an edge in order if some of them lie in one point, or nearly so: Tracer::orderTies and
/// Tracer::alternate of collide/solid/contour.cpp. By the lane that has the first crossing of the edge's list. Returns
/// OTG_SOLID_*, or 0.
OTG_INLINED uint otgOrderEdge(OTG_OVERLAP* o, uint slot) {
  __global otg_crossing* all = o->crossings;
  if (all[slot].link == 0 || *otgEdgeMark(o, otgMeshOf(all + slot), otgEdgeOfCrossing(all + slot)) != slot + 1) {
    return 0;
  }
  uint first = slot;
  while (all[first].rank != 0) first = all[first].link - 1;
  int tied = 0;
  uint count = 1;
  for (uint c = first, next = all[c].next; next != OTG_NOT_THERE; c = next, next = all[c].next) {
    tied |= all[next].t - all[c].t <= OTG_SOLID_CLOSE_POINTS;
    ++count;
  }
  if (!tied) return 0;
  if (count > OTG_MOST_TIED) return OTG_SOLID_TIE;
  uint along[OTG_MOST_TIED];
  along[0] = first;
  for (uint i = 1; i < count; ++i) along[i] = all[along[i - 1]].next;
  OTG_ROLLED
  for (uint i = 1; i < count; ++i) {
    OTG_ROLLED
    for (uint j = i; j > 0; --j) {
      const uint x = along[j], y = along[j - 1];
      if (all[x].t - all[y].t > OTG_SOLID_ONE_POINT || !otgDriftsBefore_d(otgDriftOf(o, x), otgDriftOf(o, y))) break;
      along[j] = y;
      along[j - 1] = x;
    }
  }
  OTG_ROLLED
  for (uint i = 1; i < count; ++i) {
    const uint exits = all[along[i]].exits;
    if (exits != all[along[i - 1]].exits) continue;
    uint j = i + 1;
    while (j < count && all[along[j]].exits == exits) ++j;
    if (j == count || !(fabs(all[along[j]].t - all[along[i]].t) < OTG_SOLID_CLOSE_POINTS)) break;
    const uint moved = along[j];
    for (; j > i; --j) along[j] = along[j - 1];
    along[i] = moved;
  }
  for (uint i = 0; i < count; ++i) {
    all[along[i]].rank = i;
    all[along[i]].previous = i > 0 ? along[i - 1] : OTG_NOT_THERE;
    all[along[i]].next = i + 1 < count ? along[i + 1] : OTG_NOT_THERE;
  }
  return 0;
}

/// Unites what hangs together over edges that are not crossed: whole clusters, and the vertices of those that have a
/// crossed edge. OTG_CLUSTER_LANES to a cluster. Beside that it puts crossings in order that lie in one point.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapUnite(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings,
    __global uint* restrict slots, __global uint* restrict parents, __global uint* restrict marks) {
  __local otg_overlap o;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, 0, parents, marks, 0, 0, 0));
  // A place that is no number has no order. The pair was given up where there is one.
  const uint count = state->counts[OTG_OVERLAP_WHY] & OTG_SOLID_TIE ? 0 : state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint why = otgOrderEdge(&o, o.slots[i]);
    if (why != 0) otgGiveUpOverlap(state, why);
  }
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

/// Votes for sets of vertices as one work-group has counted them: of the set of either mesh that it met first.
typedef struct {
  uint root[2];
  int balance[2];
} otg_vote_count;

/// What the first or last crossing of an edge says of its end.
OTG_INLINED void otgVoteFor(OTG_OVERLAP* o, __local otg_vote_count* s, uint mesh, uint vertex, int inside) {
  const uint root = otgRoot(o, otgElementOf(o, mesh, vertex));
  const int vote = inside ? 1 : -1;
  const uint known = atomic_cmpxchg(s->root + mesh, OTG_NOT_THERE, root);
  if (known == OTG_NOT_THERE || known == root) {
    atomic_add(s->balance + mesh, vote);
  } else {
    atomic_add(o->balances + (root - o->sizes.slots), vote);
  }
}

/// The first and the last crossing of an edge vote for its ends, as collectVotes in collide/solid/inside.cpp; all that
/// hang together with these get the votes. Unites crossings by stretches inside.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapVotes(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings,
    __global uint* restrict slots, __global uint* restrict parents, __global uint* restrict marks,
    __global int* restrict balances) {
  __local otg_overlap o;
  __local otg_vote_count votes;
  __global otg_overlap_state* state = states + get_group_id(1);
  const uint lane = get_local_id(0);
  if (lane < 2) {
    votes.root[lane] = OTG_NOT_THERE;
    votes.balance[lane] = 0;
  }
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, 0, parents, marks, balances, 0, 0));
  const uint count = state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint slot = o.slots[i];
    __global const otg_crossing* c = o.crossings + slot;
    const uint mesh = otgMeshOf(c), previous = c->previous;
    const uint4 ends = o.mesh[mesh].solid.edges[otgEdgeOfCrossing(c)];
    if (previous == OTG_NOT_THERE) {
      otgVoteFor(&o, &votes, mesh, ends.x, c->exits != 0);
    } else if (o.crossings[previous].exits == c->exits) {
      state->counts[OTG_OVERLAP_AT_ODDS] = 1;
    } else if (c->exits) {
      otgUniteElements(&o, previous, slot);
    }
    if (c->next == OTG_NOT_THERE) otgVoteFor(&o, &votes, mesh, ends.y, c->exits == 0);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane < 2 && votes.root[lane] != OTG_NOT_THERE) {
    atomic_add(o.balances + (votes.root[lane] - o.sizes.slots), votes.balance[lane]);
  }
}

/// Whether an end of an edge is inside; notes it if a vote says otherwise. As many votes for inside as for outside are
/// the host's, which asks a ray.
OTG_INLINED int otgEndIsInside(OTG_OVERLAP* o, uint mesh, uint vertex, int vote, __global otg_overlap_state* state) {
  const uint root = otgRoot(o, otgElementOf(o, mesh, vertex));
  const int balance = root < o->sizes.slots ? 1 : o->balances[root - o->sizes.slots];
  if (balance == 0) otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
  if ((balance > 0) != (vote != 0)) state->counts[OTG_OVERLAP_AT_ODDS] = 1;
  return balance > 0;
}

/// Unites vertices inside with crossings, and numbers the stretches inside along each edge; as EdgePieces::collect.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapJoin(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings,
    __global uint* restrict slots, __global otg_overlap_hit* restrict hits, __global uint* restrict parents,
    __global uint* restrict marks, __global int* restrict balances) {
  __local otg_overlap o;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, balances, 0, 0));
  // Without an order there is no end of a walk along an edge.
  const uint count = state->counts[OTG_OVERLAP_WHY] & OTG_SOLID_TIE ? 0 : state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint slot = o.slots[i];
    __global otg_crossing* c = o.crossings + slot;
    const uint mesh = otgMeshOf(c);
    const uint4 ends = o.mesh[mesh].solid.edges[otgEdgeOfCrossing(c)];
    uint before = 0;
    int isStretch = 0;
    if (c->previous == OTG_NOT_THERE) {
      const int inside = otgEndIsInside(&o, mesh, ends.x, c->exits != 0, state);
      isStretch = inside && c->exits;
      if (isStretch) otgUniteElements(&o, slot, otgElementOf(&o, mesh, ends.x));
    } else {
      uint d = c->previous;
      isStretch = c->exits && !o.crossings[d].exits;
      for (uint e = o.crossings[d].previous; e != OTG_NOT_THERE; d = e, e = o.crossings[d].previous) {
        before += o.crossings[d].exits && !o.crossings[e].exits;
      }
      if (o.crossings[d].exits) before += otgIsVotedInside(&o, mesh, ends.x) ? 1 : 0;
    }
    if (c->next == OTG_NOT_THERE) {
      const int inside = otgEndIsInside(&o, mesh, ends.y, c->exits == 0, state);
      if (inside && !c->exits) {
        isStretch = 1;
        otgUniteElements(&o, slot, otgElementOf(&o, mesh, ends.y));
      }
    }
    if (isStretch) c->stretch = before;
  }
  // A contour that stays within one triangle whose corners are all inside hangs together with them.
  for (uint i = get_global_id(0); i < 2 * o.hitCount; i += get_global_size(0)) {
    const uint mesh = i & 1;
    const otg_overlap_hit hit = o.hits[i >> 1];
    if (hit.a == OTG_NOT_THERE || hit.start == OTG_NOT_THERE) continue;
    const uint4 corners = o.mesh[mesh].solid.triangles[4 * (size_t)(mesh == 0 ? hit.a : hit.b)];
    if (otgIsVotedInside(&o, mesh, corners.x) && otgIsVotedInside(&o, mesh, corners.y) &&
        otgIsVotedInside(&o, mesh, corners.z)) {
      otgUniteElements(&o, hit.start, otgElementOf(&o, mesh, corners.x));
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
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, 0, inside, 0));
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
      otgRaise(&o.crossings[root].largest, as_ulong(otgAreaOf(m, mesh == 0 ? hit.a : hit.b)));
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
      otg_found_inside found;
      found.what = v << 1 | mesh;
      found.region = root;
      o.vertices[atomic_inc(state->counts + OTG_OVERLAP_VERTICES)] = found;
      otgLoadRegion(o.crossings + root, 1, totals);
      otgRaise(&o.crossings[root].largest, as_ulong(m->stars[4 * (size_t)v + 3]));
    }
  }
}
