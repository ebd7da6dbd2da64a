// SPDX-License-Identifier: BSD-3-Clause
#include "ode/override/checked_arrays.h"

#include <atomic>
#include <cstring>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/fork_gate.h"
#include "opencl/runtime/log.h"

namespace otg {
namespace {

/// What is known of data that were built.
struct Built {
  std::vector<std::uint32_t> indices;  ///< in place of the program's; empty where those are used
  bool isEmpty = false;
};

struct AllBuilt {
  std::mutex mutex;
  std::atomic<bool> anyEmpty{false};  ///< there have been data without triangles
  std::unordered_map<dTriMeshDataID, Built> data;
};

/// Never destroyed: data may be destroyed in the destructors of a program's own globals.
AllBuilt& allBuilt() {
  static AllBuilt* const instance = new AllBuilt;
  return *instance;
}

struct Corners {
  std::uint32_t v[3];
};

Corners cornersOf(const void* indices, std::size_t triangle, std::size_t stride) {
  Corners corners;  // strides need not keep the alignment
  std::memcpy(corners.v, static_cast<const unsigned char*>(indices) + triangle * stride, sizeof corners.v);
  return corners;
}

}  // namespace

CheckedIndices checkIndices(dTriMeshDataID data, const char* function, const void* vertices, int vertexCount,
                            const void* indices, int indexCount, int stride) {
  Built built;
  built.isEmpty = vertices == nullptr || indices == nullptr || vertexCount <= 0 || indexCount < 3;
  CheckedIndices checked{indices, indexCount, stride, built.isEmpty};
  if (!built.isEmpty) {
    const std::size_t triangles = static_cast<std::size_t>(indexCount) / 3;
    const std::size_t step = stride > 0 ? static_cast<std::size_t>(stride) : sizeof(Corners);
    const auto limit = static_cast<std::uint32_t>(vertexCount);
    const auto isBad = [&](const Corners& c) { return c.v[0] >= limit || c.v[1] >= limit || c.v[2] >= limit; };
    std::size_t bad = 0, first = 0;
    for (std::size_t t = triangles; t-- > 0;) {
      if (!isBad(cornersOf(indices, t, step))) continue;
      ++bad;
      first = t;
    }
    if (bad > 0) {
      built.indices.assign(3 * triangles, 0);
      for (std::size_t t = 0; t < triangles; ++t) {
        const Corners corners = cornersOf(indices, t, step);
        if (!isBad(corners)) std::memcpy(&built.indices[3 * t], corners.v, sizeof corners.v);
      }
      opencl::logLine(std::string(function) + ": " + std::to_string(bad) + " of " + std::to_string(triangles) +
                      " triangles name a vertex that is not there (there are " + std::to_string(vertexCount) +
                      "), the first is triangle " + std::to_string(first) + "; they touch nothing");
      checked = {built.indices.data(), static_cast<int>(3 * triangles), static_cast<int>(sizeof(Corners)), false};
    }
  }
  AllBuilt& all = allBuilt();
  const CallLock lock(all.mutex);
  if (built.isEmpty) all.anyEmpty.store(true, std::memory_order_release);
  Built& kept = all.data[data];
  // ODE reads the old ones no more when it has been given others: they go when those come.
  std::swap(kept, built);
  return checked;
}

bool staysUnbuilt(dTriMeshDataID data) {
  AllBuilt& all = allBuilt();
  const CallLock lock(all.mutex);
  return all.data.find(data) == all.data.end();
}

const NoTriangles& noTriangles() {
  static const NoTriangles instance;
  return instance;
}

bool hasNoTriangles(dTriMeshDataID data) noexcept {
  if (data == nullptr) return true;
  AllBuilt& all = allBuilt();
  if (!all.anyEmpty.load(std::memory_order_acquire)) return false;
  const CallLock lock(all.mutex);
  const auto found = all.data.find(data);
  return found != all.data.end() && found->second.isEmpty;
}

bool isEmptyTrimesh(dGeomID geom) noexcept {
  return geom != nullptr && dGeomGetClass(geom) == dTriMeshClass && hasNoTriangles(dGeomTriMeshGetData(geom));
}

void forgetIndices(dTriMeshDataID data) noexcept {
  AllBuilt& all = allBuilt();
  const CallLock lock(all.mutex);
  all.data.erase(data);
}

int allowedFlags(int flags) noexcept {
  constexpr unsigned kCount = 0xffff, kBeyond = 0x7fff0000;
  const auto bits = static_cast<unsigned>(flags);
  if ((bits & kCount) != 0) return flags;
  return (bits & kBeyond) == 0 ? 0 : static_cast<int>((bits & ~kBeyond) | kCount);
}

}  // namespace otg
