// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/cooked_mesh.h"

#include <algorithm>
#include <cstddef>

#include "bvh/cooked_bytes.h"
#include "bvh/tree_check.h"
#include "mesh/mesh_parts.h"

namespace otg {
namespace {

class MemorySource : public ByteSource {
 public:
  explicit MemorySource(std::span<const unsigned char> bytes) : left_(bytes) {}
  std::size_t read(unsigned char* to, std::size_t size) override {
    const std::size_t part = std::min(size, left_.size());
    std::copy_n(left_.begin(), part, to);
    left_ = left_.subspan(part);
    return part;
  }

 private:
  std::span<const unsigned char> left_;
};

class FileSource : public ByteSource {
 public:
  explicit FileSource(std::FILE* file) : file_(file) {
    std::setvbuf(file, nullptr, _IONBF, 0);  // straight to where it is wanted
  }
  std::size_t read(unsigned char* to, std::size_t size) override { return std::fread(to, 1, size, file_); }

 private:
  std::FILE* file_;
};

/// Numbers that are in no array, in arrays of their own.
struct Numbers {
  Array<std::uint64_t> counts;
  Array<double> reals;
};

/// The members of a report that are numbers, in their order.
std::vector<std::size_t*> countsOf(ValidationReport& r) {
  return {&r.vertices,
          &r.triangles,
          &r.edges,
          &r.components,
          &r.degenerateTriangles,
          &r.duplicateTriangles,
          &r.nonfiniteVertices,
          &r.boundaryEdges,
          &r.nonManifoldEdges,
          &r.nonManifoldVertices,
          &r.inconsistentEdges,
          &r.repair.weldedVertices,
          &r.repair.splitDegenerate,
          &r.repair.droppedDegenerate,
          &r.repair.droppedDuplicates,
          &r.repair.flippedTriangles};
}
std::vector<bool*> factsOf(ValidationReport& r) {
  return {&r.accepted, &r.closed, &r.manifold, &r.oriented, &r.outward, &r.solid};
}

/// One string for several: each with a zero after it, which none of our sentences has in it.
Array<char> joined(const std::vector<std::string>& texts) {
  std::vector<char> all;
  for (const std::string& text : texts) {
    all.insert(all.end(), text.begin(), text.end());
    all.push_back('\0');
  }
  return all;
}
std::vector<std::string> split(const Array<char>& section) {
  const std::string all(section.begin(), section.end());
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find('\0', at), all.size());
    texts.push_back(all.substr(at, end - at));
    at = end + 1;
  }
  return texts;
}

void packNumbers(TriMeshParts& p, const BinaryTree& tree, Numbers& n) {
  std::vector<std::uint64_t> counts;
  for (const std::size_t* count : countsOf(p.report)) counts.push_back(*count);
  for (const bool* fact : factsOf(p.report)) counts.push_back(*fact ? 1 : 0);
  counts.insert(counts.end(), {p.inputVertexCount, tree.depth, static_cast<std::uint64_t>(tree.strategy)});
  n.counts = std::move(counts);
  std::vector<double> reals = {p.mass.volume, p.mass.area, p.radius};
  for (const Vec3f* v : {&p.boundsMin, &p.boundsMax, &p.center, &p.origin})
    reals.insert(reals.end(), {v->x, v->y, v->z});
  for (int i = 0; i < 3; ++i) reals.push_back(p.mass.centerOfMass[i]);
  for (int i = 0; i < 9; ++i) reals.push_back(p.mass.inertia(i / 3, i % 3));
  n.reals = std::move(reals);
}

bool unpackNumbers(const Numbers& n, TriMeshParts& p, BinaryTree& tree) {
  const auto counts = countsOf(p.report);
  const auto facts = factsOf(p.report);
  if (n.counts.size() != counts.size() + facts.size() + 3 || n.reals.size() != 27) return false;
  const std::uint64_t* next = n.counts.begin();
  for (std::size_t* count : counts) *count = static_cast<std::size_t>(*next++);
  for (bool* fact : facts) *fact = *next++ != 0;
  p.inputVertexCount = static_cast<std::size_t>(*next++);
  tree.depth = static_cast<std::uint32_t>(std::min<std::uint64_t>(*next++, kNone));
  if (*next > static_cast<std::uint64_t>(BuildStrategy::kSah)) return false;
  tree.strategy = static_cast<BuildStrategy>(*next);
  const double* real = n.reals.data();
  p.mass.volume = *real++;
  p.mass.area = *real++;
  p.radius = static_cast<float>(*real++);
  for (Vec3f* v : {&p.boundsMin, &p.boundsMax, &p.center, &p.origin}) {
    for (float* x : {&v->x, &v->y, &v->z}) *x = static_cast<float>(*real++);
  }
  for (int i = 0; i < 3; ++i) p.mass.centerOfMass[i] = *real++;
  for (int i = 0; i < 9; ++i) p.mass.inertia(i / 3, i % 3) = *real++;
  return true;
}

