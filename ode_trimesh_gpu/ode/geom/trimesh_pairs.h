// SPDX-License-Identifier: BSD-3-Clause
// What the rest of the library has to know of dTriMesh geoms that collide through it.
#pragma once

#include <ode/common.h>

#include <cstddef>
#include <cstdint>

namespace otg {

/// Whether ODE leads a dTriMesh's pairs with geoms of that class to us. It stays so when ODE is closed,
/// which it does not report, and forgets them.
bool isTrimeshOverridden(int geomClass) noexcept;
void noteTrimeshOverridden(int geomClass) noexcept;

/// Whether dCollide() comes to us with the geom as a mesh: it is of our class, or a dTriMesh whose pair with `other` is
/// ours. The geoms are alive.
bool isMeshFor(dGeomID geom, dGeomID other) noexcept;

/// A dTriMesh has collided, with so many contacts: into dGpuTriMeshOverrideStats.
void countTrimesh(std::size_t contacts) noexcept;
struct TrimeshCounts {
  std::uint64_t queries, contacts;
};
/// Of all dTriMesh geoms, those that are gone among them.
TrimeshCounts trimeshCounts() noexcept;

}  // namespace otg
