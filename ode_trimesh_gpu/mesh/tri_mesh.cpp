// SPDX-License-Identifier: BSD-3-Clause
// From the caller's arrays to an immutable mesh: reading, refusing, repairing, measuring.
#include "mesh/tri_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/bounds.h"
#include "mesh/adjacency_links.h"
#include "mesh/containment.h"
#include "mesh/copies.h"
#include "mesh/inspection.h"
#include "mesh/local_order.h"
#include "mesh/measure.h"
#include "mesh/own_topology.h"
#include "mesh/repair.h"
#include "mesh/report_mesh.h"
#include "mesh/touching_edges.h"

namespace otg {
namespace {

/// Vertices as floats; infinity stands for whatever is not finite or beyond float.
template <class Scalar>
std::vector<Vec3f> readVertices(const MeshInput& input) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const std::size_t stride = input.vertexStride != 0 ? input.vertexStride : 3 * sizeof(Scalar);
  const unsigned char* from = static_cast<const unsigned char*>(input.vertices);
  std::vector<Vec3f> vertices(input.vertexCount);
  for (std::size_t i = 0; i < input.vertexCount; ++i) {
    Scalar c[3];
    std::memcpy(c, from + i * stride, sizeof(c));  // strides need not keep the alignment
    float f[3];
    for (int k = 0; k < 3; ++k)
      f[k] = std::abs(double{c[k]}) <= kLargest ? static_cast<float>(c[k]) : std::numeric_limits<float>::infinity();
    vertices[i] = {f[0], f[1], f[2]};
  }
  return vertices;
}

std::vector<Triangle> readTriangles(const MeshInput& input) {
  const std::size_t stride = input.triangleStride != 0 ? input.triangleStride : sizeof(Triangle);
  const unsigned char* from = static_cast<const unsigned char*>(input.indices);
  std::vector<Triangle> triangles(input.triangleCount);
  for (std::size_t i = 0; i < input.triangleCount; ++i) std::memcpy(&triangles[i], from + i * stride, sizeof(Triangle));
  return triangles;
}

/// What can be said without touching the vertex array.
void checkVertexArray(const MeshInput& input, ValidationReport& report) {
  if (input.vertexCount > kMaxVertices)
    addProblem(report, ProblemKind::kTooManyVertices, 1,
               std::to_string(input.vertexCount) + " vertices are more than the limit of " +
                   std::to_string(kMaxVertices) + ".");
  if (input.vertices == nullptr && input.vertexCount > 0)
    addProblem(report, ProblemKind::kNullArray, 1,
               "The vertex array is null, but " + std::to_string(input.vertexCount) + " vertices are announced.");
  const std::size_t size = 3 * (input.scalar == MeshInput::Scalar::kDouble ? sizeof(double) : sizeof(float));
  if (input.vertexStride != 0 && input.vertexStride < size)
    addProblem(report, ProblemKind::kBadStride, 1,
               "The vertex stride of " + std::to_string(input.vertexStride) + " bytes is smaller than a vertex of " +
                   std::to_string(size) + " bytes.");
}

void checkTriangleArray(const MeshInput& input, ValidationReport& report) {
  if (input.triangleCount > kMaxTriangles)
    addProblem(report, ProblemKind::kTooManyTriangles, 1,
               std::to_string(input.triangleCount) + " triangles are more than the limit of " +
                   std::to_string(kMaxTriangles) + ".");
  if (input.indices == nullptr && input.triangleCount > 0)
    addProblem(report, ProblemKind::kNullArray, 1,
               "The index array is null, but " + std::to_string(input.triangleCount) + " triangles are announced.");
  if (input.triangleStride != 0 && input.triangleStride < sizeof(Triangle))
    addProblem(report, ProblemKind::kBadStride, 1,
               "The triangle stride of " + std::to_string(input.triangleStride) + " bytes is smaller than the " +
                   std::to_string(sizeof(Triangle)) + " bytes of three indices.");
}

std::vector<Vec3f> readCheckedVertices(const MeshInput& input, ValidationReport& report) {
  std::vector<Vec3f> vertices =
      input.scalar == MeshInput::Scalar::kDouble ? readVertices<double>(input) : readVertices<float>(input);
  const auto isBad = [&](std::uint32_t v) {
    const Vec3f& p = vertices[v];
    return !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  };
  for (std::uint32_t v = 0; v < vertices.size(); ++v) report.nonfiniteVertices += isBad(v);
  addProblem(report, ProblemKind::kNonFiniteVertex, report.nonfiniteVertices,
             std::to_string(report.nonfiniteVertices) +
                 (report.nonfiniteVertices == 1 ? " vertex has" : " vertices have") +
                 " a coordinate that is not a finite float (NaN, infinite or too large).",
             vertices.size(), isBad);
  return vertices;
}

std::vector<Triangle> readCheckedTriangles(const MeshInput& input, ValidationReport& report) {
  std::vector<Triangle> triangles = readTriangles(input);
  const auto isBad = [&](std::uint32_t t) {
    const std::uint32_t(&v)[3] = triangles[t].v;
    return v[0] >= input.vertexCount || v[1] >= input.vertexCount || v[2] >= input.vertexCount;
  };
  std::size_t bad = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) bad += isBad(t);
  addProblem(report, ProblemKind::kIndexOutOfRange, bad,
             std::to_string(bad) + (bad == 1 ? " triangle has" : " triangles have") +
                 " an index out of range (there are " + std::to_string(input.vertexCount) + " vertices).",
             triangles.size(), isBad);
  return triangles;
}

