// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/smooth_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/vectors.h"
#include "collide/convex/convex_places.h"
#include "collide/shortest_translation.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/solid/merge_regions.h"
#include "collide/surface/cylinder_points.h"
#include "collide/surface/shape_planes.h"

namespace otg {
namespace {

constexpr double kNearlyFlat = 0.766;  ///< cosine of 40 degrees
constexpr std::size_t kMostPieces = 128;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All geometry is in the shape's frame.
class SmoothSolver {
 public:
  SmoothSolver(const NearSurface& near, Workspace& workspace)
      : near_(near),
        shape_(near.shape()),
        workspace_(workspace),
        mesh_(near.mesh()),
        links_(near.query().a->adjacency()),
        inside_(near.placed().toLocal(near.inside())),
        planes_(shape_) {}

  SurfaceAnswer run() {
    if (planes_.areMany()) return SurfaceAnswer::kOther;
    for (const std::uint32_t t : near_.touched()) {
      if (pieceCount_ == kMostPieces) return SurfaceAnswer::kOther;
      addPiece(t);
    }
    if (pieceCount_ == 0) return SurfaceAnswer::kApart;
    planes_.lookAt(low_, high_);
    if (!addStretches() || !findDirections()) return SurfaceAnswer::kOther;
    const double most = planes_.roomAround(inside_);
    ShortestTranslation way(emptyMemory(workspace_));
    std::uint32_t regions = 0;
    for (std::uint32_t p = 0; p < patchCount_; ++p) {
      if (!findPlaces(p)) return declined();
      if (places().empty()) continue;
      const double depth = deepest();
      if (depth <= near_.leastDepth()) continue;
      const Vec3d out = near_.placed().direction(patches_[p].direction);
      if (depth > most || !way.add(out, depth)) return declined();
      emit(out, depth, regions++);
    }
    if (workspace_.contacts.empty() || !isFree(way.value())) return declined();
    const SolidOptions& options = near_.query().options.solid;
    if (options.regionMerge > 0) {
      mergeRegions(options.regionMerge, options.contactsPerRegion, workspace_.contacts);
    }
    return SurfaceAnswer::kTouching;
  }

 private:
  using Corners = ShapePlanes::Corners;
  /// A triangle with a part in the shape.
  struct Piece {
    std::uint32_t triangle, patch;  ///< until all stretches are known, another piece of the patch
    Corners corner;
    Vec3d normal;
    double offset;  ///< normal . x on its plane
    double area;    ///< of the part
  };
  /// The part of an edge of the mesh in the shape, from Topology::Edge::a on.
  struct Stretch {
    std::uint32_t edge, piece;
    bool isFlat;
    ShapePlanes::Stretch part;
  };
  /// What hangs together in the shape.
  struct Patch {
    Vec3d direction;  ///< unit, out of the mesh
    double highest;   ///< along it
  };

  std::vector<ConvexPlace>& places() { return workspace_.convex.places; }

  SurfaceAnswer declined() {
    workspace_.contacts.clear();
    return SurfaceAnswer::kOther;
  }

  void addPiece(std::uint32_t t) {
    Piece& piece = pieces_[pieceCount_];
    piece.corner = cornersOf(t);
    piece.triangle = t;
    piece.normal = near_.placed().directionToLocal(links_.normal[t]);
    piece.offset = otgDot(piece.normal, piece.corner[0]);
    piece.area = 0.5 * otgDot(planes_.areaInside(piece.corner), piece.normal);
    if (!(piece.area > 0)) return;
    piece.patch = static_cast<std::uint32_t>(pieceCount_);
    ++pieceCount_;
    for (const Vec3d& p : planes_.polygon()) {
      low_ = minimum(low_, p);
      high_ = maximum(high_, p);
    }
  }

  /// Depths are measured below the patch: down to where the shape ends.
  void lookBelow(const Patch& patch) {
    const Vec3d& out = patch.direction;
    const Vec3d below = out * (otgDot(shape_.support(out * -1.0), out) - patch.highest);
    planes_.lookAlong(out, minimum(low_, low_ + below), maximum(high_, high_ + below));
  }

  Corners cornersOf(std::uint32_t t) const {
    Corners out;
    for (std::size_t k = 0; k < 3; ++k) out[k] = near_.placed().toLocal(near_.corner(t, k));
    return out;
  }

