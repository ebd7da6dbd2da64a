// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its trees.
#include "bvh/collision_mesh.h"

#include <algorithm>
#include <new>
#include <utility>

#include "base/vectors.h"
#include "bvh/image_boxes.h"

namespace otg {
namespace {

std::shared_ptr<MeshTrees> refitted(const TriMesh& moved, const MeshTrees& before) {
  BinaryTree tree = before.tree();
  refitTree(tree, moved);
  const double builtCost = before.builtCost();
  if (sahCost(tree) <= MeshTrees::kRebuildCost * builtCost) {
    return std::make_shared<MeshTrees>(std::move(tree), builtCost);
  }
  return std::make_shared<MeshTrees>(buildTree(moved, tree.strategy));
}

bool touchesRim(const TriMesh& mesh, std::span<const std::uint32_t> triangles) {
  const SharedArray<std::uint32_t>& twin = mesh.topology().twin;
  return std::ranges::any_of(triangles, [&](std::uint32_t t) {
    const std::size_t half = 3 * std::size_t{t};
    return twin[half] == kNone || twin[half + 1] == kNone || twin[half + 2] == kNone;
  });
}

/// Whether the triangles' boxes have so much more area than they. Half of what a box has counts.
bool areThin(const TriMesh& mesh) {
  double ofBoxes = 0, ofTriangles = 0;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = asDouble(mesh.vertices()[mesh.triangles()[t].v[k]]);
    const Vec3d size =
        maximum(maximum(corner[0], corner[1]), corner[2]) - minimum(minimum(corner[0], corner[1]), corner[2]);
    ofBoxes += size.x * size.y + size.y * size.z + size.z * size.x;
    ofTriangles += 0.5 * norm(otgCross(corner[1] - corner[0], corner[2] - corner[0]));
  }
  return ofBoxes > CollisionMesh::kThin * ofTriangles;
}

/// No one but the caller has it, and what the last of the others did is done: a count of one is for good, since only
/// the holder could make another. The copy that is dropped at once orders what went on elsewhere before what is done
/// here.
template <class T>
bool heldBy(const std::shared_ptr<T>& object, long holders) {
  std::shared_ptr<T> ordered = object;
  ordered.reset();
  return object.use_count() <= holders;
}

}  // namespace

/// All that moveSome() keeps between calls, but for the trees' part.
struct CollisionMesh::Motion {
  VertexMotion vertices;
  // From the beginning of a move to its end:
  std::shared_ptr<const char> alive;      ///< the lifetime after it
  std::shared_ptr<const char> structure;  ///< the structure after it, where the tree is built anew
  std::shared_ptr<MeshTrees> before;      ///< trees that others go on with; null where they are still this mesh's
  const CollisionMesh* of = nullptr;      ///< followMove()
  bool rebuilt = false;                   ///< of the last move: whether the tree was built anew
};

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> mesh, BuildStrategy strategy)
    : mesh_(std::move(mesh)),
      hasThinTriangles_(areThin(*mesh_)),
      trees_(std::make_shared<MeshTrees>(buildTree(*mesh_, strategy))) {}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> moved, const CollisionMesh& before)
    : mesh_(std::move(moved)), hasThinTriangles_(areThin(*mesh_)), trees_(refitted(*mesh_, *before.trees_)) {}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> image, const CollisionMesh& of, const Vec3f& factors)
    : mesh_(std::move(image)),
      hasThinTriangles_(areThin(*mesh_)),
      trees_(of.trees_),
      imageBoxes_(makeBoxScale(of.mesh(), *mesh_, factors)),
      factors_(factors) {
  if (stretchesTooMuch(factors) || (imageBoxes_ && imageIsWorn())) {
    trees_ = std::make_shared<MeshTrees>(buildTree(*mesh_, of.tree().strategy));
    imageBoxes_.reset();
  } else if (!imageBoxes_) {
    trees_ = refitted(*mesh_, *of.trees_);
  }
}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> mesh, BinaryTree&& tree)
    : mesh_(std::move(mesh)),
      hasThinTriangles_(areThin(*mesh_)),
      trees_(std::make_shared<MeshTrees>(std::move(tree))) {}

CollisionMesh::~CollisionMesh() = default;

BinaryTree CollisionMesh::ownBoxes() const {
  BinaryTree tree = trees_->tree();
  if (!imageBoxes_) return tree;
  for (BvhNode& node : tree.nodes) {
    const BoxOf box = scaledBox(*imageBoxes_, node.center, node.extent);
    node.center = box.center;
    node.extent = box.extent;
  }
  return tree;
}

