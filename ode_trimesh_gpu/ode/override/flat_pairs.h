// SPDX-License-Identifier: BSD-3-Clause
// Near callbacks about flat dTriMesh geoms whose boxes, which ODE gives no margin, just miss each other. Part of the
// preloadable library alone.
#pragma once

#include <ode/ode.h>

namespace otg {

/// There is a dTriMesh: until then nothing is looked for.
void noteTrimesh() noexcept;
bool isAnyTrimesh() noexcept;
/// Data were built anew or updated: what was flat may not be so any more.
void forgetFlatness() noexcept;

/// After dSpaceCollide(): the pairs within the space.
void askAboutFlats(dSpaceID space, void* data, dNearCallback* callback);
/// After dSpaceCollide2(): the pairs of the one with the other, of which each may be a space.
void askAboutFlats(dGeomID o1, dGeomID o2, void* data, dNearCallback* callback);

}  // namespace otg
