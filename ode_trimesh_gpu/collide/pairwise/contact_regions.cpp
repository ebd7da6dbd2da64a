// SPDX-License-Identifier: BSD-3-Clause
// Connected components of the intersecting triangle pairs.
#include "collide/pairwise/contact_regions.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "base/union_find.h"
#include "collide/first_copies.h"

namespace otg {
namespace {

/// A triangle and its neighbours over ordinary edges; kNone where there is none.
std::array<std::uint32_t, 4> selfAndNeighbours(const Topology& topology, std::uint32_t triangle) {
  std::array<std::uint32_t, 4> result{triangle, kNone, kNone, kNone};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t twin = topology.twin[3 * std::size_t{triangle} + k];
    if (twin != kNone) result[k + 1] = twin / 3;
  }
  return result;
}

/// Edges that have no twin (boundaries, more than two triangles, opposite windings): too many triangles may share one
/// to go through their neighbours, so pairs meet through the edge itself. A feature is a triangle or an edge:
/// `kind` says which.
struct Feature {
  std::uint8_t kind;  // 0 triangle, 1 edge
  std::uint32_t id;
  friend auto operator<=>(const Feature&, const Feature&) = default;
};
struct Meeting {
  Feature a, b;
  std::uint32_t pair;
  friend auto operator<=>(const Meeting&, const Meeting&) = default;
};

struct Features {
  std::array<Feature, 4> all{};
  std::array<bool, 4> odd{};  // an edge without twin
  std::size_t count = 0;
  bool anyOdd = false;
};

Features featuresOf(const Topology& topology, std::uint32_t triangle) {
  Features f;
  f.all[f.count++] = {0, triangle};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t halfEdge = 3 * std::size_t{triangle} + k;
    if (topology.edgeOf[halfEdge] == kNone) continue;
    f.odd[f.count] = topology.twin[halfEdge] == kNone;
    f.anyOdd = f.anyOdd || f.odd[f.count];
    f.all[f.count++] = {1, topology.edgeOf[halfEdge]};
  }
  return f;
}

void uniteOverOddEdges(const Topology& topologyA, const Topology& topologyB, const std::vector<TrianglePair>& pairs,
                       UnionFind& components) {
  std::vector<Meeting> meetings;
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const Features fa = featuresOf(topologyA, pairs[i].a);
    const Features fb = featuresOf(topologyB, pairs[i].b);
    if (!fa.anyOdd && !fb.anyOdd) continue;
    for (std::size_t x = 0; x < fa.count; ++x) {
      for (std::size_t y = 0; y < fb.count; ++y) {
        if (fa.odd[x] || fb.odd[y]) meetings.push_back({fa.all[x], fb.all[y], i});
      }
    }
  }
  std::sort(meetings.begin(), meetings.end());
  for (std::size_t i = 1; i < meetings.size(); ++i) {
    if (meetings[i].a == meetings[i - 1].a && meetings[i].b == meetings[i - 1].b) {
      components.unite(meetings[i].pair, meetings[i - 1].pair);
    }
  }
}

/// First pair of the row of triangle `a` (pairs ascend, so a triangle of A has one contiguous row), and one past its
/// last.
std::pair<std::uint32_t, std::uint32_t> rowOf(const std::vector<TrianglePair>& pairs, std::uint32_t a) {
  const auto begin = std::lower_bound(pairs.begin(), pairs.end(), TrianglePair{a, 0});
  const auto end = std::find_if(begin, pairs.end(), [a](const TrianglePair& p) { return p.a != a; });
  return {static_cast<std::uint32_t>(begin - pairs.begin()), static_cast<std::uint32_t>(end - pairs.begin())};
}

void uniteOverTwins(const Topology& topologyA, const Topology& topologyB, const std::vector<TrianglePair>& pairs,
                    UnionFind& components) {
  for (std::uint32_t rowBegin = 0; rowBegin < pairs.size();) {
    const std::uint32_t a = pairs[rowBegin].a;
    std::uint32_t rowEnd = rowBegin;
    while (rowEnd < pairs.size() && pairs[rowEnd].a == a) ++rowEnd;
    for (const std::uint32_t otherA : selfAndNeighbours(topologyA, a)) {
      // Both directions would find the same connection: look from the smaller triangle to the larger one only.
      if (otherA == kNone || otherA < a) continue;
      const auto [begin, end] = otherA == a ? std::pair{rowBegin, rowEnd} : rowOf(pairs, otherA);
      if (begin == end) continue;
      for (std::uint32_t i = rowBegin; i < rowEnd; ++i) {
        for (const std::uint32_t otherB : selfAndNeighbours(topologyB, pairs[i].b)) {
          const auto found = std::lower_bound(pairs.begin() + begin, pairs.begin() + end, TrianglePair{otherA, otherB});
          if (found != pairs.begin() + end && found->b == otherB) {
            components.unite(i, static_cast<std::uint32_t>(found - pairs.begin()));
          }
        }
      }
    }
    rowBegin = rowEnd;
  }
}

}  // namespace

void assignRegions(const Query& query, Workspace& workspace) {
  // Copies of a triangle share its edges, more than two triangles do: they are in the region of the first one.
  const FirstCopies first(query);
  std::vector<TrianglePair> distinct;
  if (!first.areAll()) {
    // A callback may have left copies without the first one.
    distinct = workspace.intersecting;
    for (TrianglePair& pair : distinct) pair = first.of(pair);
    std::ranges::sort(distinct);
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  }
  const std::vector<TrianglePair>& pairs = first.areAll() ? workspace.intersecting : distinct;
  const Topology& topologyA = query.a->mesh().topology();
  const Topology& topologyB = query.b->mesh().topology();
  UnionFind components(pairs.size());
  uniteOverTwins(topologyA, topologyB, pairs, components);
  uniteOverOddEdges(topologyA, topologyB, pairs, components);

  // Numbers in the order of the regions' first pairs, for regions that have contacts.
  std::vector<std::uint32_t> number(pairs.size(), kNone);
  std::vector<std::uint32_t> rootOf(workspace.contacts.size());
  std::vector<std::uint8_t> hasContact(pairs.size(), 0);
  for (std::size_t i = 0; i < workspace.contacts.size(); ++i) {
    const TrianglePair pair = first.of({workspace.contacts[i].triangleA, workspace.contacts[i].triangleB});
    const auto found = std::lower_bound(pairs.begin(), pairs.end(), pair);
    rootOf[i] = components.find(static_cast<std::uint32_t>(found - pairs.begin()));
    hasContact[rootOf[i]] = 1;
  }
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    if (hasContact[i]) number[i] = next++;  // only the smallest member of a component is marked
  }
  for (std::size_t i = 0; i < workspace.contacts.size(); ++i) workspace.contacts[i].region = number[rootOf[i]];
}

}  // namespace otg
