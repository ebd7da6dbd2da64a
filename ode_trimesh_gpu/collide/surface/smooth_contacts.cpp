// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/smooth_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <optional>
#include <vector>

#include "base/flat_map.h"
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
constexpr double kDeeper = 1.001;      ///< of depths: more than the rounding of a flat face
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
        planes_(shape_),
        memory_(emptyMemory(workspace)),
        pieces_(memory_),
        stretches_(memory_),
        patches_(memory_) {}

  SurfaceAnswer run() {
    if (planes_.areMany()) return SurfaceAnswer::kOther;
    pieces_.reserve(near_.touched().size());
    for (const std::uint32_t t : near_.touched()) addPiece(t);
    if (pieces_.empty()) return SurfaceAnswer::kApart;
    planes_.lookAt(low_, high_);
    if (!addStretches() || !findDirections()) return SurfaceAnswer::kOther;
    const double most = planes_.roomAround(inside_);
    ShortestTranslation way(memory_);
    std::uint32_t regions = 0;
    for (std::uint32_t p = 0; p < patches_.size(); ++p) {
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
    double offset;       ///< normal . x on its plane
    double area;         ///< of the part
    std::uint32_t face;  ///< of the shape, where the part ends: ShapePlanes::faceOfPart()
  };
  /// The part of an edge of the mesh in the shape, from Topology::Edge::a on.
  struct Stretch {
    std::uint32_t edge, piece;
    bool isFlat;
    ShapePlanes::Stretch part;
  };
  /// What hangs together in the shape.
  struct Patch {
    Vec3d direction;     ///< unit, out of the mesh; first the sum of normals times areas
    double highest;      ///< along it
    std::uint32_t face;  ///< of the shape, if all of the patch ends there, and it goes from there into the shape
    bool isUnderFace() const { return face < ShapePlanes::kSeveral; }
  };

  std::vector<ConvexPlace>& places() { return workspace_.convex.places; }

  SurfaceAnswer declined() {
    workspace_.contacts.clear();
    return SurfaceAnswer::kOther;
  }

  void addPiece(std::uint32_t t) {
    Piece piece;
    piece.corner = cornersOf(t);
    piece.triangle = t;
    piece.normal = near_.placed().directionToLocal(links_.normal[t]);
    piece.offset = otgDot(piece.normal, piece.corner[0]);
    piece.area = 0.5 * otgDot(planes_.areaInside(piece.corner), piece.normal);
    if (!(piece.area > 0)) return;
    piece.face = planes_.faceOfPart();
    piece.patch = static_cast<std::uint32_t>(pieces_.size());
    pieces_.push_back(piece);
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
    const Vec3d moved = near_.placed().directionToLocal(way);
    return near_.isFree(way, [&](std::uint32_t t) {
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
    stretches_.reserve(2 * pieces_.size());
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
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
        stretches_.push_back(stretch);
      }
    }
    return true;
  }

  std::uint32_t pieceOf(std::uint32_t triangle) const {
    const auto at = std::ranges::lower_bound(pieces_, triangle, {}, &Piece::triangle);
    return at != pieces_.end() && at->triangle == triangle ? static_cast<std::uint32_t>(at - pieces_.begin()) : kNone;
  }

  /// A patch that ends at one face of the shape, as feet on a floor do, is against that face. Another one is against
  /// the mean of its normals. False if that is not nearly flat, or has the shape's middle behind it.
  bool findDirections() {
    std::pmr::vector<std::uint32_t> numbers(pieces_.size(), memory_);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      const std::uint32_t first = patchOf(i);
      if (first == i) {
        numbers[i] = static_cast<std::uint32_t>(patches_.size());
        patches_.push_back({{0, 0, 0}, -kInfinity, ShapePlanes::kWithin});
      }
      numbers[i] = numbers[first];
      Patch& patch = patches_[numbers[i]];
      patch.direction = patch.direction + pieces_[i].normal * pieces_[i].area;
      const std::uint32_t face = pieces_[i].face;
      if (patch.face == ShapePlanes::kWithin) patch.face = face;
      if (face != ShapePlanes::kWithin && face != patch.face) patch.face = ShapePlanes::kSeveral;
    }
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) pieces_[i].patch = numbers[i];
    for (Patch& patch : patches_) {
      const Vec3d& mean = patch.direction;
      if (patch.isUnderFace() && !(otgDot(planes_.normal(patch.face), mean) < 0)) patch.face = ShapePlanes::kSeveral;
      patch.direction = patch.isUnderFace() ? planes_.normal(patch.face) * -1.0 : unit(mean);
    }
    return std::ranges::all_of(pieces_, [&](const Piece& piece) {
      Patch& patch = patches_[piece.patch];
      for (const Vec3d& c : piece.corner) patch.highest = std::max(patch.highest, otgDot(c, patch.direction));
      return patch.isUnderFace() ||
             (otgDot(piece.normal, patch.direction) >= kNearlyFlat && otgDot(piece.normal, inside_) > piece.offset);
    });
  }

  bool findPlaces(std::uint32_t patch) {
    places().clear();
    const bool isUnderFace = patches_[patch].isUnderFace();
    if (!isUnderFace && !addCorners(patch)) return false;
    lookBelow(patches_[patch]);
    addVertices(patch);
    if (isUnderFace) return isNearestFace(patch);
    const double deep = deepest();
    for (const Stretch& stretch : stretches_) {
      if (!stretch.isFlat && pieces_[stretch.piece].patch == patch) addEdge(stretch, deep);
    }
    return true;
  }

  /// Whether no other face is nearer to the deepest vertex: then no way out is shorter than the one through this.
  bool isNearestFace(std::uint32_t patch) {
    constexpr double kAsNear = 1 - 1e-9;
    const auto depthOf = [](const ConvexPlace& place) { return place.depth; };
    const auto deepest = std::ranges::max_element(places(), {}, depthOf);
    if (deepest == places().end()) return true;
    const Vec3d vertex = deepest->at + patches_[patch].direction * (0.5 * deepest->depth);
    return planes_.roomAround(vertex) >= kAsNear * deepest->depth;
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
    for (const Piece& piece : pieces_) {
      if (piece.patch != number) continue;
      const Vec3d rear = shape_.support(piece.normal * -1.0);
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
  bool isBelow(const Vec3d& at, std::uint32_t patch) {
    return meetsPieces(at, inside_) && firstPiece(patch, lastBelow_, [&](const Piece& piece) {
                                         return otgDot(piece.normal, at) < piece.offset &&
                                                isOver(piece.corner, inside_ - at, at);
                                       }) != nullptr;
  }

  /// Whether a segment in the shape may meet a piece: it comes to the box around their parts in the shape, or nearly.
  bool meetsPieces(const Vec3d& from, const Vec3d& to) const {
    constexpr double kNearly = 1e-6;  // of the box's size
    const double slack = kNearly * norm(high_ - low_);
    double first = 0, last = 1;
    const auto cut = [&](double low, double high, double way) {
      if (way == 0) return low <= slack && high >= -slack;
      const double a = (low - slack) / way, b = (high + slack) / way;
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
      return first <= last;
    };
    const Vec3d low = low_ - from, high = high_ - from, way = to - from;
    return cut(low.x, high.x, way.x) && cut(low.y, high.y, way.y) && cut(low.z, high.z, way.z);
  }

  /// Null where the shape overhangs the point so far that what is above is not in the shape.
  const Piece* pieceOver(std::uint32_t patch, const Vec3d& at) {
    return firstPiece(patch, lastOver_, [&](const Piece& piece) {
      return otgDot(piece.normal, at) < piece.offset && isOver(piece.corner, patches_[patch].direction, at);
    });
  }

  /// A piece of the patch for which that is true, or null. `last`, the number of the last answer, is tried first: one
  /// point after the other lies below the same piece.
  template <class IsIt>
  const Piece* firstPiece(std::uint32_t patch, std::size_t& last, const IsIt& isIt) const {
    const auto isHere = [&](const Piece& piece) { return piece.patch == patch && isIt(piece); };
    if (last < pieces_.size() && isHere(pieces_[last])) return &pieces_[last];
    const auto found = std::ranges::find_if(pieces_, isHere);
    if (found == pieces_.end()) return nullptr;
    last = static_cast<std::size_t>(found - pieces_.begin());
    return &*found;
  }

  /// Whether the line along a direction, which leads out of the triangle's front, meets it.
  static bool isOver(const Corners& corner, const Vec3d& direction, const Vec3d& at) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &from = corner[k], &to = corner[(k + 1) % 3];
      if (otgDot(otgCross(to - from, at - from), direction) < 0) return false;
    }
    return true;
  }

  /// The mesh's vertices in the shape, or above it where that overhangs. Of those that are there only because of the
  /// tessellation the deepest one, if no other is as deep: all of a fine mesh are such.
  void addVertices(std::uint32_t patch) {
    const Vec3d& out = patches_[patch].direction;
    const auto offer = [&](const Piece& piece, std::size_t k, double depth) {
      add(piece.corner[k] - out * depth, depth, out, ContactFeature::kVertexA, weldOf(piece, k), piece.triangle);
    };
    FlatMap seen(memory_);
    const Piece* flattest = nullptr;
    std::size_t corner = 0;
    double deepestFlat = 0;
    for (const Piece& piece : pieces_) {
      if (piece.patch != patch) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = weldOf(piece, k);
        bool isNew = false;
        seen.insert(v, 0, &isNew);
        const double depth = isNew ? planes_.depthBelow(piece.corner[k]) : 0;
        if (!(depth > 0)) continue;
        if (links_.flatVertex[v] == 0) {
          offer(piece, k, depth);
        } else if (depth > deepestFlat) {
          deepestFlat = depth;
          flattest = &piece;
          corner = k;
        }
      }
    }
    if (flattest != nullptr && deepestFlat > kDeeper * deepest()) offer(*flattest, corner, deepestFlat);
  }
  std::uint32_t weldOf(const Piece& piece, std::size_t k) const {
    return mesh_.topology().weld[mesh_.triangles()[piece.triangle].v[k]];
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
  std::pmr::memory_resource* const memory_;
  std::pmr::vector<Piece> pieces_;
  std::pmr::vector<Stretch> stretches_;
  std::pmr::vector<Patch> patches_;
  std::size_t lastBelow_ = 0, lastOver_ = 0;  ///< pieces that firstPiece() found
};

}  // namespace

SurfaceAnswer addSmoothContacts(const NearSurface& near, Workspace& workspace) {
  return SmoothSolver(near, workspace).run();
}

}  // namespace otg
