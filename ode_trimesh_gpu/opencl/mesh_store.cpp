// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/mesh_store.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "bvh/packed_tree.h"

namespace otg::opencl {
namespace {

constexpr std::uint64_t kUnit = 16;
constexpr std::uint32_t kFirstUnits = 1u << 18;  // 4 MiB
constexpr std::uint64_t kAddressable = 0xffffffffu;

struct Unit {
  float x, y, z;
  std::uint32_t w;
};
static_assert(sizeof(Unit) == kUnit);

}  // namespace

struct MeshStore::Packed {
  std::vector<Unit> units;
  otg_device_mesh place{};  ///< relative to the first unit

  Packed(const CollisionMesh& collisionMesh, std::uint32_t leafTriangles) {
    const TriMesh& mesh = collisionMesh.mesh();
    const PackedTree tree = makePackedTree(collisionMesh.tree(), leafTriangles);
    units.reserve(2 * tree.nodes.size() + 4 * tree.triangles.size() + 2 * tree.cut.size());
    const auto addNode = [&](const PackedNode& n, std::uint32_t first) {
      units.push_back({n.center.x, n.center.y, n.center.z, first});
      units.push_back({n.extent.x, n.extent.y, n.extent.z, static_cast<std::uint32_t>(n.count)});
    };
    place.nodes = 0;
    for (const PackedNode& n : tree.nodes) addNode(n, static_cast<std::uint32_t>(n.first));
    place.soup = static_cast<std::uint32_t>(units.size());
    for (const std::uint32_t triangle : tree.triangles) {
      const std::uint32_t w[3] = {triangle, mesh.isDegenerate(triangle) ? 1u : 0u, 0u};
      for (int k = 0; k < 3; ++k) {
        const Vec3f& v = mesh.vertices()[mesh.triangles()[triangle].v[k]];
        units.push_back({v.x, v.y, v.z, w[k]});
      }
    }
    place.cut = static_cast<std::uint32_t>(units.size());
    place.cutCount = static_cast<std::uint32_t>(tree.cut.size());
    for (const std::uint32_t node : tree.cut) addNode(tree.nodes[node], node);
    place.center = mesh.center();
    place.depth = tree.depth;
    place.radius = mesh.radius();
    place.triangles = static_cast<std::uint32_t>(mesh.triangleCount());
    addRings(mesh);
  }

 private:
  /// See OTG_RING_TWIN.
  void addRings(const TriMesh& mesh) {
    const Topology& topology = mesh.topology();
    const std::size_t halfEdges = 3 * mesh.triangleCount();
    std::vector<std::uint32_t> next(halfEdges), last(topology.edgeCount(), kNone), count(topology.edgeCount(), 0);
    for (std::uint32_t h = 0; h < halfEdges; ++h) {
      next[h] = h;
      const std::uint32_t edge = topology.edgeOf[h];
      if (edge == kNone) continue;
      if (last[edge] != kNone) std::swap(next[h], next[last[edge]]);
      last[edge] = h;
      if (++count[edge] > OTG_MOST_ON_EDGE) place.flags |= OTG_MESH_TANGLED;
    }
    for (std::uint32_t h = 0; h < halfEdges; ++h) {
      if (topology.edgeOf[h] != kNone && count[topology.edgeOf[h]] == 2) next[h] |= OTG_RING_TWIN;
    }
    place.rings = static_cast<std::uint32_t>(units.size());
    for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
      units.push_back({std::bit_cast<float>(next[3 * t]), std::bit_cast<float>(next[3 * t + 1]),
                       std::bit_cast<float>(next[3 * t + 2]), mesh.callerTriangle(t)});
    }
  }
};

MeshStore::MeshStore(Context& context, std::uint64_t budget, std::uint32_t leafTriangles)
    : context_(context),
      mostUnits_(std::min({budget / kUnit, context.info().largestAllocation / kUnit, kAddressable})),
      leafTriangles_(leafTriangles),
      queue_(context.makeQueue(false)) {}

