// SPDX-License-Identifier: BSD-3-Clause
// The contacts of a mesh with a geom of ODE's own, whatever its class.
#pragma once

#include <vector>

#include "ode/shapes/primitive_task.h"

namespace otg {

/// At most `most` contacts, in the mesh's frame, with the mesh's own triangle numbers. A status in `failure` if there
/// are none because of an error. Callbacks are called for rays alone. May throw std::bad_alloc.
void primitiveContacts(const PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure);

}  // namespace otg