/// Problems as numbers and sentences.
void packProblems(const ValidationReport& report, Array<std::uint64_t>& packed, Array<char>& texts) {
  std::vector<std::uint64_t> numbers;
  std::vector<std::string> messages;
  for (const Problem& problem : report.problems) {
    numbers.insert(numbers.end(), {static_cast<std::uint64_t>(problem.kind), problem.count, problem.elements.size()});
    numbers.insert(numbers.end(), problem.elements.begin(), problem.elements.end());
    messages.push_back(problem.message);
  }
  packed = std::move(numbers);
  texts = joined(messages);
}

bool unpackProblems(const Array<std::uint64_t>& numbers, const Array<char>& texts, ValidationReport& report) {
  const std::vector<std::string> messages = split(texts);
  for (std::size_t at = 0; at < numbers.size();) {
    if (numbers.size() - at < 3 || numbers[at] > static_cast<std::uint64_t>(ProblemKind::kUnusedVertex) ||
        numbers[at + 2] > Problem::kMaxElements || numbers[at + 2] > numbers.size() - at - 3 ||
        report.problems.size() >= messages.size()) {
      return false;
    }
    Problem problem;
    problem.kind = static_cast<ProblemKind>(numbers[at]);
    problem.count = static_cast<std::size_t>(numbers[at + 1]);
    const std::size_t elements = static_cast<std::size_t>(numbers[at + 2]);
    for (std::size_t k = 0; k < elements; ++k) {
      problem.elements.push_back(static_cast<std::uint32_t>(numbers[at + 3 + k]));
    }
    problem.message = messages[report.problems.size()];
    report.problems.push_back(std::move(problem));
    at += 3 + elements;
  }
  return report.problems.size() == messages.size();
}

/// All that is in the sections.
struct Parts {
  Numbers numbers;
  TriMeshParts mesh;
  BinaryTree tree;
  Array<std::uint64_t> problems;
  Array<char> texts[3];  ///< of the problems, of the repair, and the report's error
};

enum class Part : std::size_t {
  kCounts,
  kReals,
  kVertices,
  kTriangles,
  kDegenerate,
  kWeld,
  kEdgeOf,
  kTwin,
  kEdges,
  kComponentOf,
  kComponentClosed,
  kComponentVolume,
  kInputVertexOf,
  kCallerTriangle,
  kTriangleOfCaller,
  kNodes,
  kProblems,
  kProblemTexts,
  kRepairTexts,
  kError,
  kParts
};

/// visit(part, array) for every section in its order.
template <class Visitor>
void visitParts(Parts& p, Visitor&& visit) {
  visit(Part::kCounts, p.numbers.counts);
  visit(Part::kReals, p.numbers.reals);
  visit(Part::kVertices, p.mesh.vertices);
  visit(Part::kTriangles, p.mesh.triangles);
  visit(Part::kDegenerate, p.mesh.degenerate);
  visit(Part::kWeld, p.mesh.topology.weld);
  visit(Part::kEdgeOf, p.mesh.topology.edgeOf);
  visit(Part::kTwin, p.mesh.topology.twin);
  visit(Part::kEdges, p.mesh.topology.edges);
  visit(Part::kComponentOf, p.mesh.topology.componentOf);
  visit(Part::kComponentClosed, p.mesh.topology.componentClosed);
  visit(Part::kComponentVolume, p.mesh.topology.componentVolume);
  visit(Part::kInputVertexOf, p.mesh.inputVertexOf);
  visit(Part::kCallerTriangle, p.mesh.callerTriangle);
  visit(Part::kTriangleOfCaller, p.mesh.triangleOfCaller);
  visit(Part::kNodes, p.tree.nodes);
  visit(Part::kProblems, p.problems);
  visit(Part::kProblemTexts, p.texts[0]);
  visit(Part::kRepairTexts, p.texts[1]);
  visit(Part::kError, p.texts[2]);
}

