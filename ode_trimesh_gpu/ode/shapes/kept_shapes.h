// SPDX-License-Identifier: BSD-3-Clause
// The contacts of a mesh with geoms of ODE's own that stay where they are.
#pragma once

#include "ode/pairs/kept_contacts.h"
#include "ode/shapes/shape_query.h"

namespace otg {

/// Whether results of pairs with geoms of this class are kept: of others they are as quick as a look-up.
bool isKeptClass(int geomClass) noexcept;

/// Of one mesh's geom, by the key of memory; in the mesh's own numbers.
class KeptShapes final : public KeptContacts<ShapeQuery> {};

}  // namespace otg
