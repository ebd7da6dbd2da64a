// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/mesh_store.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <optional>

#include "opencl/meshes/pack_mesh.h"

namespace otg::opencl {
namespace {

constexpr std::uint64_t kUnit = 16;
constexpr std::uint32_t kFirstUnits = 1u << 18;  // 4 MiB
constexpr std::uint64_t kAddressable = 0xffffffffu;
/// A change is sent as its place and a unit. Where all of them are more than the second part of the mesh, that is sent.
constexpr std::uint64_t kChangeBytes = kUnit + sizeof(std::uint32_t);
constexpr std::uint64_t kMostChanges = 2;
constexpr std::size_t kScatterGroup = 64;

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

void MeshStore::prepare() {
  const std::lock_guard lock(mutex_);
  if (!scatter_) scatter_.make(context_, "meshes/mesh_scatter.cl", "");
}

MeshStore::Pinned MeshStore::acquire(std::span<const CollisionMesh* const> meshes) {
  Pinned pinned;
  const std::lock_guard lock(mutex_);
  for (const CollisionMesh* mesh : meshes) {
    const std::weak_ptr<const void> key = mesh->structure();
    auto found = residents_.find(key);
    if (found != residents_.end() && found->second->moves != mesh->moves()) {
      outdated_.reserve(outdated_.size() + 1);
      bool good = false;
      try {
        good = update(*mesh, *found->second);
      } catch (...) {  // what lies there may be anything
        drop(found);
        throw;
      }
      if (!good) found = (drop(found), residents_.end());
    }
    if (found == residents_.end()) {
      auto resident = std::make_shared<Resident>();
      upload(*mesh, *resident);
      found = residents_.emplace(key, std::move(resident)).first;
    }
    found->second->lastUse = ++clock_;
    ++found->second->pins;
    pinned.meshes_.push_back(found->second);
  }
  pinned.buffer_ = buffer_;
  return pinned;
}

void MeshStore::upload(const CollisionMesh& mesh, Resident& resident) {
  // What has moved will move again; most meshes never do, and need no places.
  const PackedMesh packed =
      packMesh(mesh, layout_, leafTriangles_, cutOrder_, mesh.moves() == 0 ? nullptr : &resident.places);
  resident.moves = mesh.moves();
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

/// False where the mesh has to be sent whole: nothing has changed then.
bool MeshStore::update(const CollisionMesh& mesh, Resident& resident) {
  if (resident.places == nullptr || resident.pins != 0) return false;
  std::optional<std::vector<std::uint32_t>> triangles = mesh.changedSince(resident.moves);
  if (!triangles) return false;
  const std::optional<PackedChanges> changes = resident.places->changesOf(mesh, std::move(*triangles));
  if (!changes || changes->units.size() * kChangeBytes > resident.units * kUnit / kMostChanges) return false;
  if (!changes->units.empty()) send(*changes, resident.begin);
  resident.place.center = mesh.mesh().origin();
  resident.place.radius = mesh.mesh().radius();
  resident.moves = mesh.moves();
  return true;
}

void MeshStore::send(const PackedChanges& changes, std::uint32_t begin) {
  const std::size_t count = changes.units.size(), places = (count + 3) / 4;
  static_assert(sizeof(MeshUnit) == 4 * sizeof(std::uint32_t));
  sending_.resize(places);
  std::memcpy(sending_.data(), changes.at.data(), count * sizeof(std::uint32_t));
  sending_.insert(sending_.end(), changes.units.begin(), changes.units.end());
  if (!scatter_) scatter_.make(context_, "meshes/mesh_scatter.cl", "");
  sent_.reserve(context_, sending_.size());
  const cl_command_queue queue = queue_.get();
  scatter_.give({.meshes = BufferOf<MeshUnit>(buffer_->get()),
                 .sent = sent_.buffer(),
                 .count = static_cast<otg_uint>(count),
                 .begin = begin});
  writeLater(queue, sent_.get(), sending_.size() * sizeof(MeshUnit), sending_.data());
  try {
    launch(queue, scatter_, kScatterGroup, (count + kScatterGroup - 1) / kScatterGroup);
    clDo(OTG_CL(clFinish), queue);
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue);  // the memory that is sent stays until it was
    throw;
  }
  ++counts_.updates;
  counts_.bytesUploaded += sending_.size() * sizeof(MeshUnit);
}

/// Forgets a mesh; its place is free as soon as no query has it.
MeshStore::Residents::iterator MeshStore::drop(Residents::iterator it) {
  const std::shared_ptr<Resident> resident = it->second;
  const auto next = residents_.erase(it);
  if (resident->pins != 0) {
    outdated_.push_back(resident);  // there is room: acquire()
  } else {
    taken_.erase(resident->begin);
    counts_.bytesUsed -= resident->units * kUnit;
  }
  return next;
}

std::uint32_t MeshStore::allocate(std::uint32_t units) {
  std::uint32_t begin = 0;
  forgetDead();
  if (findGap(units, begin)) return begin;
  if (grow(units) && findGap(units, begin)) return begin;
  while (evictOne()) {
    if (findGap(units, begin)) return begin;
  }
  throw MemoryInUse("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE,
                    "the memory budget is used up by meshes in use");
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
  auto larger = std::make_shared<const BufferHandle>(context_.makeBuffer(CL_MEM_READ_WRITE, capacity * kUnit));
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
  drop(oldest);
  ++counts_.evictions;
  return true;
}

void MeshStore::forgetDead() {
  for (auto it = residents_.begin(); it != residents_.end();) {
    it = it->second->pins == 0 && it->first.expired() ? drop(it) : std::next(it);
  }
  std::erase_if(outdated_, [&](const std::shared_ptr<Resident>& resident) {
    if (resident->pins != 0) return false;
    taken_.erase(resident->begin);
    counts_.bytesUsed -= resident->units * kUnit;
    return true;
  });
}

MeshStore::Counts MeshStore::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace otg::opencl
