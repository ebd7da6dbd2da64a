// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_parts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "mesh/adjacency_links.h"
#include "mesh/containment.h"
#include "mesh/inspection.h"
#include "mesh/measure.h"

namespace otg {
namespace {

/// Whether all numbers are below `limit` or, where that is allowed, kNone. Without a branch, so that it is done several
/// at a time.
bool allBelow(const std::uint32_t* begin, std::size_t count, std::size_t limit, bool noneToo) {
  const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(limit, kNone));
  std::uint32_t bad = 0;
  if (noneToo) {
    for (std::size_t i = 0; i < count; ++i) bad |= (begin[i] >= most) & (begin[i] != kNone);
  } else {
    for (std::size_t i = 0; i < count; ++i) bad |= begin[i] >= most;
  }
  return bad == 0;
}
bool allBelow(const SharedArray<std::uint32_t>& numbers, std::size_t begin, std::size_t end, std::size_t limit,
              bool noneToo) {
  return allBelow(numbers.data() + begin, end - begin, limit, noneToo);
}

/// An exponent of ones carries into the place of the sign.
bool allFinite(const Vec3f* begin, std::size_t count) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const float* const numbers = count == 0 ? nullptr : &begin->x;
  std::uint32_t carried = 0;
  for (std::size_t i = 0; i < 3 * count; ++i) {
    carried |= (std::bit_cast<std::uint32_t>(numbers[i]) & 0x7fffffffu) + 0x00800000u;
  }
  return carried >> 31 == 0;
}

}  // namespace

TriMeshParts TriMeshParts::of(const TriMesh& mesh) {
  TriMeshParts parts;
  parts.vertices = mesh.vertices_;
  parts.triangles = mesh.triangles_;
  parts.degenerate = mesh.degenerate_;
  parts.topology = mesh.topology_;
  parts.report = mesh.report_;
  parts.mass = mesh.massProperties();
  parts.boundsMin = mesh.boundsMin_;
  parts.boundsMax = mesh.boundsMax_;
  parts.center = mesh.center_;
  parts.origin = mesh.origin_;
  parts.radius = mesh.radius_;
  parts.inputVertexCount = mesh.inputVertexCount_;
  parts.inputVertexOf = mesh.inputVertexOf_;
  parts.callerTriangle = mesh.callerTriangle_;
  parts.triangleOfCaller = mesh.triangleOfCaller_;
  return parts;
}

std::shared_ptr<const TriMesh> TriMeshParts::assemble(TriMeshParts&& parts) {
  const std::shared_ptr<TriMesh> mesh(new TriMesh);
  mesh->links_ = std::make_shared<FirstUse<AdjacencyLinks>>();
  mesh->firstCopies_ = std::make_shared<FirstUse<std::vector<std::uint32_t>>>();
  mesh->trianglesHash_ = std::make_shared<FirstUse<std::uint64_t>>();
  mesh->vertices_ = std::move(parts.vertices);
  mesh->triangles_ = std::move(parts.triangles);
  mesh->degenerate_ = std::move(parts.degenerate);
  mesh->topology_ = std::move(parts.topology);
  mesh->report_ = std::move(parts.report);
  mesh->mass_.set(parts.mass);
  mesh->boundsMin_ = parts.boundsMin;
  mesh->boundsMax_ = parts.boundsMax;
  mesh->center_ = parts.center;
  mesh->origin_ = parts.origin;
  mesh->radius_ = parts.radius;
  mesh->inputVertexCount_ = parts.inputVertexCount;
  mesh->inputVertexOf_ = std::move(parts.inputVertexOf);
  mesh->callerTriangle_ = std::move(parts.callerTriangle);
  mesh->triangleOfCaller_ = std::move(parts.triangleOfCaller);
  return mesh;
}

TriMeshCheck::TriMeshCheck(const TriMeshParts& parts) : parts_(parts) {
  const Topology& topology = parts.topology;
  const std::size_t v = parts.vertices.size(), t = parts.triangles.size(), own = parts.inputVertexOf.size(),
                    caller = parts.callerTriangle.size();
  sizesMatch_ = v <= kMaxVertices && t <= kMaxTriangles && parts.degenerate.size() == t && topology.weld.size() == v &&
                topology.edgeOf.size() == 3 * t && topology.twin.size() == 3 * t && topology.componentOf.size() == t &&
                topology.componentVolume.size() == topology.componentClosed.size() && (own == 0 || own == v) &&
                (caller == 0 || caller == t) && parts.triangleOfCaller.size() == caller;
}