const Adjacency& CollisionMesh::adjacency() const {
  return adjacency_.get([this] { return buildAdjacency(*mesh_); });
}

const ConvexPolyhedron* CollisionMesh::convex() const {
  return convex_.get([this] { return buildConvexPolyhedron(*mesh_); }).get();
}

const std::vector<std::int8_t>& CollisionMesh::outwardSides() const {
  return outwardSides_.get([this] { return otg::outwardSides(*mesh_); }).each;
}

const CollisionMesh* CollisionMesh::turned() const {
  const ValidationReport& report = mesh_->report();
  if (report.solid || report.triangles == 0 || report.boundaryEdges > 0 || report.inconsistentEdges > 0) return nullptr;
  return turned_
      .get([this]() -> std::unique_ptr<const CollisionMesh> {
        const std::vector<Vec3f> vertices = verticesOfCaller(*mesh_);
        MeshInput input;
        input.vertices = vertices.data();
        input.vertexCount = vertices.size();
        const MeshResult result = moveVertices(*mesh_, input, true);
        if (!result.report.solid) return nullptr;
        return std::make_unique<const CollisionMesh>(result.mesh, tree().strategy);
      })
      .get();
}

void CollisionMesh::prepare() const {
  wide();
  adjacency();
  convex();
  outwardSides();
  if (const CollisionMesh* const other = turned()) other->prepare();
  if (const Parts* const own = parts()) {
    for (const auto& part : own->meshes) part->prepare();
  }
}

const CollisionMesh::Parts* CollisionMesh::parts() const {
  return parts_
      .get([this]() -> std::unique_ptr<const Parts> {
        if (!mayHaveParts(*mesh_)) return nullptr;
        auto own = std::make_unique<Parts>(
            Parts{withOwnBoxes([this](const BinaryTree& tree) { return takeSolidApart(*mesh_, tree); }), {}});
        if (own->parts.empty()) return nullptr;
        for (const SolidParts::Part& part : own->parts) {
          own->meshes.push_back(std::make_unique<const CollisionMesh>(part.mesh, tree().strategy));
        }
        return own;
      })
      .get();
}

/// `of`: of an image, the mesh whose move it follows.
CollisionMesh::Motion& CollisionMesh::motion(const CollisionMesh* of) {
  if (motion_ == nullptr) {
    const VertexMotion* const like = of == nullptr ? nullptr : &of->motion_->vertices;
    motion_.reset(new Motion{VertexMotion(*mesh_, like), {}, {}, {}});
  }
  return *motion_;
}

std::uint32_t CollisionMesh::ownVertex(std::uint32_t ofCaller) {
  return motion().vertices.ownVertex(ofCaller);
}

bool CollisionMesh::moveSome(std::span<const MovedVertex> moved) {
  if (!beginMove(moved)) return false;
  finishMove();
  return true;
}

bool CollisionMesh::beginMove(std::span<const MovedVertex> moved, long images) {
  if (!heldBy(mesh_, 1)) return false;
  // The trees are changed when all has come out well; until then the others', if there are any, stay this mesh's.
  std::shared_ptr<MeshTrees> trees = trees_;
  try {
    if (!heldBy(trees_, 2 + images))
      trees = std::make_shared<MeshTrees>(BinaryTree(trees_->tree()), trees_->builtCost());
    Motion& m = motion();
    m.vertices.plan(*mesh_, moved);
    trees->planMove(*mesh_, m.vertices.triangles());
    m.alive = std::make_shared<const char>('\0');
    m.structure = std::make_shared<const char>('\0');
    // Every mesh is made as an object that is not const (TriMeshBuilder, TriMeshParts); shared it is const.
    if (!m.vertices.move(const_cast<TriMesh&>(*mesh_))) {
      trees->dropMotion();
      motion_.reset();
      return false;
    }
    m.of = nullptr;
  } catch (...) {
    trees->dropMotion();
    motion_.reset();
    throw;
  }
  if (trees != trees_) motion_->before = std::exchange(trees_, std::move(trees));
  return true;
}

bool CollisionMesh::followMove(const CollisionMesh& of, std::span<const MovedVertex> moved) {
  if (!heldBy(mesh_, 1)) return false;
  try {
    Motion& m = motion(&of);
    m.vertices.plan(*mesh_, moved);
    m.alive = std::make_shared<const char>('\0');
    m.structure = std::make_shared<const char>('\0');
    if (!m.vertices.move(const_cast<TriMesh&>(*mesh_))) {
      motion_.reset();
      return false;
    }
    m.of = &of;
  } catch (...) {
    motion_.reset();
    throw;
  }
  if (makeBoxScale(of.mesh(), *mesh_, factors_)) return true;
  undoMove();
  return false;
}

