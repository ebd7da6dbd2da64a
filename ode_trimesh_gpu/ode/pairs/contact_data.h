// SPDX-License-Identifier: BSD-3-Clause
// What is reported of a contact beside ODE's own structure.
#pragma once

#include "collide/query.h"
#include "ode_trimesh_gpu/contact_data.h"

namespace otg {

/// What `contact` says to a caller of dGpuTriMeshCollideEx; `first` says whether mesh A is o1,
/// `isOlderA` whether its geom was created first: names of contacts do not follow the roles.
dGpuTriMeshContactData contactData(const Query& query, const Contact& contact, bool first, bool isOlderA);

}  // namespace otg
