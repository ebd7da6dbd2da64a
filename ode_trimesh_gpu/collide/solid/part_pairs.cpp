// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/part_pairs.h"

#include <algorithm>
#include <optional>

#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/shortest_translation.h"
#include "collide/stages.h"

namespace otg {
namespace {

/// The parts are looked at a little farther on than contacts request: there surfaces that lie on each other are apart.
constexpr double kBeyond = 1.02;
/// Cosine of the angle to which normals agree.
constexpr double kAgree = 0.999;

MeshPart partOf(const CollisionMesh* mesh, std::uint32_t number) {
  const CollisionMesh::Parts* const parts = mesh->parts();
  if (parts == nullptr) return {mesh, mesh};
  return {mesh, parts->meshes[number].get(), &parts->parts[number], number};
}

/// Where a triangle of a mesh is in its parts.
struct PlaceInParts {
  explicit PlaceInParts(const SolidParts* of) : parts(of) {}
  std::uint32_t part(std::uint32_t t) const { return parts == nullptr ? 0 : parts->partOf[t]; }
  std::uint32_t number(std::uint32_t t) const { return parts == nullptr ? t : parts->numberOf[t]; }
  const SolidParts* parts;
};

/// Contacts by regions of pairs of parts.
class PartContacts {
 public:
  PartContacts(std::span<const PartPair> pairs, std::span<const Contact> contacts)
      : pairs_(pairs), contacts_(contacts), isDropped_(contacts.size(), 0) {}

  bool isDropped(std::size_t i) const { return isDropped_[i] != 0; }

  /// Whether the region lies in another part of a mesh that has contacts, as far as its middle tells.
  bool isInAnother(const PartRegion& region) const {
    const PartPair& own = pairs_[region.pair];
    const Transformd& pose = own.query.bInA;
    return std::any_of(pairs_.begin(), pairs_.end(), [&](const PartPair& other) {
      const bool ofA = other.a.mesh != own.a.mesh, ofB = other.b.mesh != own.b.mesh;
      if (ofA == ofB || !hasContacts(other)) return false;
      return ofA ? pointInMesh(*other.a.mesh, region.middle)
                 : pointInMesh(*other.b.mesh, otgRotateBack(pose, otgSub(region.middle, pose.t)));
    });
  }

  /// A little more than what the contacts of all other regions request; none where no translation does.
  std::optional<Vec3d> wayOfOthers(const PartRegion& region) const {
    ShortestTranslation way;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (isOf(region, i) || isDropped(i)) continue;
      if (!way.add(contacts_[i].normal, contacts_[i].depth)) return std::nullopt;
    }
    return otgScale(way.value(), kBeyond);
  }

  /// Contacts of the region with other normals than all contacts of other regions.
  void dropOwnNormals(const PartRegion& region) {
    for (std::size_t i = region.begin; i < region.end; ++i) {
      bool agrees = false;
      for (std::size_t j = 0; j < contacts_.size() && !agrees; ++j) {
        agrees = !isOf(region, j) && !isDropped(j) && otgDot(contacts_[i].normal, contacts_[j].normal) > kAgree;
      }
      isDropped_[i] = agrees ? 0 : 1;
    }
  }

 private:
  static bool isOf(const PartRegion& region, std::size_t i) { return i >= region.begin && i < region.end; }
  bool hasContacts(const PartPair& pair) const {
    for (std::size_t i = pair.begin; i < pair.end; ++i) {
      if (!isDropped(i)) return true;
    }
    return false;
  }

  std::span<const PartPair> pairs_;
  std::span<const Contact> contacts_;
  std::vector<std::uint8_t> isDropped_;
};

/// Whether a component of one mesh lies in the other one, given that no triangles meet.
bool isContained(const Query& query) {
  const PlacedMeshes meshes(query);
  for (const int m : {0, 1}) {
    for (const std::uint32_t v : meshes.adjacency(m).componentVertex) {
      if (v != kNone && meshes.isSolid(1 - m) && vertexInside(meshes, 1 - m, meshes.vertex(m, v))) return true;
    }
  }
  return false;
}

bool areApart(const PartPair& pair, const Vec3d& way, Workspace& scratch) {
  Query moved = pair.query;
  moved.bInA.t = otgSub(moved.bInA.t, way);
  moved.options.timings = moved.options.countPerDepth = false;
  findIntersectingPairs(moved, scratch);
  return scratch.intersecting.empty() && !isContained(moved);
}

}  // namespace