void CollisionMesh::undoMove() noexcept {
  motion_->vertices.undo(const_cast<TriMesh&>(*mesh_));
  if (motion_->of == nullptr) trees_->dropMotion();
  if (motion_->before != nullptr) trees_ = std::move(motion_->before);
  motion_.reset();
}

void CollisionMesh::finishMove() noexcept {
  Motion& m = *motion_;
  alive_ = std::move(m.alive);
  convex_.reset();
  const OutwardSides* const sides = outwardSides_.made();
  if (sides == nullptr || !sides->areOfRims || touchesRim(*mesh_, m.vertices.triangles())) outwardSides_.reset();
  turned_.reset();
  parts_.reset();
  if (Adjacency* const adjacency = adjacency_.made()) {
    try {
      updateAdjacency(*adjacency, *mesh_, m.vertices.triangles());
    } catch (const std::bad_alloc&) {
      adjacency_.reset();  // to be built when it is requested
    }
  }
  if (m.of != nullptr) {
    finishFollowing();
  } else {
    finishOwnMove();
  }
}

void CollisionMesh::finishOwnMove() noexcept {
  Motion& m = *motion_;
  m.before.reset();
  trees_->refit(*mesh_);
  logMove(m.vertices.triangles());
  m.rebuilt = trees_->rebuildIfWorn(*mesh_);
  if (m.rebuilt) structure_ = std::move(m.structure);
}

void CollisionMesh::finishFollowing() noexcept {
  Motion& m = *motion_;
  const CollisionMesh& of = *std::exchange(m.of, nullptr);
  trees_ = of.trees_;
  // All whose boxes are others now: more than this mesh's own where a place has been rounded to what it was.
  const std::span<const std::uint32_t> triangles = of.motion_->vertices.triangles();
  logMove(triangles);
  movedSinceLook_ += triangles.size();
  if (of.motion_->rebuilt) structure_ = std::move(m.structure);
  if (!of.motion_->rebuilt && movedSinceLook_ < mesh_->triangleCount()) return;
  movedSinceLook_ = 0;
  if (imageIsWorn()) takeOwnTree();
}

/// Whether the boxes of an image, in the trees that it shares, are too bad. Takes a look at all of them.
bool CollisionMesh::imageIsWorn() const {
  return sahCost(trees_->tree(), *imageBoxes_) > kRebuildCost * trees_->builtCost();
}

/// Without memory for it all stays as it is, which is right if slow.
void CollisionMesh::takeOwnTree() noexcept {
  try {
    auto structure = std::make_shared<const char>('\0');
    trees_ = std::make_shared<MeshTrees>(buildTree(*mesh_, trees_->tree().strategy));
    imageBoxes_.reset();
    structure_ = std::move(structure);
  } catch (const std::bad_alloc&) {
    return;
  }
}

void CollisionMesh::logMove(std::span<const std::uint32_t> triangles) noexcept {
  ++log_.moves;
  const std::size_t most = mesh_->triangleCount() / kLoggedShare;
  try {
    while (!log_.counts.empty() && log_.triangles.size() + triangles.size() > most) {
      log_.triangles.erase(log_.triangles.begin(),
                           log_.triangles.begin() + static_cast<std::ptrdiff_t>(log_.counts.front()));
      log_.counts.pop_front();
    }
    if (triangles.size() > most) return;
    log_.triangles.insert(log_.triangles.end(), triangles.begin(), triangles.end());
    log_.counts.push_back(triangles.size());
  } catch (const std::bad_alloc&) {
    log_.triangles.clear();
    log_.counts.clear();
  }
}

std::optional<std::vector<std::uint32_t>> CollisionMesh::changedSince(std::uint64_t moves) const {
  const std::uint64_t since = log_.moves - moves;
  if (moves > log_.moves || since > log_.counts.size()) return std::nullopt;
  std::size_t count = 0;
  for (std::uint64_t i = 1; i <= since; ++i) count += log_.counts[log_.counts.size() - i];
  return std::vector<std::uint32_t>(log_.triangles.end() - static_cast<std::ptrdiff_t>(count), log_.triangles.end());
}

}  // namespace otg
