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
/// its lane for sure, others do but for one chance in 2^64.
class Checksum {
 public:
  /// `size` is a multiple of 8, and of 32 for all parts but the last.
  void add(const unsigned char* bytes, std::size_t size) {
    std::uint64_t lane[4] = {lane_[0], lane_[1], lane_[2], lane_[3]};
    std::size_t i = 0;
    for (; i + 32 <= size; i += 32) {
      for (std::size_t k = 0; k < 4; ++k) lane[k] = (lane[k] ^ readWord(bytes + i + 8 * k)) * kPrime;
    }
    for (; i < size; i += 8) lane[0] = (lane[0] ^ readWord(bytes + i)) * kPrime;
    std::copy(lane, lane + 4, lane_);
    size_ += size;
  }
  std::uint64_t sum() const {
    std::uint64_t sum = size_;
    for (const std::uint64_t l : lane_) sum = (std::rotl(sum, 23) ^ l) * kPrime;
    return sum;
  }

 private:
  static constexpr std::uint64_t kPrime = 0x100000001b3u;
  std::uint64_t lane_[4] = {0xcbf29ce484222325u, 1, 2, 3};
  std::uint64_t size_ = 0;
};

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

/// Where bytes come from, piece by piece.
class Pieces {
 public:
  static constexpr std::size_t kPiece = std::size_t{1} << 18;
  Pieces() = default;
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;
  virtual ~Pieces() = default;
  /// kPiece bytes, at the end what is left; they live until the next call. Empty when there are no more.
  virtual std::span<const unsigned char> next() = 0;
};

class MemoryPieces : public Pieces {
 public:
  explicit MemoryPieces(std::span<const unsigned char> bytes) : left_(bytes) {}
  std::span<const unsigned char> next() override {
    const std::span<const unsigned char> piece = left_.first(std::min(kPiece, left_.size()));
    left_ = left_.subspan(piece.size());
    return piece;
  }

 private:
  std::span<const unsigned char> left_;
};

class FilePieces : public Pieces {
 public:
  explicit FilePieces(std::FILE* file) : file_(file), buffer_(kPiece / sizeof(double)) {
    std::setvbuf(file, nullptr, _IONBF, 0);  // straight into the buffer
  }
  std::span<const unsigned char> next() override {
    auto* const to = reinterpret_cast<unsigned char*>(buffer_.data());
    return {to, std::fread(to, 1, kPiece, file_)};
  }

 private:
  std::FILE* file_;
  std::vector<double> buffer_;  ///< aligned as all that is read from it
};

/// Reads what is there; good() turns false for good at the first thing that is not as it must be. Every byte that goes
/// by is summed up.
class Reader {
 public:
  /// `size`: of all pieces together, a footer at the end included.
  Reader(Pieces& pieces, std::uint64_t size) : pieces_(pieces), unread_(size), left_(size - kFooter) { refill(); }
  bool good() const { return good_; }
  bool atEnd() const { return left_ == 0; }

  /// The next bytes; false when there are not so many.
  bool copy(void* to, std::size_t size) {
    if (!good_ || size > left_) return fail();
    auto* out = static_cast<unsigned char*>(to);
    left_ -= size;
    while (size > 0) {
      if (piece_.empty() && !refill()) return fail();
      const std::size_t part = std::min(size, piece_.size());
      std::memcpy(out, piece_.data(), part);
      piece_ = piece_.subspan(part);
      out += part;
      size -= part;
    }
    return true;
  }

  template <class T>
  void operator()(std::vector<T>& array) {
    const std::size_t size = section(sizeof(T));
    if constexpr (std::endian::native == std::endian::little && std::is_trivially_copyable_v<T>) {
      array.reserve(size / sizeof(T));  // filled as it comes: nothing is set to zero first
      for (std::size_t rest = size; rest > 0;) {
        if (piece_.empty() && !refill()) {
          fail();
          return;
        }
        const std::size_t whole = std::min(rest, piece_.size()) / sizeof(T);
        if (whole == 0 || reinterpret_cast<std::uintptr_t>(piece_.data()) % alignof(T) != 0) {
          T one;
          if (!copy(&one, sizeof(T))) return;
          array.push_back(one);
          rest -= sizeof(T);
          continue;
        }
        const T* const begin = reinterpret_cast<const T*>(piece_.data());
        array.insert(array.end(), begin, begin + whole);
        piece_ = piece_.subspan(whole * sizeof(T));
        left_ -= whole * sizeof(T);
        rest -= whole * sizeof(T);
      }
    } else {
      array.resize(size / sizeof(T));
      if (!copy(array.data(), size)) return;
      swapWords(reinterpret_cast<unsigned char*>(array.data()), size, wordOf<T>());
    }
    skipPadding(size);
  }
  void operator()(std::string& text) {
    text.resize(section(1));
    if (copy(text.data(), text.size())) skipPadding(text.size());
  }

