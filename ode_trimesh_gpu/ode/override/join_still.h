// SPDX-License-Identifier: BSD-3-Clause
// Joins dTriMesh geoms that lie still side by side, as dGpuTriMeshJoin() does. Part of the preloadable library alone,
// which notices when geoms are destroyed.
#pragma once

#include <ode/ode.h>

namespace otg {

/// Before dSpaceCollide(). Looks at the geoms of the space that have no body.
void joinStill(dSpaceID space);
/// A geom is about to be destroyed.
void dropStill(dGeomID geom) noexcept;
void dropAllStill() noexcept;

}  // namespace otg
