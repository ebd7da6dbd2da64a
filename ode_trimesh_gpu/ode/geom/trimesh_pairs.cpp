// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/trimesh_pairs.h"

#include <ode/collision.h>

#include <atomic>

#include "ode/geom/geom_class.h"

namespace otg {
namespace {

struct {
  std::atomic<std::uint64_t> queries{0}, contacts{0};
} sums;

/// Bits of classes.
std::atomic<std::uint32_t> overridden{0};

}  // namespace

bool isTrimeshOverridden(int geomClass) noexcept {
  return geomClass < dFirstSpaceClass && (overridden.load(std::memory_order_acquire) >> geomClass & 1) != 0;
}

void noteTrimeshOverridden(int geomClass) noexcept {
  overridden.fetch_or(std::uint32_t{1} << geomClass, std::memory_order_release);
}

bool isMeshFor(dGeomID geom, dGeomID other) noexcept {
  if (objectOf(geom) != nullptr) return true;
  return dGeomGetClass(geom) == dTriMeshClass &&
         (objectOf(other) != nullptr || isTrimeshOverridden(dGeomGetClass(other)));
}

void countTrimesh(std::size_t contacts) noexcept {
  sums.queries.fetch_add(1, std::memory_order_relaxed);
  sums.contacts.fetch_add(contacts, std::memory_order_relaxed);
}

TrimeshCounts trimeshCounts() noexcept {
  return {sums.queries, sums.contacts};
}

}  // namespace otg
