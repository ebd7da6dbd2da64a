// SPDX-License-Identifier: BSD-3-Clause
// Saving a world's state and putting it back, to the last bit.
#pragma once

#include <nanobind/nanobind.h>

#include "world.h"

namespace otg::python {

/// Time, random numbers, all bodies' motion and what pairs remember. For a world that is built in the same way.
nb::bytes saveState(World& world);
/// Throws ArgumentError for bytes that are not those of such a world; then nothing has changed.
void loadState(World& world, const nb::bytes& bytes);

}  // namespace otg::python
