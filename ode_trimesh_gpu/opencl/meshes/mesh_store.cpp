// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/mesh_store.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <optional>
#include <unordered_set>

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
/// Meshes are packed and sent together until they have about so many units.
constexpr std::uint64_t kSentTogether = std::uint64_t{4} << 20;
std::uint64_t unitsAbout(const CollisionMesh& mesh) {
  return 17 * mesh.mesh().triangleCount();
}
/// Places of meshes that are gone are looked for when so many of those that are there have been placed anew.
constexpr std::uint64_t kSweepShare = 4;

static_assert(sizeof(MeshUnit) == kUnit);

}  // namespace

MeshStore::MeshStore(Context& context, std::shared_ptr<MemoryBudget> budget, std::uint32_t leafTriangles,
                     MeshLayout layout, std::uint32_t cutOrder)
    : context_(context),
      budget_(std::move(budget)),
      mostUnits_(std::min({budget_->bytes() / kUnit, context.info().largestAllocation / kUnit, kAddressable})),
      leafTriangles_(leafTriangles),
      cutOrder_(cutOrder),
      layout_(layout),
      queue_(context.makeQueue(false)) {
  budget_->join(*this);
  context_.memory().join(*this);
}

MeshStore::~MeshStore() {
  context_.memory().leave(*this);
  budget_->leave(*this);
  budget_->giveBack(places_.capacity() * kUnit);
}

void MeshStore::prepare() {
  const Lock lock(*this);
  if (!scatter_) scatter_.make(context_, "meshes/mesh_scatter.cl", "");
}

MeshStore::Pinned MeshStore::acquire(std::span<const CollisionMesh* const> meshes, const RunParts* threads) {
  try {
    return tryAcquire(meshes, threads);
  } catch (const MemoryInUse&) {
    // What is free may lie in pieces that are too small, between meshes of this very call.
    if (!startAnew()) throw;
  }
  return tryAcquire(meshes, threads);
}

MeshStore::Pinned MeshStore::tryAcquire(std::span<const CollisionMesh* const> meshes, const RunParts* threads) {
  Pinned pinned;
  pinned.meshes_.resize(meshes.size(), nullptr);
  std::vector<std::size_t> absent;
  std::uint64_t held = 0, later = 0;  // units; about
  {
    const Lock lock(*this);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      if (pin(*meshes[i], pinned.meshes_[i])) continue;
      absent.push_back(i);
      later += unitsAbout(*meshes[i]);
    }
    pinned.buffer_ = buffer_;
  }
  std::unordered_set<const CollisionMesh*> sent;
  for (std::size_t from = 0; from < absent.size();) {
    std::vector<Parcel> parcels;
    std::size_t to = from;
    for (std::uint64_t units = 0; to < absent.size() && units < kSentTogether; ++to) {
      const CollisionMesh* const mesh = meshes[absent[to]];
      later -= unitsAbout(*mesh);
      if (!sent.insert(mesh).second) continue;
      parcels.push_back({mesh, {}, {}});
      units += unitsAbout(*mesh);
    }
    Residents residents;
    pack(parcels, residents, threads);
    for (const Parcel& parcel : parcels) held += parcel.packed.units.size();
    if (held > mostUnits_) {
      throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "meshes are larger than the memory budget");
    }
    const Lock lock(*this);
    upload(parcels, residents, later);
    for (; from < to; ++from) pin(*meshes[absent[from]], pinned.meshes_[absent[from]]);
    pinned.buffer_ = buffer_;
  }
  return pinned;
}

/// Makes all meshes go, unless some query has one, or there is none.
bool MeshStore::startAnew() {
  const Lock lock(*this);
  if (residents_.empty() || isAnyInUse()) return false;
  forgetAll();
  return true;
}

bool MeshStore::isAnyInUse() const {
  const auto isInUse = [](const Resident& resident) { return resident.pins != 0; };
  return std::any_of(residents_.begin(), residents_.end(), isInUse) ||
         std::any_of(outdated_.begin(), outdated_.end(), isInUse);
}

/// The buffers go, too.
void MeshStore::forgetAll() noexcept {
  counts_.evictions += residents_.size();
  byMesh_.clear();
  residents_.clear();
  outdated_.clear();
  buffer_.reset();
  sent_ = ListOf<MeshUnit>();
  budget_->giveBack(places_.capacity() * kUnit);
  places_.clear();
  counts_.bytesUsed = counts_.bytesHeld = 0;
}

