// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/cooked_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "mesh/mesh_parts.h"

namespace otg {
namespace {

constexpr char kMagic[8] = "OTGMESH";
constexpr std::size_t kHeader = 24, kFooter = 8;

std::uint64_t readWord(const unsigned char* at) {
  std::uint64_t word;
  std::memcpy(&word, at, sizeof(word));
  if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
  return word;
}

/// FNV-1a over words of 64 bits in four lanes, which a processor works on at once: a change of a single word changes
/// its lane for sure, others do but for one chance in 2^64. `size` is a multiple of 8.
std::uint64_t checksum(const unsigned char* bytes, std::size_t size) {
  constexpr std::uint64_t kPrime = 0x100000001b3u;
  std::uint64_t lane[4] = {0xcbf29ce484222325u, 1, 2, 3};
  std::size_t i = 0;
  for (; i + 32 <= size; i += 32) {
    for (std::size_t k = 0; k < 4; ++k) lane[k] = (lane[k] ^ readWord(bytes + i + 8 * k)) * kPrime;
  }
  for (; i < size; i += 8) lane[0] = (lane[0] ^ readWord(bytes + i)) * kPrime;
  std::uint64_t sum = size;
  for (const std::uint64_t l : lane) sum = (std::rotl(sum, 23) ^ l) * kPrime;
  return sum;
}

/// Structures that consist of numbers of `word` bytes each.
template <class T>
constexpr std::size_t wordOf() {
  if constexpr (sizeof(T) == 1) return 1;
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::uint64_t>) return 8;
  return 4;
}

void swapWords(unsigned char* bytes, std::size_t size, std::size_t word) {
  if constexpr (std::endian::native == std::endian::little) return;
  for (std::size_t i = 0; i + word <= size; i += word) std::reverse(bytes + i, bytes + i + word);
}

constexpr std::size_t padded(std::size_t size) {
  return (size + 7) & ~std::size_t{7};
}

class Writer {
 public:
  template <class T>
  void operator()(const std::vector<T>& array) {
    section(array.data(), array.size() * sizeof(T), wordOf<T>());
  }
  void operator()(const std::string& text) { section(text.data(), text.size(), 1); }
  void section(const void* from, std::size_t size, std::size_t word) {
    number(size);
    const std::size_t at = out_.size();
    out_.resize(at + padded(size), 0);
    if (size == 0) return;
    std::memcpy(out_.data() + at, from, size);
    swapWords(out_.data() + at, size, word);
  }
  void number(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) out_.push_back(static_cast<unsigned char>(value >> (8 * i)));
  }
  std::vector<unsigned char>& bytes() { return out_; }

 private:
  std::vector<unsigned char> out_;
};

/// Reads what is there; good() turns false for good at the first thing that is not as it must be.
class Reader {
 public:
  Reader(const unsigned char* bytes, std::size_t size) : at_(bytes), left_(size) {}
  bool good() const { return good_; }
  bool atEnd() const { return left_ == 0; }

  template <class T>
  void operator()(std::vector<T>& array) {
    const std::span<const unsigned char> from = section(sizeof(T));
    if constexpr (std::endian::native == std::endian::little && std::is_trivially_copyable_v<T>) {
      if (reinterpret_cast<std::uintptr_t>(from.data()) % alignof(T) == 0) {  // without zeroing it first
        const T* const begin = reinterpret_cast<const T*>(from.data());
        array.assign(begin, begin + from.size() / sizeof(T));
        return;
      }
    }
    array.resize(from.size() / sizeof(T));
    if (from.empty()) return;
    std::memcpy(static_cast<void*>(array.data()), from.data(), from.size());
    swapWords(reinterpret_cast<unsigned char*>(array.data()), from.size(), wordOf<T>());
  }
  void operator()(std::string& text) {
    const std::span<const unsigned char> from = section(1);
    text.assign(reinterpret_cast<const char*>(from.data()), from.size());
  }
  void fail() { good_ = false; }

