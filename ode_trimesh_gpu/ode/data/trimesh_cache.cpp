// SPDX-License-Identifier: BSD-3-Clause
#include "ode/data/trimesh_cache.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/fork_gate.h"
#include "mesh/topology.h"

namespace otg {
namespace {

thread_local bool reading = false;

/// A geom of the same data in the pose in which mesh frame and world are one. So what ODE says of its triangles are the
/// vertices themselves, to the last bit. Made for one question: it costs less than a microsecond, and nothing is left
/// behind that would outlive the data.
class Reader {
 public:
  explicit Reader(dTriMeshDataID data) {
    reading = true;
    geom_ = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
    if (geom_ == nullptr) reading = false;
    if (geom_ == nullptr) throw std::bad_alloc();
  }
  ~Reader() {
    dGeomDestroy(geom_);
    reading = false;
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  std::uint32_t count() const { return static_cast<std::uint32_t>(std::max(0, dGeomTriMeshGetTriangleCount(geom_))); }
  void corners(std::uint32_t triangle, Vec3f out[3]) const {
    dVector3 v[3];
    dGeomTriMeshGetTriangle(geom_, static_cast<int>(triangle), &v[0], &v[1], &v[2]);
    for (int k = 0; k < 3; ++k) {
      out[k] = {static_cast<float>(v[k][0]), static_cast<float>(v[k][1]), static_cast<float>(v[k][2])};
    }
  }

 private:
  dGeomID geom_ = nullptr;
};

bool isSame(const Vec3f& p, const Vec3f& q) {
  return p.x == q.x && p.y == q.y && p.z == q.z;  // NaN differs from itself, and is refused anyway
}

/// What is kept of one dTriMeshDataID.
class Entry {
 public:
  std::shared_ptr<const CollisionMesh> meshNow(dTriMeshDataID data, std::atomic<std::uint64_t>& builds,
                                               std::atomic<std::uint64_t>& refits) {
    const CallLock lock(mutex_);
    const Reader reader(data);
    if (isCurrent(reader)) return mesh_;
    stale_ = false;
    known_ = false;  // should memory run out on the way
    const std::uint32_t count = reader.count();
    std::vector<Vec3f> corners(3 * std::size_t{count});
    for (std::uint32_t t = 0; t < count; ++t) reader.corners(t, &corners[3 * std::size_t{t}]);
    if (mesh_ != nullptr && move(corners)) {
      ++refits;
    } else {
      build(corners);
      ++builds;
    }
    known_ = true;
    return mesh_;
  }
  void setStale() { stale_ = true; }

  std::atomic<std::uint64_t> lastUse{0};

 private:
  bool isCurrent(const Reader& reader) {
    if (!known_ || stale_ || reader.count() != count_) return false;
    if (mesh_ == nullptr) return count_ == 0;  // refused ones are tried again: they may be good by now
    const TriMesh& mesh = mesh_->mesh();
    const std::uint32_t sample = std::min(count_, kTrimeshSample);
    // Spread over the mesh; the next question begins one triangle further on.
    const std::uint32_t step = count_ / std::max(sample, 1u);
    for (std::uint32_t i = 0; i < sample; ++i) {
      const std::uint32_t t = (cursor_ + i * step) % count_;
      Vec3f now[3];
      reader.corners(t, now);
      const Triangle& kept = mesh.triangles()[mesh.triangleOfCaller(t)];
      for (int k = 0; k < 3; ++k) {
        if (!isSame(now[k], mesh.vertices()[kept.v[k]])) return false;
      }
    }
    cursor_ = count_ == 0 ? 0 : (cursor_ + 1) % count_;
    return true;
  }

  /// The same triangles at other places. False if corners that were one vertex are apart now, or are others in number.
  bool move(const std::vector<Vec3f>& corners) {
    if (corners.size() != vertexOf_.size()) return false;
    std::vector<Vec3f> vertices(vertexCount_);
    std::vector<std::uint8_t> seen(vertexCount_, 0);
    for (std::size_t c = 0; c < corners.size(); ++c) {
      Vec3f& vertex = vertices[vertexOf_[c]];
      if (seen[vertexOf_[c]] != 0 && !isSame(vertex, corners[c])) return false;
      vertex = corners[c];
      seen[vertexOf_[c]] = 1;
    }
    const MeshResult moved = moveVertices(mesh_->mesh(), inputOf(vertices));
    mesh_ = moved.mesh == nullptr ? nullptr : std::make_shared<const CollisionMesh>(moved.mesh, *mesh_);
    return true;
  }

