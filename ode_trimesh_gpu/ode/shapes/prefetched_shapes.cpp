// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/prefetched_shapes.h"

#include <bit>

#include "collide/pairwise/reduction.h"
#include "ode/pairs/pair_task.h"
#include "ode/shapes/primitive_history.h"

namespace otg {
namespace {

/// By their bits: the same bytes are promised for the same bytes, and 0 is not -0.
template <std::size_t kBytes, class T>
bool sameBits(const T& x, const T& y) {
  static_assert(sizeof(T) == kBytes);
  using Bits = std::array<unsigned char, kBytes>;
  return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y);
}

bool isSame(const std::weak_ptr<const void>& x, const std::weak_ptr<const void>& y) {
  return !x.owner_before(y) && !y.owner_before(x);
}

bool sameQuery(const ShapeQuery& x, const ShapeQuery& y) {
  return x.geomClass == y.geomClass && x.stamp == y.stamp && x.remembers == y.remembers && x.shape == y.shape &&
         sameBits<12 * sizeof(double)>(x.pose, y.pose) && sameBits<4 * sizeof(double)>(x.size, y.size) &&
         sameBits<3 * sizeof(double)>(x.velocity, y.velocity) && isSame(x.mesh, y.mesh) && x.options == y.options;
}

}  // namespace

bool isPrefetchedClass(int geomClass) noexcept {
  switch (geomClass) {
    case dSphereClass:
    case dBoxClass:
    case dCapsuleClass:
    case dCylinderClass:
    case dPlaneClass:
    case dConvexClass:
      return true;
    default:
      return false;
  }
}

bool canBeCut(int geomClass) noexcept {
  return geomClass == dSphereClass || geomClass == dPlaneClass;
}

ShapeQuery shapeQuery(const PrimitiveTask& task) {
  ShapeQuery query;
  const GeomObject& object = *task.side.object;
  query.geomClass = dGeomGetClass(task.o2);
  switch (query.geomClass) {
    case dSphereClass:
      query.size[0] = static_cast<double>(dGeomSphereGetRadius(task.o2));
      break;
    case dPlaneClass: {
      const HalfSpace plane = planeInMesh(task);
      query.size = {plane.normal.x, plane.normal.y, plane.normal.z, plane.offset};
      break;
    }
    case dBoxClass: {
      dVector3 sides;
      dGeomBoxGetLengths(task.o2, sides);
      query.size = {static_cast<double>(sides[0]), static_cast<double>(sides[1]), static_cast<double>(sides[2]), 0};
      break;
    }
    case dConvexClass:
      query.shape = task.shape;
      break;
    default: {
      dReal radius, length;
      if (query.geomClass == dCapsuleClass)
        dGeomCapsuleGetParams(task.o2, &radius, &length);
      else
        dGeomCylinderGetParams(task.o2, &radius, &length);
      query.size = {static_cast<double>(radius), static_cast<double>(length), 0, 0};
    }
  }
  if (query.geomClass != dPlaneClass) query.pose = task.other;
  if (query.geomClass != dPlaneClass && query.geomClass != dSphereClass) {
    const dReal* const at = dGeomGetPosition(task.o2);
    query.velocity = relativeVelocity(task, Vec3d{at[0], at[1], at[2]});
  }
  query.options = pairOptions(object.params, object.params);
  query.mesh = task.side.mesh->lifetime();
  query.remembers = object.remembersWith(query.geomClass);
  if (query.remembers) query.stamp = task.side.object->memory.stampOf(memoryKey(task.o2));
  return query;
}

bool PrefetchedShapes::find(std::uint64_t key, const ShapeQuery& query, int capacity, std::vector<Contact>& out,
                            DetachedHistory& left) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it == entries_.end()) return false;
  Entry& entry = it->second;
  entry.asked = capacity;
  if (!sameQuery(entry.query, query)) return false;
  const auto count = static_cast<int>(entry.contacts.size());
  if (capacity != entry.most) {
    if (count >= entry.most) return false;  // it may have been cut
    if (count > capacity && !canBeCut(query.geomClass)) return false;
  }
  if (count > capacity)
    out = limitContacts(entry.contacts, capacity);
  else
    out.assign(entry.contacts.begin(), entry.contacts.end());
  left = entry.left;
  return true;
}

void PrefetchedShapes::seen(std::uint64_t key, std::uint64_t before, std::uint64_t now) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it != entries_.end() && it->second.query.stamp == before) it->second.query.stamp = now;
}

int PrefetchedShapes::placesAskedFor(std::uint64_t key, int otherwise) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  return it != entries_.end() && it->second.asked > 0 ? it->second.asked : otherwise;
}

void PrefetchedShapes::beginRound() {
  const std::lock_guard lock(mutex_);
  ++round_;
}

bool PrefetchedShapes::keep(std::uint64_t key, const ShapeQuery& query, int most) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it == entries_.end() || it->second.most != most || !sameQuery(it->second.query, query)) return false;
  it->second.round = round_;
  return true;
}

void PrefetchedShapes::add(std::uint64_t key, ShapeQuery&& query, int most, std::vector<Contact>&& contacts,
                           const DetachedHistory& left) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[key];
  entry = {std::move(query), std::move(contacts), left, most, entry.asked, round_};
  count_.store(entries_.size(), std::memory_order_release);
}

void PrefetchedShapes::endRound() {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [this](const auto& item) { return item.second.round != round_; });
  count_.store(entries_.size(), std::memory_order_release);
}

}  // namespace otg
