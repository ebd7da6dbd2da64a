// SPDX-License-Identifier: BSD-3-Clause
// The extension module ode_trimesh_gpu._core: arrays of the Python side to the C API and the harness. What people call
// is written in Python on top of it.
#include "module.h"

#include "errors.h"
#include "geoms.h"
#include "mesh.h"

NB_MODULE(_core, module) {
  using namespace otg::python;
  module.doc() = "The compiled part of ode_trimesh_gpu. Use the package itself.";
  bindErrors(module);
  bindDevices(module);
  bindMesh(module);
  bindGeoms(module);
  bindWorld(module);
  bindScenes(module);
  bindRecording(module);
}
