// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/geom_part.h"

#include <ode/ode.h>

#include <bit>

#include "base/hash.h"

namespace otg {
namespace {

constexpr std::size_t kLine = 64;  ///< bytes that memory is fetched in

void fetch(const void* from, std::size_t bytes) noexcept {
  const char* const first = static_cast<const char*>(from);
  for (std::size_t at = 0; at < bytes; at += kLine) __builtin_prefetch(first + at);
  __builtin_prefetch(first + bytes - 1);
}

/// A place in a table of so many, a power of two.
std::size_t placeOf(const void* pointer, std::size_t places) noexcept {
  const std::uint64_t bits = std::bit_cast<std::uintptr_t>(pointer);
  return static_cast<std::size_t>(spreadBits(bits)) & (places - 1);
}

constexpr std::size_t kGeomBytes = 160;  ///< of ODE's dxGeom, about

}  // namespace

GeomPart::GeomPart(std::span<const dGpuTriMeshPair> pairs, bool known) : pairs_(pairs) {
  const auto geomOf = [&](std::size_t k) { return k % 2 == 0 ? pairs[k / 2].o1 : pairs[k / 2].o2; };
  const std::size_t count = 2 * pairs.size();
  const auto found = [&](std::size_t k, GeomObject* object) {
    objects_[k] = object;
    if (object == nullptr) return;
    fetch(geomOf(k), kGeomBytes);
    fetch(object, GeomObject::kReadBytes);
  };
  if (known) {
    for (std::size_t k = 0; k < count; ++k) found(k, objectOf(geomOf(k)));
    return;
  }
  constexpr std::size_t kAhead = 8;
  const LiveObjects live;
  for (std::size_t k = 0; k < count; ++k) {
    if (k + kAhead < count) live.fetch(geomOf(k + kAhead));
    found(k, live.of(geomOf(k)));
  }
}

bool GeomPart::hold(std::size_t i) {
  return holdOne(2 * i) && holdOne(2 * i + 1);
}

bool GeomPart::holdOne(std::size_t k) {
  GeomObject& object = *objects_[k];
  if (!object.uses.beginUse()) return false;
  if (object.data != nullptr && !holdData(object.data, k % 2)) {
    object.uses.endUse();
    return false;
  }
  held_[k] = object.shared_from_this();
  return true;
}

bool GeomPart::holdData(dxGpuTriMeshData* data, std::size_t side) noexcept {
  dxGpuTriMeshData*& slot = data_[side][placeOf(data, kData)];
  if (slot == data) return true;
  if (!data->uses.beginUse()) return false;
  if (slot != nullptr) slot->uses.endUse();
  slot = data;
  return true;
}

void GeomPart::share(const GeomObject& object, const CollisionMesh* mesh,
                     std::vector<std::shared_ptr<const CollisionMesh>>& shares) {
  const CollisionMesh*& slot = shared_[placeOf(mesh, kMeshes)];
  if (slot == mesh) return;
  shares.push_back(object.sharedMesh());
  slot = mesh;
}

void GeomPart::fetchPoses(std::size_t i) const noexcept {
  if (i >= pairs_.size()) return;
  for (const std::size_t k : {2 * i, 2 * i + 1}) {
    const dGeomID geom = k % 2 == 0 ? pairs_[i].o1 : pairs_[i].o2;
    // Poses of geoms with an offset are worked out when they are requested; see readPose().
    if (objects_[k] == nullptr || dGeomIsOffset(geom)) continue;
    fetch(dGeomGetPosition(geom), sizeof(dVector3) + sizeof(dMatrix3));
  }
}

void GeomPart::letGo() noexcept {
  // While the objects are held, and their geoms can't give up the data.
  for (auto& side : data_) {
    for (dxGpuTriMeshData*& data : side) {
      if (data != nullptr) data->uses.endUse();
      data = nullptr;
    }
  }
  for (std::size_t k = 0; k < 2 * pairs_.size(); ++k) {
    if (held_[k] == nullptr) continue;
    held_[k]->uses.endUse();
    held_[k] = nullptr;
  }
}

}  // namespace otg
