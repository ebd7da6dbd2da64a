// SPDX-License-Identifier: BSD-3-Clause
#include "collide/join/joined_mesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <unordered_map>

#include "base/hash.h"
#include "base/vectors.h"
#include "collide/pair_history.h"

namespace otg {
namespace {

constexpr std::uint64_t halfEdge(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}
constexpr std::uint64_t turned(std::uint64_t half) {
  return half << 32 | half >> 32;
}

class Joiner {
 public:
  explicit Joiner(std::span<const JoinPart> parts)
      : parts_(parts), shared_(sharedPlaces(parts)), inner_(parts.size()), root_(parts.size()) {
    std::iota(root_.begin(), root_.end(), 0u);
    for (std::uint32_t p = 0; p < parts.size(); ++p) inner_[p].assign(mesh(p).triangleCount(), false);
  }

  std::vector<JoinedMesh> run() {
    linkSheets();
    linkTriangles();
    linkFaces();
    std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
    for (std::uint32_t p = 0; p < parts_.size(); ++p) groups[rootOf(p)].push_back(p);
    std::vector<JoinedMesh> joined;
    for (auto& [root, parts] : groups) {
      if (parts.size() < 2) continue;
      JoinedMesh made = build(std::move(parts));
      if (made.mesh != nullptr) joined.push_back(std::move(made));
    }
    return joined;
  }

 private:
  const TriMesh& mesh(std::uint32_t part) const { return parts_[part].mesh->mesh(); }
  std::array<std::uint32_t, 3> corners(std::uint32_t part, std::uint32_t triangle) const {
    const Triangle& t = mesh(part).triangles()[triangle];
    const std::vector<std::uint32_t>& numbers = shared_.numbers[part];
    return {numbers[t.v[0]], numbers[t.v[1]], numbers[t.v[2]]};
  }
  std::uint64_t halfOf(std::uint32_t part, std::uint32_t half) const {
    const std::array<std::uint32_t, 3> v = corners(part, half / 3);
    return halfEdge(v[half % 3], v[(half + 1) % 3]);
  }
  std::uint32_t rootOf(std::uint32_t part) {
    while (root_[part] != part) part = root_[part] = root_[root_[part]];
    return part;
  }
  void link(std::uint32_t p, std::uint32_t q) {
    const std::uint32_t a = rootOf(p), b = rootOf(q);
    root_[std::max(a, b)] = std::min(a, b);
  }

  /// Sheets whose rims have an edge in common that runs one way in one of them and the other way in the other.
  void linkSheets() {
    std::unordered_map<std::uint64_t, std::uint32_t> rims;
    for (std::uint32_t p = 0; p < parts_.size(); ++p) {
      if (!isSheet(mesh(p))) continue;
      const Topology& topology = mesh(p).topology();
      for (std::uint32_t half = 0; half < topology.twin.size(); ++half) {
        if (topology.edgeOf[half] == kNone || topology.twin[half] != kNone) continue;
        const std::uint64_t own = halfOf(p, half);
        const auto other = rims.find(turned(own));
        if (other != rims.end() && other->second != p) link(p, other->second);
        rims.emplace(own, p);
      }
    }
  }

  bool isSolidPart(std::uint32_t part) const { return mesh(part).meshClass() == MeshClass::kSolid; }

  /// Triangles of two solids with the same corners that face each other.
  void linkTriangles() {
    struct Place {
      std::uint32_t part, triangle;
      std::array<std::uint32_t, 3> corners;
    };
    std::unordered_multimap<std::uint64_t, Place> known;
    for (std::uint32_t p = 0; p < parts_.size(); ++p) {
      for (std::uint32_t t = 0; isSolidPart(p) && t < mesh(p).triangleCount(); ++t) {
        std::array<std::uint32_t, 3> v = corners(p, t);
        std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
        const std::array<std::uint32_t, 3> facing = {v[0], v[2], v[1]};
        const std::uint64_t key = spreadBits(halfEdge(v[0], v[1] ^ v[2]));
        const auto [first, last] = known.equal_range(key);
        const auto other = std::find_if(
            first, last, [&](const auto& entry) { return entry.second.part != p && entry.second.corners == facing; });
        if (other == last) {
          known.emplace(key, Place{p, t, v});
          continue;
        }
        link(p, other->second.part);
        inner_[p][t] = inner_[other->second.part][other->second.triangle] = true;
        known.erase(other);
      }
    }
  }