  /// Whether the shape, moved by `way`, is in no triangle that it was not in.
  bool isFree(const Vec3d& way) {
    if (!near_.isFree(way)) return false;
    if (!near_.looksAhead()) return true;
    const Vec3d moved = near_.placed().directionToLocal(way);
    return std::all_of(near_.touched().begin(), near_.touched().end(), [&](std::uint32_t t) {
      if (pieceOf(t) != kNone) return true;
      Corners corner = cornersOf(t);
      for (Vec3d& c : corner) c = c - moved;
      return norm(planes_.areaInside(corner)) == 0;
    });
  }

  /// The patch of a piece: the smallest of its pieces' numbers.
  std::uint32_t patchOf(std::uint32_t piece) {
    while (pieces_[piece].patch != piece) {
      piece = pieces_[piece].patch = pieces_[pieces_[piece].patch].patch;
    }
    return piece;
  }

  /// False where the surface ends in the shape.
  bool addStretches() {
    const Topology& topology = mesh_.topology();
    for (std::uint32_t i = 0; i < pieceCount_; ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t half = 3 * pieces_[i].triangle + k, twin = topology.twin[half];
        if (twin != kNone && twin / 3 < pieces_[i].triangle) continue;  // seen from there
        const std::uint32_t edge = topology.edgeOf[half];
        if (edge == kNone) return false;
        Vec3d from = pieces_[i].corner[k], to = pieces_[i].corner[(k + 1) % 3];
        if (topology.weld[mesh_.triangles()[pieces_[i].triangle].v[k]] != topology.edges[edge].a) std::swap(from, to);
        Stretch stretch{edge, i, links_.isFlatEdge(edge), {from, to - from, 0, 1}};
        if (!planes_.cut(stretch.part)) continue;
        if (twin == kNone) return false;
        const std::uint32_t other = pieceOf(twin / 3);
        if (other == kNone) continue;  // it is touched, and no more
        const std::uint32_t a = patchOf(i), b = patchOf(other);
        pieces_[std::max(a, b)].patch = std::min(a, b);
        stretches_[stretchCount_++] = stretch;
      }
    }
    return true;
  }

  std::uint32_t pieceOf(std::uint32_t triangle) const {
    const Piece *const begin = pieces_.data(), *const end = begin + pieceCount_;
    const Piece* const at =
        std::lower_bound(begin, end, triangle, [](const Piece& p, std::uint32_t t) { return p.triangle < t; });
    return at != end && at->triangle == triangle ? static_cast<std::uint32_t>(at - begin) : kNone;
  }

  /// False if a patch is not nearly flat, or has the shape's middle behind it.
  bool findDirections() {
    std::array<Vec3d, kMostPieces> sums;
    std::array<std::uint32_t, kMostPieces> numbers;
    for (std::uint32_t i = 0; i < pieceCount_; ++i) {
      const std::uint32_t first = patchOf(i);
      if (first == i) {
        sums[patchCount_] = {0, 0, 0};
        patches_[patchCount_] = {{}, -kInfinity};
        numbers[i] = patchCount_++;
      }
      numbers[i] = numbers[first];
      sums[numbers[i]] = sums[numbers[i]] + pieces_[i].normal * pieces_[i].area;
    }
    for (std::uint32_t i = 0; i < pieceCount_; ++i) pieces_[i].patch = numbers[i];
    for (std::uint32_t p = 0; p < patchCount_; ++p) patches_[p].direction = unit(sums[p]);
    return std::all_of(pieces_.data(), pieces_.data() + pieceCount_, [&](const Piece& piece) {
      Patch& patch = patches_[piece.patch];
      for (const Vec3d& c : piece.corner) patch.highest = std::max(patch.highest, otgDot(c, patch.direction));
      return otgDot(piece.normal, patch.direction) >= kNearlyFlat && otgDot(piece.normal, inside_) > piece.offset;
    });
  }

  bool findPlaces(std::uint32_t patch) {
    places().clear();
    if (!addCorners(patch)) return false;
    lookBelow(patches_[patch]);
    addVertices(patch);
    const double deep = deepest();
    for (std::size_t i = 0; i < stretchCount_; ++i) {
      if (!stretches_[i].isFlat && pieces_[stretches_[i].piece].patch == patch) addEdge(stretches_[i], deep);
    }
    return true;
  }