std::uint32_t MeshPart::triangle(std::uint32_t t) const {
  return part == nullptr || t == kNone ? t : part->triangleOf[t];
}

std::uint32_t MeshPart::vertex(std::uint32_t welded) const {
  return part == nullptr ? welded : whole->mesh().topology().weld[part->vertexOf[welded]];
}

std::uint32_t MeshPart::edge(std::uint32_t e) const {
  if (part == nullptr) return e;
  const std::uint32_t half = mesh->adjacency().halfEdgeOf[e];
  return whole->mesh().topology().edgeOf[3 * part->triangleOf[half / 3] + half % 3];
}

std::uint32_t countParts(const CollisionMesh& mesh) {
  return mesh.parts() == nullptr ? 1 : static_cast<std::uint32_t>(mesh.parts()->meshes.size());
}

PartPair pairOfParts(const Query& query, std::uint32_t i, std::uint32_t j) {
  PartPair pair{.a = partOf(query.a, i), .b = partOf(query.b, j), .query = query};
  pair.query.a = pair.a.mesh;
  pair.query.b = pair.b.mesh;
  return pair;
}

std::vector<PartPair> pairsOfParts(const Query& query, std::span<const TrianglePair> meeting) {
  const std::uint32_t countA = countParts(*query.a), countB = countParts(*query.b);
  std::vector<PartPair> pairs;
  pairs.reserve(std::size_t{countA} * countB);
  for (std::uint32_t i = 0; i < countA; ++i) {
    for (std::uint32_t j = 0; j < countB; ++j) pairs.push_back(pairOfParts(query, i, j));
  }
  const PlaceInParts inA(query.a->parts()), inB(query.b->parts());
  for (const TrianglePair& p : meeting) {
    const std::uint32_t i = inA.part(p.a), j = inB.part(p.b);
    if (i != kNone && j != kNone)
      pairs[std::size_t{i} * countB + j].meeting.push_back({inA.number(p.a), inB.number(p.b)});
  }
  return pairs;
}

void numberAsWhole(std::span<const PartPair> pairs, std::span<Contact> contacts) {
  for (const PartPair& pair : pairs) {
    for (Contact& c : contacts.subspan(pair.begin, pair.end - pair.begin)) {
      c.triangleA = pair.a.triangle(c.triangleA);
      c.triangleB = pair.b.triangle(c.triangleB);
      if (c.element == kNone) continue;
      const MeshPart &own = isOfA(c.feature) ? pair.a : pair.b, &other = isOfA(c.feature) ? pair.b : pair.a;
      const bool isVertex = c.feature == ContactFeature::kVertexA || c.feature == ContactFeature::kVertexB;
      c.element = isVertex ? own.vertex(c.element) : own.edge(c.element);
      c.ordinal += other.number % 256 * kOrdinalOfPart;
    }
  }
}

void dropWallsInside(std::span<const PartPair> pairs, std::span<const PartRegion> regions,
                     std::vector<Contact>& contacts, Workspace& scratch) {
  if (regions.size() < 2) return;
  std::vector<const PartRegion*> order;
  for (const PartRegion& region : regions) order.push_back(&region);
  std::stable_sort(order.begin(), order.end(),
                   [](const PartRegion* x, const PartRegion* y) { return x->volume < y->volume; });
  PartContacts all(pairs, contacts);
  for (const PartRegion* region : order) {
    if (!all.isInAnother(*region)) continue;
    const std::optional<Vec3d> way = all.wayOfOthers(*region);
    if (way && areApart(pairs[region->pair], *way, scratch)) all.dropOwnNormals(*region);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!all.isDropped(i)) contacts[kept++] = contacts[i];
  }
  contacts.resize(kept);
}

}  // namespace otg