/// The refusal if there are problems so far.
bool refused(ValidationReport& report) {
  for (const Problem& problem : report.problems) {
    if (!report.error.empty()) report.error += ' ';
    report.error += problem.message;
  }
  return !report.problems.empty();
}

}  // namespace

/// Fills a TriMesh, whose members only it can reach.
struct TriMeshBuilder {
  static std::shared_ptr<TriMesh> create() {
    std::shared_ptr<TriMesh> mesh(new TriMesh);
    mesh->links_ = std::make_shared<FirstUse<AdjacencyLinks>>();
    mesh->firstCopies_ = std::make_shared<FirstUse<std::vector<std::uint32_t>>>();
    mesh->trianglesHash_ = std::make_shared<FirstUse<std::uint64_t>>();
    return mesh;
  }

  /// `before`: the origin that the mesh had, if it had one.
  static void measure(TriMesh& mesh, const Vec3f* before) {
    const Bounds bounds = boundsOf(mesh.vertices_, mesh.triangles_);
    mesh.boundsMin_ = bounds.min;
    mesh.boundsMax_ = bounds.max;
    mesh.center_ = middleAsFloat(bounds);
    mesh.origin_ = before == nullptr ? mesh.center_ : originAfterMove(bounds, *before);
    double radius2 = 0;
    for (const Triangle& triangle : mesh.triangles_) {
      for (const std::uint32_t v : triangle.v) radius2 = std::max(radius2, distance2(mesh.vertices_[v], mesh.center_));
    }
    mesh.radius_ = radiusFrom(radius2);
    mesh.degenerate_ = findDegenerate(mesh.vertices_, mesh.triangles_);
  }

  /// By the mesh's own indices if they make a solid. Else by positions, unless these make none, but surfaces that touch
  /// along edges do once they are taken apart. That may give vertices of the mesh copies.
  static void chooseTopology(TriMesh& mesh, std::optional<Topology>&& own, std::vector<std::uint32_t>&& weld,
                             ValidationReport& report) {
    if (own) {
      const ValidationReport before = report;
      inspectMesh(mesh.vertices_, mesh.triangles_, *own, mesh.degenerate_, report);
      if (report.solid) {
        mesh.topology_ = std::move(*own);
        return;
      }
      report = before;
    }
    mesh.topology_ = buildTopology(mesh.vertices_, mesh.triangles_, std::move(weld));
    inspectMesh(mesh.vertices_, mesh.triangles_, mesh.topology_, mesh.degenerate_, report);
    if (report.mayTouchAlongEdges() && takeApart(mesh)) report.solid = true;
  }

  static void chooseTopology(TriMesh& mesh, ValidationReport& report) {
    std::vector<std::uint32_t> weld = weldByPosition(mesh.vertices_);
    std::optional<Topology> own = ownTopology(mesh.vertices_, mesh.triangles_, weld);
    chooseTopology(mesh, std::move(own), std::move(weld), report);
  }