 private:
  std::span<const unsigned char> section(std::size_t element) {
    if (!good_ || left_ < 8) {
      good_ = false;
      return {};
    }
    const std::uint64_t size = readWord(at_);
    at_ += 8;
    left_ -= 8;
    if (size > left_ || padded(static_cast<std::size_t>(size)) > left_ || size % element != 0) {
      good_ = false;
      return {};
    }
    const std::span<const unsigned char> found(at_, static_cast<std::size_t>(size));
    at_ += padded(found.size());
    left_ -= padded(found.size());
    return found;
  }

  const unsigned char* at_;
  std::size_t left_;
  bool good_ = true;
};

/// Numbers that are in no array, in arrays of their own.
struct Numbers {
  std::vector<std::uint64_t> counts;
  std::vector<double> reals;
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
std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all.append(text).push_back('\0');
  return all;
}
std::vector<std::string> split(const std::string& all) {
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find('\0', at), all.size());
    texts.push_back(all.substr(at, end - at));
    at = end + 1;
  }
  return texts;
}

void packNumbers(TriMeshParts& p, const BinaryTree& tree, Numbers& n) {
  for (const std::size_t* count : countsOf(p.report)) n.counts.push_back(*count);
  for (const bool* fact : factsOf(p.report)) n.counts.push_back(*fact ? 1 : 0);
  n.counts.insert(n.counts.end(), {p.inputVertexCount, tree.depth, static_cast<std::uint64_t>(tree.strategy)});
  n.reals = {p.mass.volume, p.mass.area, p.radius};
  for (const Vec3f* v : {&p.boundsMin, &p.boundsMax, &p.center, &p.origin}) n.reals.insert(n.reals.end(), {v->x, v->y, v->z});
  for (int i = 0; i < 3; ++i) n.reals.push_back(p.mass.centerOfMass[i]);
  for (int i = 0; i < 9; ++i) n.reals.push_back(p.mass.inertia(i / 3, i % 3));
}

bool unpackNumbers(const Numbers& n, TriMeshParts& p, BinaryTree& tree) {
  const auto counts = countsOf(p.report);
  const auto facts = factsOf(p.report);
  if (n.counts.size() != counts.size() + facts.size() + 3 || n.reals.size() != 27) return false;
  auto next = n.counts.begin();
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
void packProblems(const ValidationReport& report, std::vector<std::uint64_t>& numbers, std::string& texts) {
  std::vector<std::string> messages;
  for (const Problem& problem : report.problems) {
    numbers.insert(numbers.end(), {static_cast<std::uint64_t>(problem.kind), problem.count, problem.elements.size()});
    numbers.insert(numbers.end(), problem.elements.begin(), problem.elements.end());
    messages.push_back(problem.message);
  }
  texts = joined(messages);
}

bool unpackProblems(const std::vector<std::uint64_t>& numbers, const std::string& texts, ValidationReport& report) {
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

/// Every section in its order.
template <class Visitor, class Parts, class Nodes, class Strings>
void visitParts(Visitor& visit, Numbers& n, Parts& p, Nodes& nodes, std::vector<std::uint64_t>& problems,
                Strings& texts) {
  visit(n.counts);
  visit(n.reals);
  visit(p.vertices);
  visit(p.triangles);
  visit(p.degenerate);
  visit(p.topology.weld);
  visit(p.topology.edgeOf);
  visit(p.topology.twin);
  visit(p.topology.edges);
  visit(p.topology.componentOf);
  visit(p.topology.componentClosed);
  visit(p.topology.componentVolume);
  visit(p.inputVertexOf);
  visit(p.callerTriangle);
  visit(nodes);
  visit(problems);
  for (std::string& text : texts) visit(text);
}

/// What is wrong with a tree that was read; empty when queries can walk it: every node is reached once, parents and
/// children know each other, leaves name triangles of the mesh, each once, and it is no deeper than builds make it.
std::string treeFault(const BinaryTree& tree, std::size_t triangles) {
  if (tree.nodes.size() != (triangles == 0 ? 0 : 2 * triangles - 1)) return "a tree of another size";
  std::vector<std::uint8_t> depth(tree.nodes.size(), 0), seen(triangles, 0);
  std::uint32_t deepest = 0;
  float sum = 0;  // of zeros, or NaN
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const BvhNode& node = tree.nodes[i];
    if (i == 0) {
      if (node.parent != kNone) return "a tree without a root";
      depth[0] = 1;
    }
    if (depth[i] == 0) return "a node that nothing leads to";
    deepest = std::max<std::uint32_t>(deepest, depth[i]);
    for (const float x : {node.center.x, node.center.y, node.center.z, node.extent.x, node.extent.y, node.extent.z}) {
      sum += x * 0;
    }
    if (node.isLeaf()) {
      if (node.triangle() >= triangles || seen[node.triangle()] != 0) return "a leaf of no triangle";
      seen[node.triangle()] = 1;
      continue;
    }
    const auto child = static_cast<std::size_t>(node.child);
    if (child <= i || child + 1 >= tree.nodes.size() || depth[i] >= kMaxTreeDepth) return "a node of no children";
    for (const std::size_t c : {child, child + 1}) {
      if (depth[c] != 0 || tree.nodes[c].parent != i) return "a node of two parents";
      depth[c] = static_cast<std::uint8_t>(depth[i] + 1);
    }
  }
  if (deepest != tree.depth) return "a tree of another depth";
  return sum == 0 ? std::string() : "a box that is not finite";
}

UncookedMesh refused(const std::string& why) {
  return {nullptr, why};
}

}  // namespace

