// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids: which vertices are inside, and the regions that these and crossings belong to.
#include "solid/large/mesh.h"

#define OTG_SPOKE_LANES 8                                      ///< for the neighbours of a vertex
#define OTG_MIXED_LANES (OTG_CLUSTER_LANES * OTG_SPOKE_LANES)  ///< for a cluster with a crossed edge

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
      if (all[x].t - all[y].t > OTG_SOLID_ONE_POINT ||
          !otgCrossesBefore_d(otgDriftOf(o, x), all[x].exits, otgDriftOf(o, y), all[y].exits)) {
        break;
      }
      along[j] = y;
      along[j - 1] = x;
    }
  }
  uint leaving = 0;
  for (uint i = 0; i < count; ++i) leaving += all[along[i]].exits != 0;
  uint expected = 2 * leaving == count ? all[along[0]].exits != 0 : 2 * leaving > count;
  OTG_ROLLED
  for (uint i = 0; i < count; ++i, expected = !expected) {
    uint j = i;
    while (j < count && (all[along[j]].exits != 0) != expected) ++j;
    if (j == i) continue;
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

/// Unites a vertex of a cluster with a crossed edge with the neighbour at a spoke. Edges between two such clusters are
/// seen from both ends, but for those of a sheet's rim.
OTG_INLINED void otgUniteAlong(OTG_OVERLAP* o, uint mesh, uint v, uint spoke) {
  __local const otg_overlap_mesh* m = &o->mesh[mesh];
  const uint2 to = m->solid.neighbours[spoke];
  const uint cluster = otgClusterOf(m, to.x);
  const int isMixed = *otgMixedMark(o, mesh, cluster) != 0;
  if (*otgEdgeMark(o, mesh, to.y) != 0 || (isMixed && !otgUnitesFrom(m, v, to.x))) return;
  const uint other = isMixed ? otgVertexElement(o, mesh, to.x) : otgClusterElement(o, mesh, cluster);
  otgUniteElements(o, otgVertexElement(o, mesh, v), other);
}

/// Unites what hangs together over edges that are not crossed: whole clusters, and the vertices of those that have a
/// crossed edge. A lane has one pair of neighbours, because to unite them is a chain of reads that wait for each other.
/// Beside that it puts crossings in order that lie in one point.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapUnite(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings,
    __global uint* restrict slots, __global uint* restrict parents, __global uint* restrict marks,
    __global otg_found_inside* restrict inside) {
  __local otg_overlap o;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, 0, parents, marks, 0, inside, 0));
  const uint mixedCount = state->counts[OTG_OVERLAP_MIXED];
  for (uint i = get_global_id(0); i / OTG_MIXED_LANES < mixedCount; i += get_global_size(0)) {
    const uint what = o.clusters[i / OTG_MIXED_LANES].what, mesh = what & 1, cluster = what >> 1;
    const uint vertex = i % OTG_MIXED_LANES / OTG_SPOKE_LANES, spoke = i % OTG_SPOKE_LANES;
    __local const otg_overlap_mesh* m = &o.mesh[mesh];
    for (uint k = otgFirstOf(m, cluster) + vertex; k < otgFirstOf(m, cluster + 1); k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      for (uint h = m->solid.firstSpoke[v] + spoke; h < m->solid.firstSpoke[v + 1]; h += OTG_SPOKE_LANES) {
        otgUniteAlong(&o, mesh, v, h);
      }
    }
  }
  const uint lane = get_global_id(0) % OTG_CLUSTER_LANES;
  const uint all = o.mesh[0].clusterCount + o.mesh[1].clusterCount;
  for (uint i = otgIdFromHalf() / OTG_CLUSTER_LANES; i < all; i += get_global_size(0) / OTG_CLUSTER_LANES) {
    const uint mesh = i >= o.mesh[0].clusterCount, cluster = mesh ? i - o.mesh[0].clusterCount : i;
    __local const otg_overlap_mesh* m = &o.mesh[mesh];
    const uint stop = otgFirstNeighbourOf(m, cluster + 1), own = otgClusterElement(&o, mesh, cluster);
    if (*otgMixedMark(&o, mesh, cluster) != 0) continue;
    for (uint k = otgFirstNeighbourOf(m, cluster) + lane; k < stop; k += OTG_CLUSTER_LANES) {
      const uint other = m->clusterNeighbours[k];
      if (!otgUnitesFrom(m, cluster, other) || *otgMixedMark(&o, mesh, other) != 0) continue;  // from there
      otgUniteElements(&o, own, otgClusterElement(&o, mesh, other));
    }
    // Of a sheet the other end may not know of an edge: see otgUnitesFrom.
    const uint end = m->solid.flags & OTG_MESH_SHEET ? otgFirstOf(m, cluster + 1) : 0;
    for (uint k = otgFirstOf(m, cluster) + lane; k < end; k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      for (uint h = m->solid.firstSpoke[v]; h < m->solid.firstSpoke[v + 1]; ++h) {
        const uint to = m->solid.neighbours[h].x;
        if (*otgMixedMark(&o, mesh, otgClusterOf(m, to)) == 0) continue;
        otgUniteElements(&o, own, otgVertexElement(&o, mesh, to));
      }
    }
  }
  // A place that is no number has no order. The pair was given up where there is one.
  const uint count = state->counts[OTG_OVERLAP_WHY] & OTG_SOLID_TIE ? 0 : state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = otgIdFromTheEnd(); i < count; i += get_global_size(0)) {
    const uint why = otgOrderEdge(&o, o.slots[i]);
    if (why != 0) otgGiveUpOverlap(state, why);
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
      if (otgIsOpen(&o, OTG_SOLID_BROKEN)) otgGiveUpOverlap(state, OTG_SOLID_BROKEN | OTG_SOLID_OPEN);
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
/// left to the CPU, which casts a ray.
OTG_INLINED int otgEndIsInside(OTG_OVERLAP* o, uint mesh, uint vertex, int vote, __global otg_overlap_state* state) {
  const uint root = otgRoot(o, otgElementOf(o, mesh, vertex));
  const int balance = root < o->sizes.slots ? 1 : o->balances[root - o->sizes.slots];
  if (balance == 0) otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
  if ((balance > 0) != (vote != 0)) state->counts[OTG_OVERLAP_AT_ODDS] = 1;
  return balance > 0;
}

/// Whether the contour comes back to a chord without leaving its triangle of a mesh.
OTG_INLINED int otgStaysWithin(OTG_OVERLAP* o, uint mesh, uint chord) {
  uint at = chord;
  for (uint steps = 0; steps < o->hitCount; ++steps) {
    __global const otg_crossing* c = o->crossings + o->hits[at].end;
    if (otgMeshOf(c) == mesh) return 0;
    at = c->chord;
    if (at == chord) return 1;
    if (at >= o->hitCount) return 0;
  }
  return 0;
}

/// A contour that stays within one triangle whose corners are all inside hangs together with them.
OTG_INLINED void otgUniteWithCorners(OTG_OVERLAP* o, uint mesh, uint chord) {
  OTG_MESH* m = &o->mesh[mesh].solid;
  const size_t at = 4 * (size_t)(mesh == 0 ? o->hits[chord].a : o->hits[chord].b);
  const uint4 corners = m->triangles[at], edges = m->triangles[at + 1];
  if (!otgIsVotedInside(o, mesh, corners.x) || !otgIsVotedInside(o, mesh, corners.y) ||
      !otgIsVotedInside(o, mesh, corners.z)) {
    return;
  }
  int isCrossed = 0;
  for (uint k = 0; k < 3; ++k) isCrossed |= *otgEdgeMark(o, mesh, otgOf3(edges, k)) != 0;
  if (isCrossed && !otgStaysWithin(o, mesh, chord)) return;
  otgUniteElements(o, o->hits[chord].start, otgElementOf(o, mesh, corners.x));
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
  for (uint i = otgIdFromTheEnd(); i < 2 * o.hitCount; i += get_global_size(0)) {
    const otg_overlap_hit hit = o.hits[i >> 1];
    if (hit.a != OTG_NOT_THERE && hit.start != OTG_NOT_THERE) otgUniteWithCorners(&o, i & 1, i >> 1);
  }
}

/// What one lane, and in the end a work-group, has to add to a region: else tens of thousands would wait for each other
/// at the same few places.
typedef struct {
  uint root, load;
  /// Bounds as ordered numbers and the smallest chord, the lower ones inverted; the largest part.
  ulong most[8];
} otg_share;
#define OTG_SHARE_HIGH 3
#define OTG_SHARE_FIRST 6
#define OTG_SHARE_LARGEST 7

OTG_INLINED void otgClearShare(otg_share* s, uint root) {
  s->root = root;
  s->load = 0;
  OTG_UNROLLED(8)
  for (uint k = 0; k < 8; ++k) s->most[k] = 0;
}

/// What shares are handed in to.
typedef struct {
  __global otg_overlap_state* state;
  __global otg_overlap_totals* totals;
} otg_counted;

/// Hands a share on to its region. Whoever makes that a large one gives it its number and its table.
OTG_INLINED void otgHandIn(OTG_OVERLAP* o, const otg_share* s, const otg_counted* counted) {
  if (s->root == OTG_NOT_THERE) return;
  __global otg_crossing* root = o->crossings + s->root;
  // As a rule another lane was there already. That is looked at first, and all at once.
  ulong known[8];
  OTG_UNROLLED(3)
  for (uint k = 0; k < 3; ++k) {
    known[k] = ~*(volatile __global ulong*)(root->low + k);
    known[OTG_SHARE_HIGH + k] = *(volatile __global ulong*)(root->high + k);
  }
  known[OTG_SHARE_FIRST] = ~*(volatile __global ulong*)&root->first;
  known[OTG_SHARE_LARGEST] = *(volatile __global ulong*)&root->largest;
  OTG_UNROLLED(3)
  for (uint k = 0; k < 3; ++k) {
    if (s->most[k] > known[k]) atom_min(root->low + k, ~s->most[k]);
    if (s->most[OTG_SHARE_HIGH + k] > known[OTG_SHARE_HIGH + k]) atom_max(root->high + k, s->most[OTG_SHARE_HIGH + k]);
  }
  if (s->most[OTG_SHARE_FIRST] > known[OTG_SHARE_FIRST]) atom_min(&root->first, ~s->most[OTG_SHARE_FIRST]);
  if (s->most[OTG_SHARE_LARGEST] > known[OTG_SHARE_LARGEST]) atom_max(&root->largest, s->most[OTG_SHARE_LARGEST]);
  if (s->load == 0) return;
  const uint before = atomic_add(&root->load, s->load);
  if (before > OTG_SOLID_LARGE_REGION || before + s->load <= OTG_SOLID_LARGE_REGION) return;
  const uint number = atomic_inc(counted->state->counts + OTG_OVERLAP_LARGE);
  if (number < OTG_OVERLAP_REGIONS) {
    counted->state->roots[number] = s->root;
    root->table = atomic_inc(&counted->totals->tables);
  } else {
    otgGiveUpOverlap(counted->state, OTG_SOLID_TOO_MANY);
  }
}

/// Makes a share that of a region. Lanes seldom go from one to another.
OTG_INLINED void otgTurnTo(OTG_OVERLAP* o, otg_share* s, uint root, const otg_counted* counted) {
  if (s->root == root) return;
  otgHandIn(o, s, counted);
  otgClearShare(s, root);
}

OTG_INLINED void otgAddMost(otg_share* s, uint k, ulong x) {
  s->most[k] = max(s->most[k], x);
}
OTG_INLINED void otgInclude(otg_share* s, otg_vec3_d p) {
  const ulong x[3] = {otgInOrder(p.x), otgInOrder(p.y), otgInOrder(p.z)};
  OTG_UNROLLED(3)
  for (uint k = 0; k < 3; ++k) {
    otgAddMost(s, k, ~x[k]);
    otgAddMost(s, OTG_SHARE_HIGH + k, x[k]);
  }
}

typedef struct {
  ulong most[8][OTG_GROUP];
  uint load[OTG_GROUP];
  uint4 counts[(OTG_GROUP + 3) / 4];  ///< a word for each lane
  uint root, first[2];
} otg_share_scratch;

/// Hands the shares of all lanes in: together those of one region, which is that of most as a rule. All lanes call it.
OTG_INLINED void otgHandInAll(__local otg_share_scratch* l, OTG_OVERLAP* o, otg_share* s,
                              const otg_counted* counted) {
  const uint lane = get_local_id(0);
  if (lane == 0) l->root = OTG_NOT_THERE;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (s->root != OTG_NOT_THERE) atomic_min(&l->root, s->root);
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint root = l->root;
  if (s->root != root) {
    otgHandIn(o, s, counted);
    otgClearShare(s, root);
  }
  OTG_UNROLLED(8)
  for (uint k = 0; k < 8; ++k) l->most[k][lane] = s->most[k];
  l->load[lane] = s->load;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint half_ = OTG_GROUP / 2; half_ > 0; half_ /= 2) {
    if (lane < half_) {
      for (uint k = 0; k < 8; ++k) l->most[k][lane] = max(l->most[k][lane], l->most[k][lane + half_]);
      l->load[lane] += l->load[lane + half_];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (lane != 0) return;
  for (uint k = 0; k < 8; ++k) s->most[k] = l->most[k][0];
  s->load = l->load[0];
  otgHandIn(o, s, counted);
}

/// The place for what a lane has to list, in a list that work-groups take parts of. All lanes call it.
OTG_INLINED uint otgPlaceInList(__local otg_share_scratch* l, uint count, __global uint* counter, uint which) {
  uint total;
  const uint before = otgPlaceAmong((__local uint*)l->counts, count, &total);
  if (get_local_id(0) == 0 && total > 0) l->first[which] = atomic_add(counter, total);
  barrier(CLK_LOCAL_MEM_FENCE);
  return l->first[which] + before;
}

/// Lists what is inside, and measures regions: bounds, load, largest part. From here on parents of crossings and of
/// vertices are roots (otgRegionOf, otgRegionOfVertex).
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapRegions(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_overlap_totals* restrict totals,
    __global otg_crossing* restrict crossings, __global uint* restrict slots, __global otg_overlap_hit* restrict hits,
    __global uint* restrict parents, __global uint* restrict marks, __global otg_found_inside* restrict inside) {
  __local otg_overlap o;
  __local otg_share_scratch scratch;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, 0, inside, 0));
  otg_counted counted;
  counted.state = state;
  counted.totals = totals;
  otg_share share;
  otgClearShare(&share, OTG_NOT_THERE);
  const uint count = state->counts[OTG_OVERLAP_CROSSINGS];
  const ulong firstChord = ~state->first;
  // Where votes are at odds the contour of a sheet may be open.
  if (state->counts[OTG_OVERLAP_AT_ODDS] != 0 && otgIsOpen(&o, OTG_SOLID_BROKEN)) {
    otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
  }
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint slot = o.slots[i], root = otgFindRoot(&o, slot);
    const uint previous = o.crossings[slot].previous;
    otgSetRoot(&o, slot, root);
    otgTurnTo(&o, &share, root, &counted);
    otgInclude(&share, otgLoad(o.crossings[slot].point));
    if (previous != OTG_NOT_THERE && otgFindRoot(&o, previous) != root) state->counts[OTG_OVERLAP_SHARED] = 1;
    if (root == slot) atomic_inc(state->counts + OTG_OVERLAP_REGION_COUNT);
  }
  for (uint i = otgIdFromTheEnd(); i < o.hitCount; i += get_global_size(0)) {
    const otg_overlap_hit hit = o.hits[i];
    if (hit.a == OTG_NOT_THERE || hit.start == OTG_NOT_THERE) continue;
    const uint root = otgFindRoot(&o, hit.start);
    const ulong key = (ulong)hit.a << 32 | hit.b;
    otgTurnTo(&o, &share, root, &counted);
    otgAddMost(&share, OTG_SHARE_FIRST, ~key);
    ++share.load;
    for (uint mesh = 0; mesh < 2; ++mesh) {
      OTG_MESH* m = &o.mesh[mesh].solid;
      otgAddMost(&share, OTG_SHARE_LARGEST, as_ulong(otgAreaOf(m, mesh == 0 ? hit.a : hit.b)));
    }
    if (key != firstChord) continue;
    // The CPU's first crossing: the edges of both triangles in turn, A's first.
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
  const uint lane = get_global_id(0) % OTG_CLUSTER_LANES, begin = otgIdFromHalf() / OTG_CLUSTER_LANES;
  const uint all = o.mesh[0].clusterCount + o.mesh[1].clusterCount, step = get_global_size(0) / OTG_CLUSTER_LANES;
  uint vertexCount = 0, clusterCount = 0;
  for (uint i = begin; i < all; i += step) {
    const uint mesh = i >= o.mesh[0].clusterCount, cluster = mesh ? i - o.mesh[0].clusterCount : i;
    __local const otg_overlap_mesh* m = &o.mesh[mesh];
    const int isMixed = *otgMixedMark(&o, mesh, cluster) != 0;
    const uint element = otgClusterElement(&o, mesh, cluster);
    const uint ofCluster = isMixed ? OTG_NOT_THERE : otgFindRoot(&o, element);
    if (!isMixed && ofCluster >= o.sizes.slots) continue;
    const uint first = otgFirstOf(m, cluster), end = otgFirstOf(m, cluster + 1);
    if (!isMixed && lane == 0) {
      otgSetRoot(&o, element, ofCluster);
      ++clusterCount;
      otgTurnTo(&o, &share, ofCluster, &counted);
      share.load += end - first;
      const double area = ((__global const double*)(m->clusters + OTG_CLUSTER_UNITS * cluster + 2))[3];
      otgAddMost(&share, OTG_SHARE_LARGEST, as_ulong(area));
    }
    for (uint k = first + lane; k < end; k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      const uint root = isMixed ? otgFindRoot(&o, otgVertexElement(&o, mesh, v)) : ofCluster;
      if (root >= o.sizes.slots) continue;
      otgSetRoot(&o, otgVertexElement(&o, mesh, v), root);
      const otg_vec3_d p = otgVertexAt(&m->solid, v);
      otgTurnTo(&o, &share, root, &counted);
      otgInclude(&share, p);
      if (!otgInBounds(&o.mesh[1 - mesh].solid, p)) otgGiveUpOverlap(state, OTG_SOLID_BROKEN);
      if (!isMixed) continue;
      ++vertexCount;
      ++share.load;
      otgAddMost(&share, OTG_SHARE_LARGEST, as_ulong(m->stars[4 * (size_t)v + 3]));
    }
  }
  otgHandInAll(&scratch, &o, &share, &counted);
  // The same way once more, now that it is known how much each has to list.
  uint vertexPlace = otgPlaceInList(&scratch, vertexCount, state->counts + OTG_OVERLAP_VERTICES, 0);
  uint clusterPlace = otgPlaceInList(&scratch, clusterCount, state->counts + OTG_OVERLAP_CLUSTERS, 1);
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint i = begin; i < all && vertexCount + clusterCount > 0; i += step) {
    const uint mesh = i >= o.mesh[0].clusterCount, cluster = mesh ? i - o.mesh[0].clusterCount : i;
    __local const otg_overlap_mesh* m = &o.mesh[mesh];
    otg_found_inside found;
    if (*otgMixedMark(&o, mesh, cluster) == 0) {
      found.what = cluster << 1 | mesh;
      found.region = o.parents[otgClusterElement(&o, mesh, cluster)];
      if (lane == 0 && found.region < o.sizes.slots) o.clusters[clusterPlace++] = found;
      continue;
    }
    for (uint k = otgFirstOf(m, cluster) + lane; k < otgFirstOf(m, cluster + 1); k += OTG_CLUSTER_LANES) {
      const uint v = m->clusterVertices[k];
      found.what = v << 1 | mesh;
      found.region = otgRegionOfVertex(&o, mesh, v);
      if (found.region != OTG_NOT_THERE) o.vertices[vertexPlace++] = found;
    }
  }
}
