// SPDX-License-Identifier: BSD-3-Clause
// Calls the program's callbacks for the triangles of a mesh that meets a geom of ODE's own.
#pragma once

#include <vector>

#include "ode/shapes/primitive_task.h"

namespace otg {

/// primitiveContacts() for a mesh whose callbacks are called, in the caller's numbers of triangles: all triangles that
/// the other geom touches are reported and passed to them. With none rejected the contacts are what they are without
/// callbacks; else they are those of an open mesh of the triangles that are left.
void askedContacts(PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure);

}  // namespace otg