std::vector<unsigned char> cookMesh(const CollisionMesh& mesh) {
  TriMeshParts parts = TriMeshParts::of(mesh.mesh());
  Numbers numbers;
  packNumbers(parts, mesh.tree(), numbers);
  std::vector<std::uint64_t> problems;
  std::string texts[3] = {{}, joined(parts.report.repair.messages), parts.report.error};
  packProblems(parts.report, problems, texts[0]);
  Writer writer;
  writer.bytes().assign(kMagic, kMagic + 8);
  writer.number(kCookedVersion);
  writer.number(0);  // the length, when it is known
  visitParts(writer, numbers, parts, mesh.tree().nodes, problems, texts);
  std::vector<unsigned char>& bytes = writer.bytes();
  const std::uint64_t length = bytes.size() + kFooter;
  for (std::size_t i = 0; i < 8; ++i) bytes[16 + i] = static_cast<unsigned char>(length >> (8 * i));
  writer.number(checksum(bytes.data(), bytes.size()));
  return std::move(bytes);
}

UncookedMesh uncookMesh(std::span<const unsigned char> bytes) {
  if (bytes.size() < 8 || std::memcmp(bytes.data(), kMagic, 8) != 0) return refused("This is no cooked mesh.");
  if (bytes.size() < kHeader + kFooter) return refused("The cooked mesh is cut off.");
  const std::uint64_t version = readWord(bytes.data() + 8), length = readWord(bytes.data() + 16);
  if (version != kCookedVersion) {
    return refused("The cooked mesh is of version " + std::to_string(version) + "; this library reads version " +
                   std::to_string(kCookedVersion) + ".");
  }
  if (length > bytes.size()) return refused("The cooked mesh is cut off.");
  if (length != bytes.size() || length % 8 != 0) return refused("There is more than the cooked mesh.");
  const std::size_t end = bytes.size() - kFooter;
  if (checksum(bytes.data(), end) != readWord(bytes.data() + end)) return refused("The cooked mesh is damaged.");

  TriMeshParts parts;
  BinaryTree tree;
  Numbers numbers;
  std::vector<std::uint64_t> problems;
  std::string texts[3];
  Reader reader(bytes.data() + kHeader, end - kHeader);
  visitParts(reader, numbers, parts, tree.nodes, problems, texts);
  if (!reader.good() || !reader.atEnd() || !unpackNumbers(numbers, parts, tree) ||
      !unpackProblems(problems, texts[0], parts.report)) {
    return refused("The cooked mesh is not what its version says.");
  }
  parts.report.repair.messages = split(texts[1]);
  parts.report.error = texts[2];
  std::string fault = parts.fault();
  if (fault.empty()) fault = treeFault(tree, parts.triangles.size());
  if (!fault.empty()) return refused("The cooked mesh has " + fault + ".");
  return {std::make_shared<CollisionMesh>(TriMeshParts::assemble(std::move(parts)), std::move(tree)), {}};
}

}  // namespace otg
