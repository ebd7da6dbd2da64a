// SPDX-License-Identifier: BSD-3-Clause
// The search for the least overlap of two convex bodies by their farthest points.
// Source: G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", 2001.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/vectors.h"

namespace otg {

struct PolytopeFace {
  std::uint8_t v[3];         ///< counter-clockwise seen from outside
  std::uint8_t adjacent[3];  ///< the face across the edge from v[k] to v[k + 1]
  bool isAlive, isClosed;    ///< closed: it does not come nearer to the body's surface any more
  Vec3d normal;
  double distance;  ///< of its plane from the origin; negative where that is outside
};

/// A polytope grows inside the body of differences of two convex bodies, face by face towards the origin. Distances of
/// faces have a sign, so that the origin may begin outside. Takes no memory.
///
/// `Bodies` has for a unit direction m: difference(m), the farthest difference, with a member `at`. look(m, difference)
/// learns of each, and returns false where that shows that the bodies are apart. isEnough(overlap, distance, rounding)
/// ends the search: `distance` bounds the least overlap from below, `overlap` is that along the nearest face's normal.
template <class Bodies>
class Polytope {
 public:
  Polytope(Bodies& bodies, const Vec3d& toB, double size)
      : bodies_(bodies), toB_(toB), rounding_(kPlaneRounding * size) {}

  /// False if the bodies are apart.
  bool run() {
    if (!begin()) return !apart_;
    for (;;) {
      const std::size_t nearest = nearestFace();
      if (nearest == kNoFace) return true;
      PolytopeFace& face = faces_[nearest];
      const std::size_t vertex = vertexCount_;
      if (vertex == kMostVertices) return true;
      if (!add(face.normal)) return false;
      const double overlap = otgDot(face.normal, vertices_[vertex].at);
      if (bodies_.isEnough(overlap, face.distance, rounding_)) return true;
      if (!grow(nearest, static_cast<std::uint8_t>(vertex))) {
        face.isClosed = true;
        --vertexCount_;
      }
    }
  }

 private:
  static constexpr std::size_t kMostVertices = 120, kMostFaces = 2 * kMostVertices, kMostRim = 64;
  static constexpr std::size_t kNoFace = kMostFaces;
  static constexpr double kPlaneRounding = 1e-13;  ///< of the size: distances do not show more

  /// The farthest difference along a unit direction. False if the bodies are apart along it.
  bool add(const Vec3d& m) {
    vertices_[vertexCount_] = bodies_.difference(m);
    apart_ = !bodies_.look(m, vertices_[vertexCount_]);
    ++vertexCount_;
    return !apart_;
  }

  /// A tetrahedron, the first vertex of which is the one that most likely separates bodies.
  bool begin() {
    const Vec3d first = norm(toB_) > 0 ? unit(toB_) : Vec3d{0, 0, 1};
    if (!add(first) || !add(otgScale(first, -1.0))) return false;
    const Vec3d along = vertices_[1].at - vertices_[0].at;
    const Vec3d axis = std::fabs(along.x) <= std::fabs(along.y) && std::fabs(along.x) <= std::fabs(along.z)
                           ? Vec3d{1, 0, 0}
                       : std::fabs(along.y) <= std::fabs(along.z) ? Vec3d{0, 1, 0}
                                                                  : Vec3d{0, 0, 1};
    // Sideways towards the origin, where that is beside the line.
    const Vec3d beside = otgScale(vertices_[0].at, -1.0);
    Vec3d side = otgCross(otgCross(along, beside), along);
    if (!(norm(side) > 1e-6 * otgDot(along, along) * norm(beside))) side = otgCross(along, axis);
    side = unit(side);
    if (!add(side)) return false;
    if (!(std::fabs(otgDot(side, vertices_[2].at - vertices_[0].at)) > rounding_)) {
      --vertexCount_;
      if (!add(otgScale(side, -1.0))) return false;
    }
    Vec3d up = unit(otgCross(vertices_[1].at - vertices_[0].at, vertices_[2].at - vertices_[0].at));
    if (otgDot(up, vertices_[0].at) > 0) up = otgScale(up, -1.0);
    if (!add(up)) return false;
    if (!(std::fabs(otgDot(up, vertices_[3].at - vertices_[0].at)) > rounding_)) {
      --vertexCount_;
      if (!add(otgScale(up, -1.0))) return false;
    }
    if (otgDot(otgCross(vertices_[1].at - vertices_[0].at, vertices_[2].at - vertices_[0].at),
               vertices_[3].at - vertices_[0].at) > 0) {
      std::swap(vertices_[1], vertices_[2]);
    }
    // Now the last vertex is below the first three.
    constexpr std::uint8_t kFaces[4][6] = {
        {0, 1, 2, 1, 2, 3}, {0, 3, 1, 3, 2, 0}, {1, 3, 2, 1, 3, 0}, {2, 3, 0, 2, 1, 0}};
    for (const auto& f : kFaces) {
      if (!place(faces_[faceCount_], f[0], f[1], f[2])) return false;
      for (std::size_t k = 0; k < 3; ++k) faces_[faceCount_].adjacent[k] = f[3 + k];
      ++faceCount_;
    }
    return true;
  }

