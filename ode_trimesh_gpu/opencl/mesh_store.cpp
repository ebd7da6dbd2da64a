// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/mesh_store.h"

#include <algorithm>
#include <bit>

namespace otg::opencl {
namespace {

constexpr std::uint64_t kUnit = 16;
constexpr std::uint32_t kFirstUnits = 1u << 18;  // 4 MiB
constexpr std::uint64_t kAddressable = 0xffffffffu;

static_assert(sizeof(MeshUnit) == kUnit);

}  // namespace

MeshStore::MeshStore(Context& context, std::uint64_t budget, std::uint32_t leafTriangles, MeshLayout layout,
                     std::uint32_t cutOrder)
    : context_(context),
      mostUnits_(std::min({budget / kUnit, context.info().largestAllocation / kUnit, kAddressable})),
      leafTriangles_(leafTriangles),
      cutOrder_(cutOrder),
      layout_(layout),
      queue_(context.makeQueue(false)) {}

MeshStore::Pinned MeshStore::acquire(std::span<const CollisionMesh* const> meshes) {
  Pinned pinned;
  const std::lock_guard lock(mutex_);
  for (const CollisionMesh* mesh : meshes) {
    const std::weak_ptr<const void> alive = mesh->lifetime();
    auto found = residents_.find(alive);
    if (found == residents_.end()) {
      auto resident = std::make_shared<Resident>();
      upload(packMesh(*mesh, layout_, leafTriangles_, cutOrder_), *resident);
      found = residents_.emplace(alive, std::move(resident)).first;
    }
    found->second->lastUse = ++clock_;
    ++found->second->pins;
    pinned.meshes_.push_back(found->second);
  }
  pinned.buffer_ = buffer_;
  return pinned;
}

void MeshStore::upload(const PackedMesh& packed, Resident& resident) {
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
  resident.place = packed.placeAt(begin);
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