  /// False, and nothing has changed, if that makes no solid.
  static bool takeApart(TriMesh& mesh) {
    std::optional<SeparateSurfaces> apart = separateSurfaces(mesh.vertices_, mesh.triangles_, mesh.topology_);
    if (!apart) return false;
    const bool hasCopies = apart->vertexOf.size() > mesh.vertices_.size();
    std::vector<Vec3f> vertices;
    std::vector<std::uint32_t> inputVertexOf;
    for (const std::uint32_t v : apart->vertexOf) {
      vertices.push_back(mesh.vertices_[v]);
      inputVertexOf.push_back(mesh.callerVertex(v));
    }
    Topology topology = buildTopology(vertices, apart->triangles, std::move(apart->weld), std::move(apart->twin));
    ValidationReport ofSurfaces;
    inspectMesh(vertices, apart->triangles, topology, mesh.degenerate_, ofSurfaces);
    if (!ofSurfaces.solid) return false;
    mesh.topology_ = std::move(topology);
    if (!hasCopies) return true;
    orientEdges(mesh.topology_, inputVertexOf);
    mesh.vertices_ = std::move(vertices);
    mesh.triangles_ = std::move(apart->triangles);
    mesh.inputVertexOf_ = std::move(inputVertexOf);
    return true;
  }

  static MeshResult build(const MeshInput& input, const RepairOptions& repair, MeshOrder order) {
    MeshResult result;
    ValidationReport& report = result.report;
    report.vertices = input.vertexCount;
    report.triangles = input.triangleCount;
    checkVertexArray(input, report);
    checkTriangleArray(input, report);
    if (refused(report)) return result;
    std::vector<Vec3f> vertices = readCheckedVertices(input, report);
    std::vector<Triangle> triangles = readCheckedTriangles(input, report);
    if (refused(report)) return result;

    const std::shared_ptr<TriMesh> mesh = create();
    mesh->inputVertexCount_ = vertices.size();
    std::vector<std::uint32_t> inputVertexOf;
    repairMesh(repair, vertices, triangles, inputVertexOf, report.repair);
    mesh->inputVertexOf_ = std::move(inputVertexOf);
    mesh->vertices_ = std::move(vertices);
    mesh->triangles_ = std::move(triangles);
    measure(*mesh, nullptr);
    chooseTopology(*mesh, report);
    mesh->report_ = report;
    const bool isLarge = mesh->triangles_.size() > kMostUnsorted;
    if (order == MeshOrder::kLocal || (order == MeshOrder::kBySize && isLarge)) sortForLocality(*mesh);
    result.mesh = mesh;
    return result;
  }

  static void sortForLocality(TriMesh& mesh) {
    LocalOrder order = findLocalOrder(mesh.topology_, mesh.triangles_);
    const std::vector<std::uint32_t> newVertex = inverseOf(order.vertices);
    std::vector<Vec3f> vertices(order.vertices.size());
    std::vector<std::uint32_t> inputVertexOf(order.vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      vertices[v] = mesh.vertices_[order.vertices[v]];
      inputVertexOf[v] = mesh.callerVertex(order.vertices[v]);
    }
    std::vector<Triangle> triangles(order.triangles.size());
    std::vector<std::uint8_t> degenerate(order.triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const Triangle& from = mesh.triangles_[order.triangles[t]];
      triangles[t] = {{newVertex[from.v[0]], newVertex[from.v[1]], newVertex[from.v[2]]}};
      degenerate[t] = mesh.degenerate_[order.triangles[t]];
    }
    mesh.topology_ = renumber(mesh.topology_, order);
    mesh.vertices_ = std::move(vertices);
    mesh.triangles_ = std::move(triangles);
    mesh.degenerate_ = std::move(degenerate);
    mesh.inputVertexOf_ = std::move(inputVertexOf);
    mesh.triangleOfCaller_ = inverseOf(order.triangles);
    mesh.callerTriangle_ = std::move(order.triangles);
  }

  /// The numbers that components have when triangles come in the caller's order.
  static std::vector<std::uint32_t> callerComponents(const TriMesh& mesh) {
    std::vector<std::uint32_t> number(mesh.topology_.componentCount(), kNone);
    std::uint32_t count = 0;
    for (const std::uint32_t t : mesh.triangleOfCaller_) {
      const std::uint32_t c = mesh.topology_.componentOf[t];
      if (c != kNone && number[c] == kNone) number[c] = count++;
    }
    return number;
  }