  bool place(PolytopeFace& face, std::uint8_t a, std::uint8_t b, std::uint8_t c) const {
    const Vec3d cross = otgCross(vertices_[b].at - vertices_[a].at, vertices_[c].at - vertices_[a].at);
    const double length = norm(cross);
    if (!(length > std::numeric_limits<double>::min())) return false;
    const Vec3d normal = cross * (1 / length);
    face = {{a, b, c}, {0, 0, 0}, true, false, normal, otgDot(normal, vertices_[a].at)};
    return true;
  }

  std::size_t nearestFace() const {
    std::size_t nearest = kNoFace;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < faceCount_; ++f) {
      if (!faces_[f].isAlive || faces_[f].isClosed || !(faces_[f].distance < least)) continue;
      least = faces_[f].distance;
      nearest = f;
    }
    return nearest;
  }

  /// Replaces the faces that see a vertex by those from it to their rim. False, and nothing has changed, where that is
  /// no ring of sound triangles.
  bool grow(std::size_t seen, std::uint8_t vertex) {
    hiddenCount_ = rimCount_ = 0;
    overflow_ = false;
    faces_[seen].isAlive = false;
    hidden_[hiddenCount_++] = static_cast<std::uint8_t>(seen);
    for (std::uint8_t k = 0; k < 3; ++k) look(seen, k, vertices_[vertex].at);
    bool isSound = !overflow_ && rimCount_ >= 3;
    for (std::size_t i = 0; isSound && i < rimCount_; ++i) {
      const Rim& rim = rim_[i];
      const PolytopeFace& outer = faces_[rim.face];
      const std::uint8_t from = outer.v[(rim.edge + 1) % 3], to = outer.v[rim.edge];
      isSound = place(fresh_[i], from, to, vertex);
      // The rim goes round: each begins where the last one ended.
      const Rim& last = rim_[(i + rimCount_ - 1) % rimCount_];
      isSound = isSound && faces_[last.face].v[last.edge] == from;
    }
    if (!isSound) {
      for (std::size_t i = 0; i < hiddenCount_; ++i) faces_[hidden_[i]].isAlive = true;
      return false;
    }
    // In the places of those that go, of which there are up to two less.
    std::array<std::uint8_t, kMostRim> to;
    for (std::size_t i = 0; i < rimCount_; ++i) {
      to[i] = i < hiddenCount_ ? hidden_[i] : static_cast<std::uint8_t>(faceCount_++);
    }
    for (std::size_t i = 0; i < rimCount_; ++i) {
      const Rim& rim = rim_[i];
      PolytopeFace& face = faces_[to[i]];
      face = fresh_[i];
      face.adjacent[0] = rim.face;
      face.adjacent[1] = to[(i + 1) % rimCount_];
      face.adjacent[2] = to[(i + rimCount_ - 1) % rimCount_];
      faces_[rim.face].adjacent[rim.edge] = to[i];
    }
    return true;
  }

  /// Across edge k of a face that sees the point: on, or the rim. In turn, so that the rim comes in order.
  void look(std::size_t from, std::uint8_t k, const Vec3d& point) {
    const std::uint8_t f = faces_[from].adjacent[k];
    if (!faces_[f].isAlive) return;
    std::uint8_t back = 0;
    while (back < 3 && !(faces_[f].adjacent[back] == from && faces_[f].v[(back + 1) % 3] == faces_[from].v[k])) ++back;
    if (back == 3) {
      overflow_ = true;
      return;
    }
    if (otgDot(faces_[f].normal, point) > faces_[f].distance + rounding_) {
      faces_[f].isAlive = false;
      hidden_[hiddenCount_++] = f;
      look(f, (back + 1) % 3, point);
      look(f, (back + 2) % 3, point);
      return;
    }
    if (rimCount_ == rim_.size()) {
      overflow_ = true;
    } else {
      rim_[rimCount_++] = {f, back};
    }
  }

  struct Rim {
    std::uint8_t face, edge;  ///< of the face that stays
  };

  Bodies& bodies_;
  const Vec3d toB_;
  const double rounding_;
  std::array<typename Bodies::Difference, kMostVertices> vertices_;
  std::array<PolytopeFace, kMostFaces> faces_;
  std::array<std::uint8_t, kMostFaces> hidden_;
  std::array<Rim, kMostRim> rim_;
  std::array<PolytopeFace, kMostRim> fresh_;
  std::size_t vertexCount_ = 0, faceCount_ = 0, hiddenCount_ = 0, rimCount_ = 0;
  bool overflow_ = false, apart_ = false;
};

}  // namespace otg
