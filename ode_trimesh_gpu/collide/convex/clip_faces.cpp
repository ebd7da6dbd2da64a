// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/clip_faces.h"

#include <algorithm>

#include "collide/query.h"

namespace otg {
namespace {

/// Sutherland and Hodgman, 1974: keeps what is not beyond one side. False where that is all.
bool cut(const std::vector<ClippedPoint>& polygon, const Vec3d& outward, double offset, std::uint32_t edge,
         std::vector<ClippedPoint>& kept) {
  // Most sides cut nothing off.
  const bool cuts = std::any_of(polygon.begin(), polygon.end(),
                                [&](const ClippedPoint& p) { return otgDot(outward, p.at) > offset; });
  if (!cuts) return false;
  kept.clear();
  const std::size_t n = polygon.size();
  double here = otgDot(outward, polygon[0].at) - offset;
  for (std::size_t i = 0; i < n; ++i) {
    const ClippedPoint &p = polygon[i], &q = polygon[i + 1 < n ? i + 1 : 0];
    const double there = otgDot(outward, q.at) - offset;
    const bool isIn = here <= 0, staysIn = there <= 0;
    if (isIn) kept.push_back(p);
    if (isIn != staysIn) {
      const Vec3d at = p.at + (q.at - p.at) * (here / (here - there));
      kept.push_back(isIn ? ClippedPoint{at, edge, true} : ClippedPoint{at, p.edge, p.ofReference});
    }
    here = there;
  }
  return true;
}

}  // namespace

void clipFaces(const ConvexPair& pair, const Vec3d& m, const FacingFaces& faces, ConvexScratch& scratch) {
  const int r = faces.reference, i = 1 - r;
  scratch.polygon.clear();
  const ConvexPolyhedron& incident = pair.body(i);
  const std::uint32_t first = incident.face(faces.face[i]).corner;
  for (const ConvexPolyhedron::Corner& c : incident.corners(faces.face[i])) {
    const auto number = first + static_cast<std::uint32_t>(&c - &incident.corner(first));
    scratch.polygon.push_back({pair.place(i, c.vertex), number, false});
  }
  const Vec3d up = r == 0 ? m : otgScale(m, -1.0);  // out of the reference
  const ConvexPolyhedron& reference = pair.body(r);
  std::uint32_t number = reference.face(faces.face[r]).corner;
  const std::span<const ConvexPolyhedron::Corner> corners = reference.corners(faces.face[r]);
  Vec3d from = pair.place(r, corners.front().vertex);
  for (const ConvexPolyhedron::Corner& c : corners) {
    const Vec3d to = pair.place(r, c.next), outward = otgCross(to - from, up);
    if (cut(scratch.polygon, outward, otgDot(outward, from), number++, scratch.next)) {
      scratch.polygon.swap(scratch.next);
      if (scratch.polygon.empty()) return;
    }
    from = to;
  }
}

ConvexPlace placeOfPoint(const ConvexPair& pair, const Vec3d& m, const FacingFaces& faces,
                         const std::vector<ClippedPoint>& polygon, std::size_t i) {
  const int r = faces.reference;
  const ConvexPolyhedron &reference = pair.body(r), &incident = pair.body(1 - r);
  const ClippedPoint &point = polygon[i], &before = polygon[i > 0 ? i - 1 : polygon.size() - 1];
  ConvexPlace place{};
  // Along m to the reference's plane.
  const std::uint32_t onPlane = reference.corner(reference.face(faces.face[r]).corner).vertex;
  const Vec3d normal = pair.normal(r, faces.face[r]);
  const double way = otgDot(normal, pair.place(r, onPlane) - point.at) / otgDot(normal, m);
  place.depth = r == 0 ? way : -way;
  place.at = point.at + m * (0.5 * way);

  std::uint32_t corners[2] = {pair.a().face(faces.face[0]).corner, pair.b().face(faces.face[1]).corner};
  if (point.ofReference == before.ofReference) {
    const int body = point.ofReference ? r : 1 - r;
    const ConvexPolyhedron& own = point.ofReference ? reference : incident;
    // The reference's edges follow each other the other way round.
    std::uint32_t corner = point.edge;
    if (point.ofReference && own.corner(before.edge).vertex == own.corner(point.edge).next) corner = before.edge;
    corners[body] = corner;
    place.feature = static_cast<std::uint8_t>(body == 0 ? ContactFeature::kVertexA : ContactFeature::kVertexB);
    place.element = own.meshVertex(own.corner(corner).vertex);
  } else {
    const std::uint32_t ofReference = point.ofReference ? point.edge : before.edge;
    const std::uint32_t ofIncident = point.ofReference ? before.edge : point.edge;
    corners[r] = ofReference;
    corners[1 - r] = ofIncident;
    // Of A's edge: whether its stretch within B's face begins here or ends.
    const ConvexPolyhedron::Corner& edge = pair.a().corner(corners[0]);
    const bool beginsInPolygon = point.ofReference == (r == 0);
    const bool begins = (beginsInPolygon != (r == 0)) == edge.isForward;
    place.feature = static_cast<std::uint8_t>(ContactFeature::kCrossingA);
    place.element = edge.edge;
    place.ordinal = begins ? 0 : 1;
  }
  place.cornerA = corners[0];
  place.cornerB = corners[1];
  return place;
}

}  // namespace otg
