// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex/convex_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"
#include "collide/contact_order.h"
#include "collide/pairwise/reduction.h"
#include "shared/contacts/solid_model.h"

namespace otg {
namespace {

constexpr std::size_t kMostContacts = 8;  ///< of a pair

int kindOf(const ConvexPlace& place) {
  const auto feature = static_cast<ContactFeature>(place.feature);
  if (feature == ContactFeature::kMiddleA) return OTG_POINT_MIDDLE;
  return feature == ContactFeature::kCrossingA ? OTG_POINT_CROSSING : OTG_POINT_VERTEX;
}
bool isBefore(const ConvexPlace& x, const ConvexPlace& y) {
  if (x.step != y.step) return x.step < y.step;
  if (x.feature != y.feature) return x.feature < y.feature;
  if (x.rank != y.rank) return x.rank < y.rank;
  return x.element != y.element ? x.element < y.element : x.ordinal < y.ordinal;
}

}  // namespace

std::uint32_t touchingFace(const ConvexPolyhedron& shape, std::uint32_t vertex, const Vec3d& direction, double& along) {
  constexpr double kLiesOnEdge = 0.05;  // sine of an edge's slope
  std::uint32_t best = kNone, flattest = kNone;
  double least = kLiesOnEdge;
  along = -2;
  for (const std::uint32_t c : shape.cornersAt(vertex)) {
    const ConvexPolyhedron::Corner& corner = shape.corner(c);
    if (const double cosine = otgDot(shape.face(corner.face).normal, direction); cosine > along) {
      along = cosine;
      best = corner.face;
    }
    const Vec3d edge = shape.vertices()[corner.next] - shape.vertices()[corner.vertex];
    const double length = norm(edge);
    if (const double slope = std::fabs(otgDot(edge, direction)); slope < least * length) {
      least = slope / length;
      flattest = c;
    }
  }
  if (along >= kTouchesAsFace || flattest == kNone) return best;
  const ConvexPolyhedron::Corner& edge = shape.corner(flattest);
  const double left = otgDot(shape.face(edge.face).normal, direction);
  const double right = otgDot(shape.face(edge.across).normal, direction);
  along = std::max(left, right);
  return left >= right ? edge.face : edge.across;
}

// As in region_contacts.
void choosePlaces(std::vector<ConvexPlace>& places, int mostPlaces, double overlap) {
  double deepest = 0;
  Vec3d lo = places.front().at, hi = lo;
  for (const ConvexPlace& p : places) deepest = std::max(deepest, p.depth);
  std::size_t kept = 0;
  for (ConvexPlace& p : places) {
    if (!p.isEnd && !(p.depth >= otgLeastOfKind(kindOf(p), deepest))) continue;
    p.step = static_cast<std::uint8_t>(std::min(otgRankStep(p.depth, deepest), 255));
    lo = minimum(lo, p.at);
    hi = maximum(hi, p.at);
    places[kept++] = p;
  }
  places.resize(kept);
  std::sort(places.begin(), places.end(), isBefore);
  const Vec3d across = hi - lo;
  // Places in one point but for rounding have an extent, too.
  constexpr double kLeastExtent = 1e-3;  // of the depth
  const double least = kLeastExtent * deepest;
  const double scale = 1 / std::max(otgDot(across, across), least * least);
  // Corners that came out twice, where an edge runs through a corner.
  constexpr double kSame = 1e-12;
  const std::size_t most = std::min(kMostContacts, static_cast<std::size_t>(mostPlaces));
  for (ConvexPlace& p : places) p.spread = std::numeric_limits<double>::infinity();
  std::size_t count = 1;
  for (; count < std::min(most, places.size()); ++count) {
    std::size_t best = count;
    for (std::size_t j = count; j < places.size(); ++j) {
      const Vec3d d = places[j].at - places[count - 1].at;
      places[j].spread = std::min(places[j].spread, otgDot(d, d) * scale);
      if (otgWorth(places[j].spread, places[j].depth, deepest) >
          OTG_SOLID_FARTHER * otgWorth(places[best].spread, places[best].depth, deepest)) {
        best = j;
      }
    }
    if (!(places[best].spread > kSame)) break;
    std::rotate(places.begin() + static_cast<std::ptrdiff_t>(count), places.begin() + static_cast<std::ptrdiff_t>(best),
                places.begin() + static_cast<std::ptrdiff_t>(best) + 1);
  }
  places.resize(count);
  std::max_element(places.begin(), places.end(), [](const ConvexPlace& x, const ConvexPlace& y) {
    return x.depth < y.depth;
  })->depth = overlap;
}

std::uint32_t triangleAt(const ConvexPolyhedron& shape, const TriMesh& mesh, std::uint32_t corner, const Vec3d& point) {
  const std::uint32_t face = shape.corner(corner).face;
  const Vec3d normal = shape.face(face).normal;
  std::uint32_t triangle = shape.corner(corner).triangle;
  for (std::size_t steps = 0; steps < mesh.triangleCount(); ++steps) {
    std::uint32_t beyond = kNone;
    for (std::uint32_t k = 0; k < 3 && beyond == kNone; ++k) {
      const std::uint32_t other = mesh.topology().twin[3 * triangle + k] / 3;
      if (shape.faceOfTriangle(other) != face) continue;
      const Vec3f &from = mesh.vertices()[mesh.triangles()[triangle].v[k]],
                  &to = mesh.vertices()[mesh.triangles()[triangle].v[(k + 1) % 3]];
      const Vec3d p{from.x, from.y, from.z}, q{to.x, to.y, to.z};
      if (otgDot(otgCross(q - p, point - p), normal) < 0) beyond = other;
    }
    if (beyond == kNone) break;
    triangle = beyond;
  }
  return triangle;
}

void sortPlaces(std::vector<ConvexPlace>& places) {
  std::sort(places.begin(), places.end(), [](const ConvexPlace& x, const ConvexPlace& y) {
    if (x.depth != y.depth) return x.depth > y.depth;
    if (x.feature != y.feature) return x.feature < y.feature;
    return x.element != y.element ? x.element < y.element : x.ordinal < y.ordinal;
  });
}

Contact& addContact(std::vector<Contact>& contacts, const ConvexPlace& place, const Vec3d& normal) {
  Contact& contact = contacts.emplace_back();
  contact.position = place.at;
  contact.normal = normal;
  contact.depth = place.depth;
  contact.region = 0;
  contact.feature = static_cast<ContactFeature>(place.feature);
  if (kindOf(place) != OTG_POINT_CROSSING) contact.flags |= kContactInside;
  contact.element = place.element;
  contact.ordinal = place.ordinal;
  contact.coherence = 1;
  return contact;
}

void reduceConvexContacts(const Query& query, Workspace& workspace) {
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  if (workspace.contacts.size() > static_cast<std::size_t>(query.options.maxContacts)) {
    workspace.reduced = limitContacts(workspace.contacts, query.options.maxContacts);
  } else {
    workspace.reduced.assign(workspace.contacts.begin(), workspace.contacts.end());
    std::sort(workspace.reduced.begin(), workspace.reduced.end(), contactDeeper);
  }
}

}  // namespace otg