void TriMeshCheck::vertices(std::size_t begin, std::size_t end) {
  finite_ &= allFinite(parts_.vertices.data() + begin, end - begin);
}

void TriMeshCheck::triangles(std::size_t begin, std::size_t end) {
  if (begin == end) return;
  inRange_ &= allBelow(parts_.triangles[begin].v, 3 * (end - begin), parts_.vertices.size(), false);
}

/// Each vertex names one that is no later, and that names itself.
void TriMeshCheck::weld(std::size_t begin, std::size_t end) {
  const std::uint32_t* const weld = parts_.topology.weld.data();
  std::uint32_t bad = 0;
  for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
    const std::uint32_t point = std::min(weld[i], i);
    bad |= (point ^ weld[i]) | (weld[point] ^ point);
  }
  pointsMatch_ &= bad == 0;
}

void TriMeshCheck::edgeOf(std::size_t begin, std::size_t end) {
  inRange_ &= allBelow(parts_.topology.edgeOf, begin, end, parts_.topology.edges.size(), true);
}

/// Two half-edges that name each other are seen at the later of them. All is well if so many pairs are twice as many as
/// name one: then each of these is in a pair, and what it names is in the array.
void TriMeshCheck::twin(std::size_t begin, std::size_t end) {
  const std::uint32_t *const twin = parts_.topology.twin.data(), *const edgeOf = parts_.topology.edgeOf.data();
  std::uint32_t have = 0, pairs = 0;
  for (std::size_t h = begin; h < end; ++h) have += twin[h] != kNone;
  for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
    const std::uint32_t earlier = std::min(twin[h], h);
    pairs += (earlier < h) & (twin[earlier] == h) & (edgeOf[earlier] == edgeOf[h]);
  }
  haveTwin_ += have;
  twinPairs_ += pairs;
}

void TriMeshCheck::edges(std::size_t begin, std::size_t end) {
  if (begin == end) return;
  inRange_ &= allBelow(&parts_.topology.edges[begin].a, 2 * (end - begin), parts_.vertices.size(), false);
}

void TriMeshCheck::componentOf(std::size_t begin, std::size_t end) {
  inRange_ &= allBelow(parts_.topology.componentOf, begin, end, parts_.topology.componentCount(), true);
}

void TriMeshCheck::inputVertexOf(std::size_t begin, std::size_t end) {
  inRange_ &= allBelow(parts_.inputVertexOf, begin, end, parts_.inputVertexCount, false);
}

void TriMeshCheck::callerTriangle(std::size_t begin, std::size_t end) {
  numbersMatch_ &= allBelow(parts_.callerTriangle, begin, end, parts_.triangles.size(), false);
}

/// What names each of the numbers below its size is a permutation.
void TriMeshCheck::triangleOfCaller(std::size_t begin, std::size_t end) {
  const std::uint32_t *const own = parts_.triangleOfCaller.data(), *const caller = parts_.callerTriangle.data();
  const std::size_t count = parts_.callerTriangle.size();
  std::uint32_t bad = 0;
  for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) bad |= caller[own[i] < count ? own[i] : 0] ^ i;
  numbersMatch_ &= bad == 0 && allBelow(own + begin, end - begin, count, false);
}

std::string TriMeshCheck::faultOfNumbers() const {
  const std::size_t v = parts_.vertices.size();
  const bool counted =
      parts_.inputVertexOf.empty() ? parts_.inputVertexCount == v : parts_.inputVertexCount <= kMaxVertices;
  if (!sizesMatch_ || !counted) return "arrays of sizes that do not match";
  // An empty mesh has no bounds, and the radius of the largest ones is rounded up to infinity.
  const Vec3f places[] = {parts_.boundsMin, parts_.boundsMax, parts_.center, parts_.origin};
  const bool bounded = parts_.triangles.empty() || allFinite(places, std::size(places));
  if (!finite_ || !bounded || !(parts_.radius >= 0)) return "a vertex or bound that is not finite";
  if (!inRange_) return "a number out of range";
  if (!pointsMatch_) return "points that do not match";
  if (haveTwin_ != 2 * twinPairs_) return "neighbours that do not match";
  if (!numbersMatch_) return "numbers of triangles that do not match";
  const MassProperties& mass = parts_.mass;
  bool finite = std::isfinite(mass.volume) && std::isfinite(mass.area) && mass.centerOfMass.allFinite() &&
                mass.inertia.allFinite();
  for (const double volume : parts_.topology.componentVolume) finite = finite && std::isfinite(volume);
  return finite ? "" : "a mass that is not finite";
}