  /// `at` is on the shape.
  ConvexPlace& add(const Vec3d& at, double depth, const Vec3d& direction, ContactFeature feature, std::uint32_t element,
                   std::uint32_t triangle) {
    ConvexPlace& place = places().emplace_back();
    place = {};
    place.at = at + direction * (0.5 * depth);
    place.depth = depth;
    place.element = element;
    place.feature = static_cast<std::uint8_t>(feature);
    place.cornerA = triangle;
    // By the shape and not by the mesh, whose numbers are others where it is cut in pieces.
    constexpr Vec3d kAskew{0.48, 0.6, 0.64};
    place.rank = otgDot(place.at, kAskew);
    return place;
  }

  /// The shape's corners that are below the patch, and of a cylinder the points that stand for them. False if it is
  /// not known how far below one is.
  bool addCorners(std::uint32_t number) {
    bool areKnown = true;
    const auto offer = [&](const Vec3d& at, std::uint32_t element) {
      return areKnown && addCorner(number, at, element, areKnown);
    };
    if (shape_.isCurved()) {
      offerCylinder(number, offer);
    } else {
      for (std::uint32_t v = 0; v < shape_.vertices.size(); ++v) offer(shape_.vertices[v], v);
    }
    return areKnown;
  }

  /// Whether it is below the patch.
  bool addCorner(std::uint32_t number, const Vec3d& at, std::uint32_t element, bool& isKnown) {
    const Patch& patch = patches_[number];
    if (!(otgDot(at, patch.direction) < patch.highest) || !isBelow(at, number)) return false;
    const Piece* const above = pieceOver(number, at);
    if (above == nullptr) {
      isKnown = false;
      return false;
    }
    const double height = above->offset - otgDot(above->normal, at);
    add(at, height / otgDot(above->normal, patch.direction), patch.direction, ContactFeature::kVertexB, element,
        above->triangle);
    return true;
  }

  /// Ends of the line of its side on which a cylinder lies, or points of the rim of the end on which it stands; and the
  /// deepest point below some triangle, if none of these is as deep.
  template <class Offer>
  void offerCylinder(std::uint32_t number, const Offer& offer) {
    const Vec3d& out = patches_[number].direction;
    double deepest = 0;
    const auto note = [&] { deepest = std::max(deepest, places().back().depth); };
    if (std::fabs(out.z) < PlacedBody::kOnSide) {
      const double scale = -shape_.radius / std::hypot(out.x, out.y);
      for (const std::uint32_t end : {0U, 1U}) {
        const double z = end == 0 ? -shape_.length : shape_.length;
        if (!offer({scale * out.x, scale * out.y, z}, kCylinderSideEnd + end)) continue;
        places().back().isEnd = true;
        note();
      }
    } else {
      const CylinderRim rim(Transformd{}, {0, 0, -std::copysign(shape_.length, out.z)}, shape_.radius);
      for (std::uint32_t k = 0; k < CylinderRim::kPoints; ++k) {
        if (offer(rim.point(k), kCylinderRim + endOf(rim.centre) + k)) note();
      }
    }
    std::optional<ConvexPlace> lowest;
    for (std::size_t i = 0; i < pieceCount_; ++i) {
      if (pieces_[i].patch != number) continue;
      const Vec3d rear = shape_.support(pieces_[i].normal * -1.0);
      if (!offer(rear, kCylinderLowest + endOf(rear))) continue;
      if (!lowest || places().back().depth > lowest->depth) lowest = places().back();
      places().pop_back();
    }
    if (!lowest) return;
    if (!(deepest > kCylinderAsDeep * lowest->depth)) {
      places().push_back(*lowest);
    } else {
      for (ConvexPlace& place : places()) {
        if (place.depth == deepest) place.depth = std::max(deepest, lowest->depth);
      }
    }
  }
  /// Of a cylinder, as CylinderElement has them.
  static std::uint32_t endOf(const Vec3d& at) { return at.z < 0 ? 0 : 16; }

  /// Whether the way from a point to the shape's middle leads through the patch.
  bool isBelow(const Vec3d& at, std::uint32_t patch) const {
    const Vec3d way = inside_ - at;
    return std::any_of(pieces_.data(), pieces_.data() + pieceCount_, [&](const Piece& piece) {
      return piece.patch == patch && otgDot(piece.normal, at) < piece.offset && isOver(piece.corner, way, at);
    });
  }