MeshStore::Pinned MeshStore::acquire(std::span<const CollisionMesh* const> meshes) {
  Pinned pinned;
  const std::lock_guard lock(mutex_);
  for (const CollisionMesh* mesh : meshes) {
    const std::weak_ptr<const void> alive = mesh->lifetime();
    auto found = residents_.find(alive);
    if (found == residents_.end()) {
      auto resident = std::make_shared<Resident>();
      upload(Packed(*mesh, leafTriangles_), *resident);
      found = residents_.emplace(alive, std::move(resident)).first;
    }
    found->second->lastUse = ++clock_;
    ++found->second->pins;
    pinned.meshes_.push_back(found->second);
  }
  pinned.buffer_ = buffer_;
  return pinned;
}

void MeshStore::upload(const Packed& packed, Resident& resident) {
  if (packed.units.size() > mostUnits_) {
    throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "a mesh is larger than the memory budget");
  }
  const auto units = static_cast<std::uint32_t>(packed.units.size());
  const std::uint32_t begin = allocate(units);
  clDo(OTG_CL(clEnqueueWriteBuffer), queue_.get(), buffer_->get(), cl_bool{CL_TRUE}, std::size_t{begin * kUnit},
       std::size_t{units * kUnit}, static_cast<const void*>(packed.units.data()), cl_uint{0},
       static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
  resident.begin = begin;
  resident.units = units;
  resident.place = packed.place;
  resident.place.nodes += begin;
  resident.place.soup += begin;
  resident.place.cut += begin;
  resident.place.rings += begin;
  taken_[begin] = begin + units;
  ++counts_.uploads;
  counts_.bytesUploaded += units * kUnit;
  counts_.bytesUsed += units * kUnit;
}

std::uint32_t MeshStore::allocate(std::uint32_t units) {
  std::uint32_t begin = 0;
  forgetDead();
  if (findGap(units, begin)) return begin;
  if (grow(units) && findGap(units, begin)) return begin;
  while (evictOne()) {
    if (findGap(units, begin)) return begin;
  }
  throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "the memory budget is used up by meshes in use");
}

bool MeshStore::findGap(std::uint32_t units, std::uint32_t& begin) const {
  std::uint32_t at = 0;
  for (const auto& [from, to] : taken_) {
    if (from - at >= units) break;
    at = to;
  }
  begin = at;
  return std::uint64_t{at} + units <= capacity_;
}

/// A larger buffer with the same contents. Queries that are under way keep the old one.
bool MeshStore::grow(std::uint32_t units) {
  const std::uint64_t wanted = std::max(
      {std::uint64_t{kFirstUnits}, 2 * std::uint64_t{capacity_}, std::bit_ceil(std::uint64_t{capacity_} + units)});
  const auto capacity = static_cast<std::uint32_t>(std::min(wanted, mostUnits_));
  if (capacity <= capacity_) return false;
  auto larger = std::make_shared<const BufferHandle>(context_.makeBuffer(CL_MEM_READ_ONLY, capacity * kUnit));
  if (buffer_) {
    clDo(OTG_CL(clEnqueueCopyBuffer), queue_.get(), buffer_->get(), larger->get(), std::size_t{0}, std::size_t{0},
         std::size_t{capacity_ * kUnit}, cl_uint{0}, static_cast<const cl_event*>(nullptr),
         static_cast<cl_event*>(nullptr));
    clDo(OTG_CL(clFinish), queue_.get());
  }
  buffer_ = std::move(larger);
  capacity_ = capacity;
  counts_.bytesHeld = capacity * kUnit;
  return true;
}

bool MeshStore::evictOne() {
  auto oldest = residents_.end();
  for (auto it = residents_.begin(); it != residents_.end(); ++it) {
    if (it->second->pins != 0) continue;
    if (oldest == residents_.end() || it->second->lastUse < oldest->second->lastUse) oldest = it;
  }
  if (oldest == residents_.end()) return false;
  taken_.erase(oldest->second->begin);
  counts_.bytesUsed -= oldest->second->units * kUnit;
  ++counts_.evictions;
  residents_.erase(oldest);
  return true;
}

void MeshStore::forgetDead() {
  for (auto it = residents_.begin(); it != residents_.end();) {
    if (it->second->pins == 0 && it->first.expired()) {
      taken_.erase(it->second->begin);
      counts_.bytesUsed -= it->second->units * kUnit;
      it = residents_.erase(it);
    } else {
      ++it;
    }
  }
}

MeshStore::Counts MeshStore::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace otg::opencl