/// False where the mesh is not there, or not as it is now.
bool MeshStore::pin(const CollisionMesh& mesh, Resident*& pinned) {
  const auto found = byMesh_.find(mesh.structureKey());
  if (found == byMesh_.end()) return false;
  const Residents::iterator it = found->second;
  if (it->moves != mesh.moves()) {
    bool good = false;
    try {
      good = update(mesh, *it);
    } catch (...) {  // what lies there may be anything
      it->places.reset();
      drop(it);
      throw;
    }
    if (!good) {
      drop(it);
      return false;
    }
  }
  residents_.splice(residents_.end(), residents_, it);
  ++it->pins;
  pinned = &*it;
  return true;
}

/// Not under the lock: meshes stay as they are while a query has them.
void MeshStore::pack(std::span<Parcel> parcels, Residents& residents, const RunParts* threads) const {
  for (Parcel& parcel : parcels) parcel.resident = residents.emplace(residents.end());
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (Parcel& parcel : parcels.subspan(begin, end - begin)) {
      const CollisionMesh& mesh = *parcel.mesh;
      Resident& resident = *parcel.resident;
      // What has moved will move again; most meshes never do, and need no places.
      parcel.packed =
          packMesh(mesh, layout_, leafTriangles_, cutOrder_, mesh.moves() == 0 ? nullptr : &resident.places);
      resident.moves = mesh.moves();
      resident.key = mesh.structureKey();
      resident.structure = mesh.structure();
    }
  };
  if (threads != nullptr && parcels.size() > 1) {
    (*threads)(parcels.size(), some);
  } else {
    some(0, parcels.size());
  }
}

/// All of them are there then. On the way they are in none of the lists, so that nothing makes them go.
void MeshStore::upload(std::span<Parcel> parcels, Residents& residents, std::uint64_t later) {
  std::uint64_t all = later;  // so that the buffer grows once
  for (const Parcel& parcel : parcels) all += parcel.packed.units.size();
  std::vector<Parcel> placed;
  placed.reserve(parcels.size());
  byMesh_.reserve(byMesh_.size() + parcels.size());
  std::size_t listed = 0;
  try {
    makeRoom(all);
    for (Parcel& parcel : parcels) {
      Resident& resident = *parcel.resident;
      // Another thread may have sent it meanwhile.
      if (!byMesh_.try_emplace(resident.key, residents_.end()).second) continue;
      placed.push_back(std::move(parcel));
      resident.units = static_cast<std::uint32_t>(placed.back().packed.units.size());
      resident.begin = allocate(resident.units);
      resident.place = placed.back().packed.placeAt(resident.begin);
      ++listed;
    }
    write(placed);
  } catch (...) {
    for (std::size_t i = 0; i < placed.size(); ++i) {
      byMesh_.erase(placed[i].resident->key);
      if (i < listed) places_.giveBack(placed[i].resident->begin, placed[i].resident->units);
    }
    throw;
  }
  for (const Parcel& parcel : placed) {
    const Residents::iterator it = parcel.resident;
    residents_.splice(residents_.end(), residents, it);
    byMesh_[it->key] = it;
    counts_.bytesUploaded += it->units * kUnit;
    counts_.bytesUsed += it->units * kUnit;
  }
  counts_.uploads += placed.size();
}

/// Meshes that lie side by side in one write.
void MeshStore::write(std::span<Parcel> parcels) {
  std::vector<Parcel*> order;
  for (Parcel& parcel : parcels) order.push_back(&parcel);
  std::sort(order.begin(), order.end(),
            [](const Parcel* x, const Parcel* y) { return x->resident->begin < y->resident->begin; });
  std::vector<std::vector<MeshUnit>> together;
  try {
    for (std::size_t i = 0; i < order.size();) {
      const std::uint64_t begin = order[i]->resident->begin;
      std::uint64_t end = begin;
      std::size_t next = i;
      for (; next < order.size() && order[next]->resident->begin == end; ++next) end += order[next]->resident->units;
      const MeshUnit* from = order[i]->packed.units.data();
      if (next > i + 1) {
        std::vector<MeshUnit>& units = together.emplace_back();
        units.reserve(end - begin);
        for (; i < next; ++i) {
          std::vector<MeshUnit>& own = order[i]->packed.units;
          units.insert(units.end(), own.begin(), own.end());
          own = {};
        }
        from = units.data();
      }
      writeLater(queue_.get(), buffer_->get(), (end - begin) * kUnit, from, nullptr, begin * kUnit);
      ++counts_.writes;
      i = next;
    }
    clDo(OTG_CL(clFinish), queue_.get());
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue_.get());  // the memory that is sent stays until it was
    throw;
  }
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
  const auto next = std::next(it);
  if (it->pins == 0) {
    free(*it);
    byMesh_.erase(it->key);
    residents_.erase(it);
  } else {
    byMesh_.erase(it->key);
    outdated_.splice(outdated_.end(), residents_, it);
  }
  return next;
}

