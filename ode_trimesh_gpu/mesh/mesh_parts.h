// SPDX-License-Identifier: BSD-3-Clause
// A TriMesh taken apart, for what stores and restores one.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "mesh/topology_check.h"
#include "mesh/tri_mesh.h"

namespace otg {

/// All that a TriMesh is made of: see there.
struct TriMeshParts {
  Array<Vec3f> vertices;
  SharedArray<Triangle> triangles;
  SharedArray<std::uint8_t> degenerate;
  Topology topology;
  ValidationReport report;
  MassProperties mass;
  Vec3f boundsMin{}, boundsMax{}, center{}, origin{};
  float radius = 0;
  std::size_t inputVertexCount = 0;
  SharedArray<std::uint32_t> inputVertexOf, callerTriangle, triangleOfCaller;

  /// Copies what no other mesh shares.
  static TriMeshParts of(const TriMesh& mesh);
  /// Of parts without fault (TriMeshCheck).
  static std::shared_ptr<const TriMesh> assemble(TriMeshParts&& parts);
};

/// Finds out what is wrong with parts that come from elsewhere. Numbers point into their arrays, sizes match, vertices
/// are finite. The topology is that of the triangles (topology_check.h). Bounds, centre, radius, and the triangles
/// without area are those of the vertices. The report has the right counts of edges, and calls a mesh closed, oriented,
/// outward and solid where it is. A mesh made of parts without fault can be worked with as one that was built. Not
/// checked: numbers that are only read out, such as the mass, other than that they are finite.
///
/// Arrays are looked at piece by piece, as they come in: each function is called for elements `begin` to `end` of the
/// array of its name, in order and without gaps. The arrays come in the order of these functions. Whatever the elements
/// are, nothing outside the arrays is read.
class TriMeshCheck {
 public:
  /// The arrays of the parts have their sizes, but no elements yet. They stay where they are.
  explicit TriMeshCheck(const TriMeshParts& parts);
  /// False where the sizes do not match; the other functions must not be called then.
  bool sizesMatch() const { return sizesMatch_; }

  void vertices(std::size_t begin, std::size_t end);
  void triangles(std::size_t begin, std::size_t end);
  void weld(std::size_t begin, std::size_t end);
  void edgeOf(std::size_t begin, std::size_t end);
  void twin(std::size_t begin, std::size_t end);
  void edges(std::size_t begin, std::size_t end);
  void componentOf(std::size_t begin, std::size_t end);
  void inputVertexOf(std::size_t begin, std::size_t end);
  void callerTriangle(std::size_t begin, std::size_t end);
  void triangleOfCaller(std::size_t begin, std::size_t end);

  /// After all of them, and with the numbers of the parts filled in: in words, empty where nothing is wrong. May throw
  /// std::bad_alloc.
  std::string fault() const;

 private:
  std::string faultOfNumbers() const;
  bool measuresMatch() const;
  bool facesOutward(Topology topology) const;
  bool isSolid(const Topology& topology, const TopologyFindings& found) const;
  /// `topology`: what the report is about.
  bool reportMatches(const Topology& topology, const TopologyFindings& found, bool solid) const;
  const TriMeshParts& parts_;
  bool sizesMatch_ = false;
  bool finite_ = true, inRange_ = true, pointsMatch_ = true, numbersMatch_ = true;
  std::size_t haveTwin_ = 0, twinPairs_ = 0;
};

}  // namespace otg