bool TriMeshCheck::measuresMatch() const {
  const Bounds bounds = boundsOf(parts_.vertices, parts_.triangles);
  const Vec3f center = middleAsFloat(bounds);
  if (parts_.boundsMin != bounds.min || parts_.boundsMax != bounds.max || parts_.center != center) return false;
  // Where the middle is not a number as near to the origin as that of any mesh, boxes and filters would not do.
  if (!parts_.triangles.empty() && parts_.origin != originAfterMove(bounds, parts_.origin)) return false;
  double radius2 = 0;
  for (const Triangle& triangle : parts_.triangles) {
    for (const std::uint32_t v : triangle.v) radius2 = std::max(radius2, distance2(parts_.vertices[v], center));
  }
  if (parts_.radius != radiusFrom(radius2)) return false;
  for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
    const bool flat = isDegenerateTriangle({parts_.vertices.data(), parts_.vertices.size()}, parts_.triangles[t]);
    if (parts_.degenerate[t] != static_cast<std::uint8_t>(flat)) return false;
  }
  return true;
}

/// As reports say it, from volumes that are worked out here.
bool TriMeshCheck::facesOutward(Topology topology) const {
  const auto closed = std::count(topology.componentClosed.begin(), topology.componentClosed.end(), 1);
  if (closed == 0) return false;
  topology.componentVolume = componentVolumes(topology, parts_.vertices, parts_.triangles, parts_.origin);
  if (closed == 1 && topology.componentCount() == 1) {  // far from where componentsWellWound() would hesitate
    const double r = parts_.radius;
    if (topology.componentVolume[0] > 1e-9 * r * r * r * static_cast<double>(parts_.triangles.size())) return true;
  }
  const auto well = componentsWellWound(topology, nestingDepths(topology, parts_.vertices, parts_.triangles),
                                        parts_.vertices, parts_.triangles);
  return closed == std::count(well.begin(), well.end(), 1);
}

bool TriMeshCheck::isSolid(const Topology& topology, const TopologyFindings& found) const {
  return topology.edgeCount() > 0 && found.boundaryEdges + found.nonManifoldEdges + found.inconsistentEdges == 0 &&
         facesOutward(topology);
}

bool TriMeshCheck::reportMatches(const Topology& topology, const TopologyFindings& found, bool solid) const {
  const ValidationReport& report = parts_.report;
  const bool closed = topology.edgeCount() > 0 && found.boundaryEdges == 0 && found.nonManifoldEdges == 0;
  if (!report.accepted || report.triangles != parts_.triangles.size() || report.edges != topology.edgeCount() ||
      report.components != topology.componentCount() || report.boundaryEdges != found.boundaryEdges ||
      report.nonManifoldEdges != found.nonManifoldEdges || report.inconsistentEdges != found.inconsistentEdges ||
      report.closed != closed || report.oriented != (found.inconsistentEdges == 0) ||
      report.outward != facesOutward(topology) || report.solid != solid) {
    return false;
  }
  // Named in sentences for people, and by the caller's numbers.
  const std::size_t limit = std::max(parts_.inputVertexCount, std::max(parts_.vertices.size(), report.triangles));
  for (const Problem& problem : report.problems) {
    for (const std::uint32_t element : problem.elements) {
      if (element >= limit) return false;
    }
  }
  return true;
}

std::string TriMeshCheck::fault() const {
  if (std::string fault = faultOfNumbers(); !fault.empty()) return fault;
  const TopologyFindings found = checkTopology(parts_.topology, parts_.vertices, parts_.triangles);
  if (!found.fault.empty()) return found.fault;
  if (!measuresMatch()) return "bounds or areas that do not match";
  // Of surfaces that touch along edges, and were taken apart, reports tell as they were given.
  const bool touches = parts_.report.solid && parts_.report.nonManifoldEdges > 0;
  const Topology given = touches ? buildTopology(parts_.vertices, parts_.triangles) : parts_.topology;
  const TopologyFindings ofGiven = touches ? checkTopology(given, parts_.vertices, parts_.triangles) : found;
  return reportMatches(given, ofGiven, isSolid(parts_.topology, found)) ? "" : "a report that does not match";
}

}  // namespace otg