  void build(const std::vector<Vec3f>& corners) {
    // ODE gives places, not indices: corners at one place are taken for one vertex.
    const std::vector<std::uint32_t> weld = weldByPosition(corners);
    std::vector<std::uint32_t> vertexOf(corners.size());
    std::vector<Vec3f> vertices;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      if (weld[c] == c) {
        vertexOf[c] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(corners[c]);
      } else {
        vertexOf[c] = vertexOf[weld[c]];
      }
    }
    MeshInput input = inputOf(vertices);
    input.indices = vertexOf.data();
    input.triangleCount = corners.size() / 3;
    const MeshResult built = buildTriMesh(input, {}, MeshOrder::kBySize);
    mesh_ = built.mesh == nullptr || corners.empty()
                ? nullptr
                : std::make_shared<const CollisionMesh>(built.mesh, BuildStrategy::kSah);
    vertexOf_ = std::move(vertexOf);
    vertexCount_ = vertices.size();
    count_ = static_cast<std::uint32_t>(corners.size() / 3);
    cursor_ = 0;
  }

  static MeshInput inputOf(const std::vector<Vec3f>& vertices) {
    MeshInput input;
    input.vertices = vertices.data();
    input.vertexCount = vertices.size();
    return input;
  }

  std::mutex mutex_;
  bool known_ = false;
  std::atomic<bool> stale_{false};
  std::uint32_t count_ = 0, cursor_ = 0;
  std::size_t vertexCount_ = 0;
  std::vector<std::uint32_t> vertexOf_;  ///< of each corner
  std::shared_ptr<const CollisionMesh> mesh_;
};

class Cache {
 public:
  std::shared_ptr<Entry> entryOf(dTriMeshDataID data) {
    const std::uint64_t now = questions_.fetch_add(1, std::memory_order_relaxed) + 1;
    const CallLock lock(mutex_);
    // Data that were destroyed without our knowledge leave an entry behind. Those that were not requested for a long
    // time go when there are many; one that is still needed is built again.
    if (entries_.size() >= kMany && now >= nextSweep_) {
      std::erase_if(entries_, [&](const auto& e) { return e.second->lastUse + kLongAgo < now; });
      nextSweep_ = now + kLongAgo;
    }
    std::shared_ptr<Entry>& entry = entries_[data];
    if (entry == nullptr) entry = std::make_shared<Entry>();
    entry->lastUse = now;
    return entry;
  }
  std::shared_ptr<Entry> find(dTriMeshDataID data) {
    const CallLock lock(mutex_);
    const auto it = entries_.find(data);
    return it == entries_.end() ? nullptr : it->second;
  }
  void forget(dTriMeshDataID data) {
    const LibraryCall call;
    std::shared_ptr<Entry> last;  // goes after the lock
    const CallLock lock(mutex_);
    const auto it = entries_.find(data);
    if (it == entries_.end()) return;
    last = std::move(it->second);
    entries_.erase(it);
  }
  void clear() {
    const LibraryCall call;
    std::unordered_map<dTriMeshDataID, std::shared_ptr<Entry>> last;
    const CallLock lock(mutex_);
    last.swap(entries_);
  }
  std::size_t size() {
    const CallLock lock(mutex_);
    return entries_.size();
  }

  std::atomic<std::uint64_t> builds{0}, refits{0};

 private:
  static constexpr std::size_t kMany = 256;
  static constexpr std::uint64_t kLongAgo = 1u << 20;
  std::mutex mutex_;
  std::atomic<std::uint64_t> questions_{0};
  std::uint64_t nextSweep_ = 0;
  std::unordered_map<dTriMeshDataID, std::shared_ptr<Entry>> entries_;
};

/// Never destroyed: geoms may collide in the destructors of a program's own globals.
Cache& cache() {
  static Cache* const instance = new Cache;
  return *instance;
}

}  // namespace

std::shared_ptr<const CollisionMesh> meshOfTrimesh(dGeomID trimesh) {
  const dTriMeshDataID data = dGeomTriMeshGetData(trimesh);
  if (data == nullptr) return nullptr;
  return cache().entryOf(data)->meshNow(data, cache().builds, cache().refits);
}

void trimeshDataChanged(dTriMeshDataID data) noexcept {
  if (const std::shared_ptr<Entry> entry = cache().find(data)) entry->setStale();
}

void forgetTrimeshData(dTriMeshDataID data) noexcept {
  cache().forget(data);
}

void clearTrimeshCache() noexcept {
  cache().clear();
}

bool isReadingTrimesh() noexcept {
  return reading;
}

TrimeshCacheStats trimeshCacheStats() {
  return {cache().builds, cache().refits, cache().size()};
}

}  // namespace otg
