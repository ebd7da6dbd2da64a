// SPDX-License-Identifier: BSD-3-Clause
// The parts of the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace otg::python {

namespace nb = nanobind;

void bindDevices(nb::module_& module);
void bindWorld(nb::module_& module);
void bindScenes(nb::module_& module);
void bindRecording(nb::module_& module);

}  // namespace otg::python
