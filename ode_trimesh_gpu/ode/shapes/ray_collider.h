// SPDX-License-Identifier: BSD-3-Clause
// dRayClass against a mesh.
#pragma once

#include <vector>

#include "ode/shapes/primitive_task.h"

namespace otg {

/// The contacts of a ray, nearest first. May throw std::bad_alloc.
void rayContacts(const PrimitiveTask& task, std::vector<Contact>& out);

}  // namespace otg
