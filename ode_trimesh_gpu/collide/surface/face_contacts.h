// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a convex shape that lies on faces of a mesh: on a floor, or in the corner of a room.
#pragma once

#include "collide/surface/near_surface.h"

namespace otg {

/// Where no outer edge and no rim of the mesh reaches into the shape, the free space within the shape is convex: what
/// is in front of all the faces there. So the shape leaves each of these faces for itself, along its normal, as it
/// would leave a half space. Contacts are the shape's points below a face: all corners of a flat shape, and of a
/// cylinder those points that collideCylinder() takes -> workspace.contacts. Depths are exact as far as single
/// precision lets triangles be in one plane.
///
/// False, with no contacts, for other places: also where the shape's middle is behind a face, the way out may lead into
/// another face, or nothing is touched. Source: a closed set that is connected and locally convex is convex (H. Tietze
/// 1928, S. Nakajima 1928).
bool addFaceContacts(const NearSurface& near, Workspace& workspace);

}  // namespace otg
