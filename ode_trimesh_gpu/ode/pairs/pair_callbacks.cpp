// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/pair_callbacks.h"

#include <algorithm>
#include <set>

namespace otg {
namespace {

using Numbers = std::pair<std::uint32_t, std::uint32_t>;

double distance2(const Contact& x, const Contact& y) {
  const Vec3d d = otgSub(x.position, y.position);
  return otgDot(d, d);
}

}  // namespace

bool PairCallbacks::mayCollide(bool ofA, std::uint32_t triangle) {
  const MeshGeom &own = ofA ? task_.sideA() : task_.sideB(), &other = ofA ? task_.sideB() : task_.sideA();
  dTriCallback* const callback = (ofA ? ofA_ : ofB_).triangle;
  if (callback == nullptr) return true;
  const auto [it, isNew] = (ofA ? answerA_ : answerB_).try_emplace(triangle, true);
  if (isNew) it->second = callback(own.geom, other.geom, static_cast<int>(triangle)) != 0;
  return it->second;
}

bool PairCallbacks::mayCollide(std::uint32_t triangleA, std::uint32_t triangleB) {
  if (!mayCollide(true, triangleA) || !mayCollide(false, triangleB)) return false;
  const MeshGeom &a = task_.sideA(), &b = task_.sideB();
  if (ofA_.pair == nullptr && ofB_.pair == nullptr) return true;
  const auto [it, isNew] = answer_.try_emplace({triangleA, triangleB}, true);
  if (isNew) {
    const int ta = static_cast<int>(triangleA), tb = static_cast<int>(triangleB);
    it->second = (ofA_.pair == nullptr || ofA_.pair(a.geom, b.geom, ta, tb) != 0) &&
                 (ofB_.pair == nullptr || ofB_.pair(b.geom, a.geom, tb, ta) != 0);
  }
  return it->second;
}

void PairCallbacks::tellTriangles(const std::vector<Numbers>& pairs) {
  for (const bool ofA : {true, false}) {
    const MeshGeom &own = ofA ? task_.sideA() : task_.sideB(), &other = ofA ? task_.sideB() : task_.sideA();
    dTriArrayCallback* const callback = (ofA ? ofA_ : ofB_).triangles;
    if (callback == nullptr) continue;
    std::vector<int> triangles;
    triangles.reserve(pairs.size());
    for (const Numbers& pair : pairs) triangles.push_back(static_cast<int>(ofA ? pair.first : pair.second));
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    callback(own.geom, other.geom, triangles.data(), static_cast<int>(triangles.size()));
  }
}

bool PairCallbacks::dropPairs(const Query& query, Workspace& workspace) {
  std::vector<TrianglePair>& pairs = workspace.intersecting;
  if (pairs.empty()) return false;
  std::vector<Numbers> numbers;
  numbers.reserve(pairs.size());
  for (const TrianglePair& p : pairs) {
    numbers.emplace_back(query.a->mesh().callerTriangle(p.a), query.b->mesh().callerTriangle(p.b));
  }
  tellTriangles(numbers);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (mayCollide(numbers[i].first, numbers[i].second)) pairs[kept++] = pairs[i];
  }
  const bool dropped = kept < pairs.size();
  pairs.resize(kept);
  return dropped;
}

void PairCallbacks::finish(const Query& query, Workspace& workspace) {
  // A mesh inside another one touches none of its triangles; its contacts name the nearest ones all the same.
  std::erase_if(workspace.reduced, [&](const Contact& c) { return !mayCollide(c.triangleA, c.triangleB); });
  for (const bool ofA : {true, false}) {
    dTriTriMergeCallback* const merge = (ofA ? ofA_ : ofB_).merge;
    if (merge == nullptr || workspace.reduced.empty()) continue;
    std::vector<Contact> all = workspace.contacts;
    for (Contact& c : all) {
      c.triangleA = query.a->mesh().callerTriangle(c.triangleA);
      c.triangleB = query.b->mesh().callerTriangle(c.triangleB);
    }
    mergeNumbers(merge, (ofA ? task_.sideA() : task_.sideB()).geom, ofA, all, workspace.reduced);
  }
}

/// A contact that was left out is stood for by the nearest one that was kept, of its own region if there is one.
void mergeNumbers(dTriTriMergeCallback* merge, dGeomID geom, bool ofA, const std::vector<Contact>& all,
                  std::vector<Contact>& kept) {
  const auto triangle = [ofA](const Contact& c) { return ofA ? c.triangleA : c.triangleB; };
  std::vector<std::set<std::uint32_t>> standsFor(kept.size());
  for (const Contact& c : all) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < kept.size(); ++i) {
      const bool same = kept[i].region == c.region, bestSame = kept[best].region == c.region;
      if (same != bestSame ? same : distance2(kept[i], c) < distance2(kept[best], c)) best = i;
    }
    if (triangle(c) != triangle(kept[best])) standsFor[best].insert(triangle(c));
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    int number = static_cast<int>(triangle(kept[i]));
    for (const std::uint32_t other : standsFor[i]) {
      number = merge(geom, number, static_cast<int>(other));
    }
    (ofA ? kept[i].triangleA : kept[i].triangleB) = static_cast<std::uint32_t>(number);
  }
}

}  // namespace otg
