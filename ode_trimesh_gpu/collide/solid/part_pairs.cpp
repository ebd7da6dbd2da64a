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

std::vector<MeshPart> partsOf(const CollisionMesh* mesh) {
  const CollisionMesh::Parts* const parts = mesh->parts();
  if (parts == nullptr) return {MeshPart{mesh, mesh}};
  std::vector<MeshPart> out;
  for (std::uint32_t i = 0; i < parts->meshes.size(); ++i) {
    out.push_back({mesh, parts->meshes[i].get(), &parts->parts[i], i});
  }
  return out;
}

/// Where a triangle of a mesh is in its parts.
struct PlaceInParts {
  explicit PlaceInParts(const SolidParts* of) : parts(of) {}
  std::uint32_t part(std::uint32_t t) const { return parts == nullptr ? 0 : parts->partOf[t]; }
  std::uint32_t number(std::uint32_t t) const { return parts == nullptr ? t : parts->numberOf[t]; }
  const SolidParts* parts;
};

/// Contacts by pairs of parts.
class PartContacts {
 public:
  PartContacts(std::span<const PartPair> pairs, std::span<const Contact> contacts)
      : pairs_(pairs), contacts_(contacts), isDropped_(contacts.size(), 0) {}

  bool isDropped(std::size_t i) const { return isDropped_[i] != 0; }

  /// Whether what the pair has in common lies in another part of a mesh, as far as the middles of regions tell.
  bool isInAnother(const PartPair& pair) const {
    return std::all_of(pair.middles.begin(), pair.middles.end(), [&](const Vec3d& p) {
      return std::any_of(pairs_.begin(), pairs_.end(), [&](const PartPair& other) {
        const bool ofA = other.a.mesh != pair.a.mesh, ofB = other.b.mesh != pair.b.mesh;
        if (other.begin == other.end || ofA == ofB) return false;
        const Transformd& pose = pair.query.bInA;
        return ofA ? pointInMesh(*other.a.mesh, p) : pointInMesh(*other.b.mesh, otgRotateBack(pose, otgSub(p, pose.t)));
      });
    });
  }

  /// A little more than what the contacts of all other pairs request; none where no translation does.
  std::optional<Vec3d> wayOfOthers(const PartPair& pair) const {
    ShortestTranslation way;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (isOf(pair, i) || isDropped(i)) continue;
      if (!way.add(contacts_[i].normal, contacts_[i].depth)) return std::nullopt;
    }
    return otgScale(way.value(), kBeyond);
  }

  /// Contacts of the pair with other normals than all contacts of other pairs.
  void dropOwnNormals(const PartPair& pair) {
    for (std::size_t i = pair.begin; i < pair.end; ++i) {
      bool agrees = false;
      for (std::size_t j = 0; j < contacts_.size() && !agrees; ++j) {
        agrees = !isOf(pair, j) && !isDropped(j) && otgDot(contacts_[i].normal, contacts_[j].normal) > kAgree;
      }
      isDropped_[i] = agrees ? 0 : 1;
    }
  }

 private:
  static bool isOf(const PartPair& pair, std::size_t i) { return i >= pair.begin && i < pair.end; }

  std::span<const PartPair> pairs_;
  std::span<const Contact> contacts_;
  std::vector<std::uint8_t> isDropped_;
};

bool areApart(const PartPair& pair, const Vec3d& way, Workspace& scratch) {
  Query moved = pair.query;
  moved.bInA.t = otgSub(moved.bInA.t, way);
  moved.options.timings = moved.options.countPerDepth = false;
  findIntersectingPairs(moved, scratch);
  return scratch.intersecting.empty();
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

std::vector<PartPair> pairsOfParts(const Query& query, std::span<const TrianglePair> meeting) {
  const std::vector<MeshPart> partsA = partsOf(query.a), partsB = partsOf(query.b);
  std::vector<PartPair> pairs;
  pairs.reserve(partsA.size() * partsB.size());
  for (const MeshPart& a : partsA) {
    for (const MeshPart& b : partsB) {
      pairs.push_back({.a = a, .b = b, .query = query});
      pairs.back().query.a = a.mesh;
      pairs.back().query.b = b.mesh;
    }
  }
  const PlaceInParts inA(query.a->parts()), inB(query.b->parts());
  for (const TrianglePair& p : meeting) {
    const std::uint32_t i = inA.part(p.a), j = inB.part(p.b);
    if (i != kNone && j != kNone) pairs[i * partsB.size() + j].meeting.push_back({inA.number(p.a), inB.number(p.b)});
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

void dropWallsInside(std::span<const PartPair> pairs, std::vector<Contact>& contacts, Workspace& scratch) {
  std::vector<const PartPair*> order;
  for (const PartPair& pair : pairs) {
    if (pair.begin < pair.end) order.push_back(&pair);
  }
  if (order.size() < 2) return;
  std::stable_sort(order.begin(), order.end(),
                   [](const PartPair* x, const PartPair* y) { return x->volume < y->volume; });
  PartContacts all(pairs, contacts);
  for (const PartPair* pair : order) {
    if (!all.isInAnother(*pair)) continue;
    const std::optional<Vec3d> way = all.wayOfOthers(*pair);
    if (way && areApart(*pair, *way, scratch)) all.dropOwnNormals(*pair);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!all.isDropped(i)) contacts[kept++] = contacts[i];
  }
  contacts.resize(kept);
}

}  // namespace otg