void look(TriMeshCheck& mesh, TreeCheck& tree, Part part, std::size_t begin, std::size_t end) {
  switch (part) {
    case Part::kVertices:
      return mesh.vertices(begin, end);
    case Part::kTriangles:
      return mesh.triangles(begin, end);
    case Part::kWeld:
      return mesh.weld(begin, end);
    case Part::kEdgeOf:
      return mesh.edgeOf(begin, end);
    case Part::kTwin:
      return mesh.twin(begin, end);
    case Part::kEdges:
      return mesh.edges(begin, end);
    case Part::kComponentOf:
      return mesh.componentOf(begin, end);
    case Part::kInputVertexOf:
      return mesh.inputVertexOf(begin, end);
    case Part::kCallerTriangle:
      return mesh.callerTriangle(begin, end);
    case Part::kTriangleOfCaller:
      return mesh.triangleOfCaller(begin, end);
    case Part::kNodes:
      return tree.nodes(begin, end);
    default:  // any number will do
      return;
  }
}

UncookedMesh refused(const std::string& why) {
  return {nullptr, why};
}

}  // namespace

std::vector<unsigned char> cookMesh(const CollisionMesh& mesh) {
  Parts p;
  p.mesh = TriMeshParts::of(mesh.mesh());
  p.tree = mesh.tree();
  // An image may have the boxes of another mesh, moved and scaled. What loads the bytes makes boxes of its own.
  if (mesh.boxScale() != nullptr) refitTree(p.tree, mesh.mesh());
  packNumbers(p.mesh, p.tree, p.numbers);
  packProblems(p.mesh.report, p.problems, p.texts[0]);
  p.texts[1] = joined(p.mesh.report.repair.messages);
  p.texts[2] = joined({p.mesh.report.error});
  CookedWriter writer;
  visitParts(p, [&](Part, const auto& array) { writer.add(array); });
  return writer.finish(kCookedVersion);
}

namespace {

UncookedMesh uncook(ByteSource& source, std::uint64_t size) {
  CookedReader reader;
  if (const std::string error = reader.open(source, size, kCookedVersion); !error.empty()) return refused(error);
  Parts p;
  bool good = reader.sections() == static_cast<std::size_t>(Part::kParts);
  if (good) {
    visitParts(p, [&](Part part, auto& array) { good &= reader.place(static_cast<std::size_t>(part), array); });
  }
  TriMeshCheck mesh(p.mesh);
  TreeCheck tree(p.tree.nodes, p.mesh.triangles.size());
  std::string fault = mesh.sizesMatch() ? std::string() : "arrays of sizes that do not match";
  if (good && fault.empty()) {
    visitParts(p, [&](Part part, const auto& array) {
      reader.read(static_cast<std::size_t>(part), array,
                  [&](std::size_t begin, std::size_t end) { look(mesh, tree, part, begin, end); });
      if (part == Part::kReals) good &= unpackNumbers(p.numbers, p.mesh, p.tree);
    });
  }
  // What was read means something if the sum is right.
  if (const std::string error = reader.finish(); !error.empty()) return refused(error);
  if (!good || !unpackProblems(p.problems, p.texts[0], p.mesh.report)) {
    return refused("The cooked mesh is not what its version says.");
  }
  if (fault.empty()) fault = mesh.fault();
  if (fault.empty()) fault = tree.fault(p.tree.depth);
  if (!fault.empty()) return refused("The cooked mesh has " + fault + ".");
  p.mesh.report.repair.messages = split(p.texts[1]);
  for (const std::string& text : split(p.texts[2])) p.mesh.report.error += text;
  const std::shared_ptr<const TriMesh> assembled = TriMeshParts::assemble(std::move(p.mesh));
  // Boxes are made again rather than believed: to look whether each holds what is below it takes as long.
  refitTree(p.tree, *assembled);
  return {std::make_shared<CollisionMesh>(assembled, std::move(p.tree)), {}};
}

}  // namespace

UncookedMesh uncookMesh(std::span<const unsigned char> bytes) {
  MemorySource source(bytes);
  return uncook(source, bytes.size());
}

UncookedMesh uncookFile(std::FILE* file, std::uint64_t size) {
  FileSource source(file);
  return uncook(source, size);
}

}  // namespace otg