  /// Whether the checksum at the end is that of all bytes before it. Reads what is left.
  bool isWhole() {
    while (refill()) {
    }
    return unread_ == 0 && sum_.sum() == footer_;
  }

 private:
  bool fail() { return good_ = false; }

  /// The size of a section that follows.
  std::size_t section(std::size_t element) {
    unsigned char word[8];
    if (!copy(word, sizeof word)) return 0;
    const std::uint64_t size = readWord(word);
    if (size > left_ || padded(static_cast<std::size_t>(size)) > left_ || size % element != 0) {
      fail();
      return 0;
    }
    return static_cast<std::size_t>(size);
  }
  void skipPadding(std::size_t size) {
    unsigned char nothing[8];
    copy(nothing, padded(size) - size);
  }

  bool refill() {
    const std::span<const unsigned char> piece = unread_ > 0 ? pieces_.next() : std::span<const unsigned char>();
    if (piece.empty() || piece.size() > unread_) return false;
    // Pieces are whole words, but for those of a file that has shrunk since it was measured.
    const std::uint64_t summed = unread_ - kFooter;
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(summed > unread_ ? 0 : summed, piece.size()));
    sum_.add(piece.data(), part / 8 * 8);
    if (part < piece.size() && piece.size() - part >= kFooter) footer_ = readWord(piece.data() + part);
    unread_ -= piece.size();
    piece_ = piece.first(part);
    return true;
  }

  Pieces& pieces_;
  std::span<const unsigned char> piece_;  ///< what is left of the present one
  std::uint64_t unread_;                  ///< bytes that no piece has brought yet
  std::uint64_t left_;                    ///< bytes before the footer that nobody has asked for yet
  Checksum sum_;
  std::uint64_t footer_ = 0;
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
  for (const Vec3f* v : {&p.boundsMin, &p.boundsMax, &p.center, &p.origin})
    n.reals.insert(n.reals.end(), {v->x, v->y, v->z});
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
  Checksum sum;
  sum.add(bytes.data(), bytes.size());
  writer.number(sum.sum());
  return std::move(bytes);
}

namespace {

UncookedMesh uncook(Pieces& pieces, std::uint64_t size) {
  if (size < kHeader + kFooter || size % 8 != 0) {
    const std::span<const unsigned char> first = pieces.next();
    const bool ours = first.size() >= 8 && std::memcmp(first.data(), kMagic, 8) == 0;
    return refused(ours ? "The cooked mesh is cut off." : "This is no cooked mesh.");
  }
  Reader reader(pieces, size);
  unsigned char header[kHeader] = {};
  if (!reader.copy(header, kHeader)) return refused("The cooked mesh is cut off.");
  if (std::memcmp(header, kMagic, 8) != 0) return refused("This is no cooked mesh.");
  const std::uint64_t version = readWord(header + 8), length = readWord(header + 16);
  if (version != kCookedVersion) {
    return refused("The cooked mesh is of version " + std::to_string(version) + "; this library reads version " +
                   std::to_string(kCookedVersion) + ".");
  }
  if (length > size) return refused("The cooked mesh is cut off.");
  if (length != size) return refused("There is more than the cooked mesh.");

  TriMeshParts parts;
  BinaryTree tree;
  Numbers numbers;
  std::vector<std::uint64_t> problems;
  std::string texts[3];
  visitParts(reader, numbers, parts, tree.nodes, problems, texts);
  // What was read so far was held against its own sizes only. It means something if the sum is right.
  const bool read = reader.good() && reader.atEnd();
  if (!reader.isWhole()) return refused("The cooked mesh is damaged.");
  if (!read || !unpackNumbers(numbers, parts, tree) || !unpackProblems(problems, texts[0], parts.report)) {
    return refused("The cooked mesh is not what its version says.");
  }
  parts.report.repair.messages = split(texts[1]);
  parts.report.error = texts[2];
  std::string fault = parts.fault();
  if (fault.empty()) fault = treeFault(tree, parts.triangles.size());
  if (!fault.empty()) return refused("The cooked mesh has " + fault + ".");
  return {std::make_shared<CollisionMesh>(TriMeshParts::assemble(std::move(parts)), std::move(tree)), {}};
}

}  // namespace

UncookedMesh uncookMesh(std::span<const unsigned char> bytes) {
  MemoryPieces pieces(bytes);
  return uncook(pieces, bytes.size());
}

UncookedMesh uncookFile(std::FILE* file, std::uint64_t size) {
  FilePieces pieces(file);
  return uncook(pieces, size);
}

}  // namespace otg
