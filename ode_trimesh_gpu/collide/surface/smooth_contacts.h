// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a convex shape on a smooth surface: on hills, or on a large ball of many facets.
#pragma once

#include "collide/surface/near_surface.h"

namespace otg {

enum class SurfaceAnswer : std::uint8_t { kOther, kApart, kTouching };

/// The mesh's surface in the shape is in patches. Each that is nearly flat is a height field over a plane, and the
/// shape leaves it along one direction: that of the patch's vector area. The part of the shape's surface that is behind
/// the patch has the same one, because both close the overlap. So a corner in a face leaves along the face's normal,
/// and a face on a bump along its own. Depths are those of the overlap along that direction. Over one triangle the
/// overlap is a concave function. So it is deepest below the shape's corners, at the mesh's vertices, or above an edge
/// of the mesh, where that place is found exactly. Contacts are such places -> workspace.contacts. Depths of flat
/// shapes are exact to double precision; a point of a cylinder's rim or side stands for one up to 1 % deeper.
///
/// kApart where none of the mesh's surface is in the shape. kOther, with no contacts: where a patch turns by more than
/// 40 degrees from its direction, its rim is in the shape, or the shape's middle is behind it. Also where it is deeper
/// than the shape has room around its middle, or the way out may lead into another face. Not for capsules.
SurfaceAnswer addSmoothContacts(const NearSurface& near, Workspace& workspace);

}  // namespace otg