  /// The elements that a report names, in the caller's numbers.
  static void nameAsCaller(const TriMesh& mesh, ValidationReport& report) {
    for (Problem& problem : report.problems) {
      for (std::uint32_t& element : problem.elements) {
        switch (problem.kind) {
          case ProblemKind::kNonManifoldVertex:
          case ProblemKind::kUnusedVertex:
            element = mesh.callerVertex(element);
            break;
          case ProblemKind::kInwardWinding:
            element = callerComponents(mesh)[element];
            break;
          default:
            element = mesh.callerTriangle(element);
            break;
        }
      }
      std::sort(problem.elements.begin(), problem.elements.end());
    }
  }

  /// componentsWellWound().
  static std::vector<std::uint8_t> wellWound(const TriMesh& mesh) {
    return componentsWellWound(mesh.topology_, nestingDepths(mesh.topology_, mesh.vertices_, mesh.triangles_),
                               mesh.vertices_, mesh.triangles_);
  }

  /// As a build has it before it takes surfaces apart and sorts: each of the caller's vertices once, and all in order.
  static void inCallersOrder(TriMesh& mesh) {
    std::vector<std::uint32_t> numberOf(mesh.inputVertexCount_, kNone), inputVertexOf;
    for (std::uint32_t v = 0; v < mesh.vertices_.size(); ++v) numberOf[mesh.callerVertex(v)] = v;
    std::vector<Vec3f> vertices;
    for (std::uint32_t v = 0; v < numberOf.size(); ++v) {
      if (numberOf[v] == kNone) continue;
      vertices.push_back(mesh.vertices_[numberOf[v]]);
      numberOf[v] = static_cast<std::uint32_t>(inputVertexOf.size());
      inputVertexOf.push_back(v);
    }
    std::vector<Triangle> triangles(mesh.triangles_.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      triangles[t] = mesh.triangles_[mesh.triangleOfCaller(t)];
      for (std::uint32_t& v : triangles[t].v) v = numberOf[mesh.callerVertex(v)];
    }
    mesh.vertices_ = std::move(vertices);
    mesh.inputVertexOf_ = std::move(inputVertexOf);
    mesh.triangles_ = std::move(triangles);
    mesh.callerTriangle_ = {};
    mesh.triangleOfCaller_ = {};
  }

  static MeshResult move(const TriMesh& before, const MeshInput& input, bool turned) {
    MeshResult result;
    ValidationReport& report = result.report;
    report.vertices = input.vertexCount;
    report.triangles = before.triangleCount();
    checkVertexArray(input, report);
    if (input.vertexCount != before.inputVertexCount_)
      addProblem(report, ProblemKind::kVertexCountMismatch, 1,
                 std::to_string(input.vertexCount) + " vertices are given for a mesh that was built from " +
                     std::to_string(before.inputVertexCount_) + ".");
    if (refused(report)) return result;
    std::vector<Vec3f> vertices = readCheckedVertices(input, report);
    if (refused(report)) return result;

    const std::shared_ptr<TriMesh> mesh = create();
    mesh->inputVertexCount_ = before.inputVertexCount_;
    mesh->inputVertexOf_ = before.inputVertexOf_;
    mesh->callerTriangle_ = before.callerTriangle_;
    mesh->triangleOfCaller_ = before.triangleOfCaller_;
    if (!before.inputVertexOf_.empty()) {
      std::vector<Vec3f> own(before.inputVertexOf_.size());
      for (std::size_t v = 0; v < own.size(); ++v) own[v] = vertices[before.inputVertexOf_[v]];
      vertices = std::move(own);
    }
    mesh->vertices_ = std::move(vertices);
    mesh->triangles_ = before.triangles_;
    if (turned) {
      std::vector<Triangle> triangles(before.triangles_.begin(), before.triangles_.end());
      for (Triangle& t : triangles) std::swap(t.v[1], t.v[2]);
      mesh->triangles_ = std::move(triangles);
    } else {
      mesh->trianglesHash_ = before.trianglesHash_;
    }
    const bool isSorted = !before.callerTriangle_.empty();
    bool keepsNumbers = !before.report_.mayTouchAlongEdges();
    if (!keepsNumbers) inCallersOrder(*mesh);
    measure(*mesh, &before.origin_);
    std::vector<std::uint32_t> weld = weldByPosition(mesh->vertices_);
    std::optional<Topology> own = ownTopology(mesh->vertices_, mesh->triangles_, weld);
    const bool samePoints = !own && keepsNumbers && std::ranges::equal(weld, before.topology_.weld);
    report.repair = before.report_.repair;
    if (samePoints) {
      mesh->topology_ = turned ? turnedTopology(before.topology_) : before.topology_;
      if (!turned) mesh->links_ = before.links_;
      if (!turned) mesh->firstCopies_ = before.firstCopies_;
    } else {
      const ValidationReport blank = report;
      chooseTopology(*mesh, std::move(own), std::move(weld), report);
      if (keepsNumbers && isSorted && !std::ranges::equal(mesh->topology_.twin, before.topology_.twin)) {
        keepsNumbers = false;
        report = blank;
        inCallersOrder(*mesh);
        measure(*mesh, &before.origin_);
        chooseTopology(*mesh, report);
      }
      if (!mesh->inputVertexOf_.empty()) orientEdges(mesh->topology_, mesh->inputVertexOf_);
      if (!keepsNumbers && isSorted) sortForLocality(*mesh);
    }
    mesh->topology_.componentVolume =
        componentVolumes(mesh->topology_, mesh->vertices_, mesh->triangles_, mesh->origin_);
    const bool sameAreas = std::ranges::equal(mesh->degenerate_, before.degenerate_);
    if (sameAreas) mesh->degenerate_ = before.degenerate_;
    if (samePoints && sameAreas && wellWound(*mesh) == wellWound(before)) {
      report = before.report_;
    } else {
      if (samePoints) inspectMesh(mesh->vertices_, mesh->triangles_, mesh->topology_, mesh->degenerate_, report);
      if (keepsNumbers && isSorted) nameAsCaller(*mesh, report);
    }
    mesh->report_ = report;
    result.mesh = mesh;
    return result;
  }
};