void MeshStore::free(const Resident& resident) {
  places_.giveBack(resident.begin, resident.units);
  counts_.bytesUsed -= resident.units * kUnit;
}

/// So that meshes that are sent together have it all at once, where that can be.
void MeshStore::makeRoom(std::uint64_t units) {
  if (places_.free() >= units) return;
  if (sinceSweep_ * kSweepShare > residents_.size()) forgetDead();
  if (places_.free() < units) grow(units - places_.free());
}

std::uint32_t MeshStore::allocate(std::uint32_t units) {
  ++sinceSweep_;
  if (sinceSweep_ * kSweepShare > residents_.size()) forgetDead();
  if (const auto begin = places_.take(units)) return *begin;
  forgetOutdated();
  if (const auto begin = places_.take(units)) return *begin;
  if (grow(units)) {
    if (const auto begin = places_.take(units)) return *begin;
  }
  while (evictOne()) {
    if (const auto begin = places_.take(units)) return *begin;
  }
  if (budget_->askOthers(*this) && grow(units)) {
    if (const auto begin = places_.take(units)) return *begin;
  }
  throw MemoryInUse("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE,
                    "the memory budget is used up by meshes in use");
}

/// A larger buffer with the same contents. Queries that are under way keep the old one.
bool MeshStore::grow(std::uint64_t units) {
  const std::uint64_t before = places_.capacity();
  const std::uint64_t wanted = std::max({std::uint64_t{kFirstUnits}, 2 * before, std::bit_ceil(before + units)});
  const std::uint64_t capacity = std::min({wanted, mostUnits_, before + budget_->left() / kUnit});
  if (capacity <= before || !budget_->take((capacity - before) * kUnit)) return false;
  try {
    // The smaller one counts, too, until the last query that has it is done.
    auto larger = std::make_shared<const BufferHandle>(context_.makeBuffer(CL_MEM_READ_WRITE, capacity * kUnit, this));
    if (buffer_) {
      clDo(OTG_CL(clEnqueueCopyBuffer), queue_.get(), buffer_->get(), larger->get(), std::size_t{0}, std::size_t{0},
           std::size_t{before * kUnit}, cl_uint{0}, static_cast<const cl_event*>(nullptr),
           static_cast<cl_event*>(nullptr));
      clDo(OTG_CL(clFinish), queue_.get());
    }
    places_.grow(static_cast<std::uint32_t>(capacity - before));
    buffer_ = std::move(larger);
  } catch (const ClError& error) {
    budget_->giveBack((capacity - before) * kUnit);
    if (error.code() != CL_MEM_OBJECT_ALLOCATION_FAILURE) throw;
    return false;  // others may make room
  } catch (...) {
    budget_->giveBack((capacity - before) * kUnit);
    throw;
  }
  counts_.bytesHeld = capacity * kUnit;
  return true;
}

/// The least recently used one that no query has. Those that are in use go to the end of the list, so that the next
/// call does not meet them again.
bool MeshStore::evictOne() {
  for (std::size_t left = residents_.size(); left > 0; --left) {
    ++counts_.steps;
    const auto oldest = residents_.begin();
    if (oldest->pins == 0) {
      if (!oldest->structure.expired()) ++counts_.evictions;
      drop(oldest);
      return true;
    }
    residents_.splice(residents_.end(), residents_, oldest);
  }
  return false;
}

void MeshStore::letGo() noexcept {
  if (isBusy_) return;  // perhaps by this thread
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || !buffer_) return;
  if (!isAnyInUse()) forgetAll();
}

void MeshStore::forgetDead() {
  sinceSweep_ = 0;
  counts_.steps += residents_.size();
  for (auto it = residents_.begin(); it != residents_.end();) {
    it = it->pins == 0 && it->structure.expired() ? drop(it) : std::next(it);
  }
  forgetOutdated();
}

void MeshStore::forgetOutdated() {
  counts_.steps += outdated_.size();
  for (auto it = outdated_.begin(); it != outdated_.end();) {
    if (it->pins == 0) {
      free(*it);
      it = outdated_.erase(it);
    } else {
      ++it;
    }
  }
}

MeshStore::Counts MeshStore::counts() const {
  const Lock lock(*this);
  return counts_;
}

}  // namespace otg::opencl