  /// Null where the shape overhangs the point so far that what is above is not in the shape.
  const Piece* pieceOver(std::uint32_t patch, const Vec3d& at) const {
    const Piece *const begin = pieces_.data(), *const end = begin + pieceCount_;
    const Piece* const found = std::find_if(begin, end, [&](const Piece& piece) {
      return piece.patch == patch && otgDot(piece.normal, at) < piece.offset &&
             isOver(piece.corner, patches_[patch].direction, at);
    });
    return found == end ? nullptr : found;
  }

  /// Whether the line along a direction, which leads out of the triangle's front, meets it.
  static bool isOver(const Corners& corner, const Vec3d& direction, const Vec3d& at) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &from = corner[k], &to = corner[(k + 1) % 3];
      if (otgDot(otgCross(to - from, at - from), direction) < 0) return false;
    }
    return true;
  }

  /// The mesh's vertices in the shape, or above it where that overhangs.
  void addVertices(std::uint32_t patch) {
    const Vec3d& out = patches_[patch].direction;
    std::size_t count = 0;
    for (const Piece* piece = pieces_.data(); piece != pieces_.data() + pieceCount_; ++piece) {
      if (piece->patch != patch) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh_.topology().weld[mesh_.triangles()[piece->triangle].v[k]];
        std::uint32_t* const end = vertices_.data() + count;
        if (links_.flatVertex[v] != 0 || std::find(vertices_.data(), end, v) != end) continue;
        vertices_[count++] = v;
        const double depth = planes_.depthBelow(piece->corner[k]);
        if (depth > 0) add(piece->corner[k] - out * depth, depth, out, ContactFeature::kVertexA, v, piece->triangle);
      }
    }
  }

  /// The deepest place of a stretch, which is exact if there is a deeper one than `deep`; and its ends.
  void addEdge(const Stretch& s, double deep) {
    const Piece& piece = pieces_[s.piece];
    const Vec3d& out = patches_[piece.patch].direction;
    const auto offer = [&](double t, ContactFeature feature, std::uint32_t ordinal) {
      const Vec3d at = s.part.at(t);
      const double depth = planes_.depthBelow(at);
      if (!(depth > 0)) return;
      add(at - out * depth, depth, out, feature, s.edge, piece.triangle).ordinal = ordinal;
    };
    if (s.part.low > 0) offer(s.part.low, ContactFeature::kCrossingA, 0);
    if (s.part.high < 1) offer(s.part.high, ContactFeature::kCrossingA, 1);
    const double t = planes_.deepest(s.part, deep);
    if (t > 0 && t < 1) offer(t, ContactFeature::kMiddleA, 0);
  }

  /// Of all places so far.
  double deepest() const {
    double most = 0;
    for (const ConvexPlace& place : workspace_.convex.places) most = std::max(most, place.depth);
    return most;
  }

  void emit(const Vec3d& out, double depth, std::uint32_t region) {
    choosePlaces(places(), near_.query().options.solid.contactsPerRegion, depth);
    sortPlaces(places());
    for (const ConvexPlace& place : places()) {
      Contact& contact = addContact(workspace_.contacts, place, out * -1.0);
      contact.position = near_.placed().fromLocal(place.at);
      contact.triangleA = place.cornerA;
      contact.triangleB = kNone;
      contact.region = region;
    }
  }

  const NearSurface& near_;
  const ConvexGeometry& shape_;
  Workspace& workspace_;
  const TriMesh& mesh_;
  const Adjacency& links_;
  const Vec3d inside_;
  ShapePlanes planes_;
  Vec3d low_{kInfinity, kInfinity, kInfinity}, high_{-kInfinity, -kInfinity, -kInfinity};  ///< of all pieces
  std::array<Piece, kMostPieces> pieces_;
  std::array<Stretch, 3 * kMostPieces> stretches_;
  std::array<std::uint32_t, 3 * kMostPieces> vertices_;  ///< of a patch, that were looked at
  std::array<Patch, kMostPieces> patches_;
  std::size_t pieceCount_ = 0, stretchCount_ = 0;
  std::uint32_t patchCount_ = 0;
};

}  // namespace

SurfaceAnswer addSmoothContacts(const NearSurface& near, Workspace& workspace) {
  return SmoothSolver(near, workspace).run();
}

}  // namespace otg