MeshResult buildTriMesh(const MeshInput& input, const RepairOptions& repair, MeshOrder order) {
  return TriMeshBuilder::build(input, repair, order);
}

std::vector<Vec3f> verticesOfCaller(const TriMesh& mesh) {
  std::vector<Vec3f> vertices(mesh.inputVertexCount());
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) vertices[mesh.callerVertex(v)] = mesh.vertices()[v];
  return vertices;
}

std::vector<Vec3f> readSomeVertices(const TriMesh& mesh, const MeshInput& input, ValidationReport& report) {
  report.vertices = mesh.inputVertexCount();
  report.triangles = mesh.triangleCount();
  checkVertexArray(input, report);
  if (refused(report)) return {};
  std::vector<Vec3f> vertices = readCheckedVertices(input, report);
  return refused(report) ? std::vector<Vec3f>() : vertices;
}

const AdjacencyLinks& TriMesh::adjacencyLinks() const {
  return links_->get([this] { return buildAdjacencyLinks(triangles_, topology_); });
}

std::span<const std::uint32_t> TriMesh::firstCopies() const {
  if (report_.duplicateTriangles == 0) return {};
  return firstCopies_->get([this] {
    return findFirstCopies(triangles_, {topology_.weld.data(), topology_.weld.size()});
  });
}

bool TriMesh::isNumberedAs(const TriMesh& other) const {
  return callerTriangle_.begin() == other.callerTriangle_.begin() ||
         std::ranges::equal(callerTriangle_, other.callerTriangle_);
}

const MassProperties& TriMesh::massProperties() const {
  return mass_.get([this] { return computeMassProperties(vertices_, triangles_); });
}

MeshResult moveVertices(const TriMesh& mesh, const MeshInput& vertices, bool turned) {
  return TriMeshBuilder::move(mesh, vertices, turned);
}

std::uint64_t TriMesh::hashOfVertices() const {
  std::uint64_t sum = 0;
  for (std::uint32_t v = 0; v < vertices().size(); ++v) sum += vertexHash(callerVertex(v), vertices()[v]);
  return sum;
}

std::uint64_t TriMesh::hashOfTriangles() const {
  std::uint64_t sum = 0;
  for (std::uint32_t t = 0; t < triangleCount(); ++t) {
    std::uint64_t hash = ~std::uint64_t{callerTriangle(t)};
    for (const std::uint32_t v : triangles()[t].v) hash = spreadBits(spreadBits(hash) ^ callerVertex(v));
    sum += hash;
  }
  return sum;
}

}  // namespace otg