  /// Flat faces of two solids with the same contour that face each other, however each is cut into triangles.
  void linkFaces() {
    struct Face {
      std::uint32_t part;
      std::vector<std::uint32_t> triangles;
    };
    std::map<std::vector<std::uint64_t>, Face> known;
    for (std::uint32_t p = 0; p < parts_.size(); ++p) {
      if (!isSolidPart(p)) continue;
      std::vector<bool> isSeen = inner_[p];
      for (std::uint32_t t = 0; t < mesh(p).triangleCount(); ++t) {
        if (isSeen[t]) continue;
        std::vector<std::uint64_t> contour;
        std::vector<std::uint32_t> face = faceAround(p, t, isSeen, contour);
        if (!isFlat(p, face)) continue;
        std::vector<std::uint64_t> facing(contour.size());
        std::transform(contour.begin(), contour.end(), facing.begin(), &turned);
        std::sort(contour.begin(), contour.end());
        std::sort(facing.begin(), facing.end());
        const auto other = known.find(facing);
        if (other == known.end() || other->second.part == p) {
          known.emplace(std::move(contour), Face{p, std::move(face)});
          continue;
        }
        link(p, other->second.part);
        for (const std::uint32_t i : face) inner_[p][i] = true;
        for (const std::uint32_t i : other->second.triangles) inner_[other->second.part][i] = true;
        known.erase(other);
      }
    }
  }

  /// The triangles that hang together with one through flat edges, and the half-edges around them.
  std::vector<std::uint32_t> faceAround(std::uint32_t part, std::uint32_t triangle, std::vector<bool>& isSeen,
                                        std::vector<std::uint64_t>& contour) const {
    const Topology& topology = mesh(part).topology();
    const Adjacency& adjacency = parts_[part].mesh->adjacency();
    std::vector<std::uint32_t> face{triangle};
    isSeen[triangle] = true;
    for (std::size_t i = 0; i < face.size(); ++i) {
      for (std::uint32_t half = 3 * face[i]; half < 3 * face[i] + 3; ++half) {
        const std::uint32_t twin = topology.twin[half];
        const bool goesOn = twin != kNone && adjacency.isFlatEdge(topology.edgeOf[half]) && !inner_[part][twin / 3];
        if (!goesOn) {
          contour.push_back(halfOf(part, half));
        } else if (!isSeen[twin / 3]) {
          isSeen[twin / 3] = true;
          face.push_back(twin / 3);
        }
      }
    }
    return face;
  }

  bool isFlat(std::uint32_t part, const std::vector<std::uint32_t>& face) const {
    const std::array<std::uint32_t, 3> first = corners(part, face.front());
    const Vec3d& on = shared_.places[first[0]];
    const Vec3d normal = otgRotate(parts_[part].pose, parts_[part].mesh->adjacency().normal[face.front()]);
    const Vec3d up = unit(normal);
    // The plane of a small triangle is known as well as its corners are, relative to its size.
    const double size = std::min(norm(shared_.places[first[1]] - on), norm(shared_.places[first[2]] - on));
    for (const std::uint32_t t : face) {
      for (const std::uint32_t v : corners(part, t)) {
        const Vec3d d = shared_.places[v] - on;
        if (!(std::fabs(otgDot(d, up)) <= shared_.reach * (1 + norm(d) / size))) return false;
      }
    }
    return true;
  }

  JoinedMesh build(std::vector<std::uint32_t>&& parts) const {
    JoinedMesh joined;
    std::vector<Vec3f> vertices;
    std::vector<Triangle> triangles;
    std::unordered_map<std::uint32_t, std::uint32_t> numberOf;
    for (const std::uint32_t p : parts) {
      for (std::uint32_t t = 0; t < mesh(p).triangleCount(); ++t) {
        if (inner_[p][t]) continue;
        Triangle triangle{};
        const std::array<std::uint32_t, 3> v = corners(p, t);
        for (std::size_t k = 0; k < 3; ++k) {
          const auto [it, isNew] = numberOf.try_emplace(v[k], static_cast<std::uint32_t>(vertices.size()));
          const Vec3d& at = shared_.places[v[k]];
          if (isNew) vertices.push_back({static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)});
          triangle.v[k] = it->second;
        }
        triangles.push_back(triangle);
        joined.sourceOf.push_back({p, mesh(p).callerTriangle(t)});
      }
    }
    MeshInput input;
    input.vertices = vertices.data();
    input.vertexCount = vertices.size();
    input.indices = triangles.data();
    input.triangleCount = triangles.size();
    const MeshResult result = buildTriMesh(input, {}, MeshOrder::kLocal);
    if (result.mesh == nullptr) return {};
    const bool isOne =
        isSolidPart(parts.front()) ? result.mesh->meshClass() == MeshClass::kSolid : isSheet(*result.mesh);
    if (!isOne) return {};
    joined.mesh = std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah);
    joined.parts = std::move(parts);
    return joined;
  }

  std::span<const JoinPart> parts_;
  const SharedPlaces shared_;
  std::vector<std::vector<bool>> inner_;  ///< by part and triangle: another one lies on it
  std::vector<std::uint32_t> root_;       ///< of the tree of parts that hang together
};

}  // namespace

std::vector<JoinedMesh> joinMeshes(std::span<const JoinPart> parts) {
  return Joiner(parts).run();
}

}  // namespace otg
