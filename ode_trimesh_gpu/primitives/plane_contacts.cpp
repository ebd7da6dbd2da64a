// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/plane_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/epoch_array.h"
#include "base/flat_map.h"
#include "base/of_thread.h"
#include "base/union_find.h"
#include "base/vectors.h"
#include "bvh/wide_search.h"

namespace otg {
namespace {

/// A vertex below the plane.
struct Below {
  Vec3d position;
  double depth;
  std::uint32_t vertex, triangle;  ///< welded; the smallest triangle number that has it
  std::uint32_t region = 0;
  double spread = std::numeric_limits<double>::infinity();  ///< squared distance to the chosen ones
};

/// Differences below these are no reason for a choice: bodies at rest tremble, and contacts should stay where they are.
constexpr double kRankStep = 0.02, kFarther = 1.02;

/// The vertices below, with the region that each belongs to, in the order in which triangles name them.
std::vector<Below> verticesBelow(const CollisionMesh& tree, const PlaneGeom& plane) {
  const TriMesh& mesh = tree.mesh();
  std::vector<Below> found;
  std::vector<std::uint32_t> triangles;
  searchWide(tree.wide(), BelowQuery(tree, plane.normal, plane.offset), [&](std::uint32_t t) {
    if (!mesh.isDegenerate(t)) triangles.push_back(t);
  });
  if (triangles.empty()) return found;
  std::sort(triangles.begin(), triangles.end());
  FlatMap index;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (const std::uint32_t t : triangles) {
    std::uint32_t before = kNone;
    for (const std::uint32_t v : mesh.triangles()[t].v) {
      const Vec3f& p = mesh.vertices()[v];
      const Vec3d x{p.x, p.y, p.z};
      const double depth = plane.offset - otgDot(plane.normal, x);
      if (!(depth >= 0)) continue;
      const std::uint32_t welded = mesh.topology().weld[v];
      bool isNew = false;
      const std::uint32_t at = index.insert(welded, static_cast<std::uint32_t>(found.size()), &isNew);
      if (isNew) found.push_back({x, depth, welded, t});
      if (before != kNone) joined.emplace_back(before, at);
      before = at;
    }
  }
  UnionFind regions(found.size());
  for (const auto& [a, b] : joined) regions.unite(a, b);
  for (std::uint32_t i = 0; i < found.size(); ++i) found[i].region = regions.find(i);
  return found;
}

/// Moves the chosen ones to the front of [begin, end) and returns how many they are.
std::size_t chooseSpread(std::vector<Below>::iterator begin, std::vector<Below>::iterator end, std::size_t most) {
  const double step =
      kRankStep * std::max_element(begin, end, [](const Below& x, const Below& y) { return x.depth < y.depth; })->depth;
  const auto rank = [&](const Below& b) { return step > 0 ? std::floor(b.depth / step) : 0.0; };
  std::sort(begin, end, [&](const Below& x, const Below& y) {
    return rank(x) != rank(y) ? rank(x) > rank(y) : x.vertex < y.vertex;
  });
  const std::size_t count = std::min(most, static_cast<std::size_t>(end - begin));
  for (std::size_t i = 1; i < count; ++i) {
    const Vec3d last = begin[static_cast<std::ptrdiff_t>(i) - 1].position;
    auto best = begin + static_cast<std::ptrdiff_t>(i);
    for (auto it = best; it != end; ++it) {
      const Vec3d d = it->position - last;
      it->spread = std::min(it->spread, otgDot(d, d));
      if (it->spread > kFarther * best->spread) best = it;
    }
    std::rotate(begin + static_cast<std::ptrdiff_t>(i), best, best + 1);
  }
  return count;
}

/// Memory that is kept from query to query.
struct PlaneScratch {
  EpochArray seen;
  std::vector<Below> found;
};
/// The thread's is gone: programs may collide in the destructors of their own globals.
thread_local bool planeScratchHasEnded = false;
struct KeptPlaneScratch : PlaneScratch {
  KeptPlaneScratch() = default;
  ~KeptPlaneScratch() { planeScratchHasEnded = true; }
  KeptPlaneScratch(const KeptPlaneScratch&) = delete;
  KeptPlaneScratch& operator=(const KeptPlaneScratch&) = delete;
};

/// The corners below, from the deepest one on over edges: on a convex body they hang together.
void cornersBelow(const ConvexPolyhedron& body, const PlaneGeom& plane, PlaneScratch& scratch) {
  scratch.found.clear();
  const auto depthOf = [&](std::uint32_t v) { return plane.offset - otgDot(plane.normal, body.vertices()[v]); };
  const auto add = [&](std::uint32_t v, double depth) {
    scratch.seen.set(v, static_cast<std::uint32_t>(scratch.found.size()));
    // Its own number until it has been looked around from.
    scratch.found.push_back({body.vertices()[v], depth, v, body.leastTriangle(v)});
  };
  const std::uint32_t deepest = body.support(otgScale(plane.normal, -1.0));
  const double most = depthOf(deepest);
  if (!(most >= 0)) return;
  scratch.seen.reset(body.vertices().size());
  add(deepest, most);
  for (std::size_t i = 0; i < scratch.found.size(); ++i) {
    const std::uint32_t v = scratch.found[i].vertex;
    scratch.found[i].vertex = body.meshVertex(v);
    for (const std::uint32_t c : body.cornersAt(v)) {
      const std::uint32_t next = body.corner(c).next;
      if (scratch.seen.has(next)) continue;
      if (const double depth = depthOf(next); depth >= 0) add(next, depth);
    }
  }
}

Contact contactAt(const Below& below, const PlaneGeom& plane, std::uint32_t region) {
  Contact contact{below.position, plane.normal, below.depth, below.triangle, kNone, region, ContactFeature::kVertexA};
  contact.flags = kContactInside;
  contact.element = below.vertex;
  return contact;
}

bool isBeforeInAnswer(const Contact& x, const Contact& y) {
  return x.depth != y.depth ? x.depth > y.depth : x.element < y.element;
}

}  // namespace

void planeContacts(const CollisionMesh& tree, const PlaneGeom& plane, int perRegion, std::vector<Contact>& out) {
  if (const ConvexPolyhedron* const body = tree.convex(); body != nullptr && body->convexity() == Convexity::kExact) {
    PlaneScratch own;
    PlaneScratch& scratch = planeScratchHasEnded ? own : ofThread<KeptPlaneScratch>();
    cornersBelow(*body, plane, scratch);
    if (scratch.found.empty()) return;
    const std::size_t count =
        chooseSpread(scratch.found.begin(), scratch.found.end(), static_cast<std::size_t>(perRegion));
    for (std::size_t i = 0; i < count; ++i) out.push_back(contactAt(scratch.found[i], plane, 0));
    std::sort(out.begin(), out.end(), isBeforeInAnswer);
    return;
  }
  // Most queries of a space end here: no need of what is made for contacts.
  std::vector<Below> found = verticesBelow(tree, plane);
  if (found.empty()) return;
  const std::vector<std::uint8_t>& flat = tree.adjacency().flatVertex;
  std::stable_sort(found.begin(), found.end(), [](const Below& x, const Below& y) { return x.region < y.region; });
  std::uint32_t number = 0;
  for (auto begin = found.begin(); begin != found.end();) {
    const auto end = std::find_if(begin, found.end(), [&](const Below& b) { return b.region != begin->region; });
    const auto corners = std::stable_partition(begin, end, [&](const Below& b) { return flat[b.vertex] == 0; });
    const auto last = corners == begin ? end : corners;
    const std::size_t count = chooseSpread(begin, last, static_cast<std::size_t>(perRegion));
    for (auto it = begin; it != begin + static_cast<std::ptrdiff_t>(count); ++it) {
      out.push_back(contactAt(*it, plane, number));
    }
    ++number;
    begin = end;
  }
  std::sort(out.begin(), out.end(), isBeforeInAnswer);
}

}  // namespace otg
