// SPDX-License-Identifier: BSD-3-Clause
// Options of geoms, and the choices that hold for the whole process: devices and threads.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <array>

#include "errors.h"
#include "module.h"

namespace otg::python {
namespace {

using DeviceList = nb::typed<nb::list, nb::typed<nb::dict, nb::str, nb::object>>;

DeviceList openDevices() {
  nb::list devices;
  for (int i = 0; i < dGpuTriMeshGetDeviceCount(); ++i) {
    dGpuTriMeshDevice d;
    dGpuTriMeshDeviceInit(&d);
    if (dGpuTriMeshGetDevice(i, &d) != dGPUTRIMESH_OK) continue;
    nb::dict device;
    device["index"] = d.index;
    device["name"] = d.name;
    device["switched_off"] = d.switched_off != 0;
    device["queries"] = d.queries;
    device["failed_queries"] = d.failed_queries;
    device["mesh_bytes"] = d.mesh_bytes;
    device["memory_bytes"] = d.memory_bytes;
    devices.append(device);
  }
  return nb::borrow<DeviceList>(devices);
}

int waitForDevices(int milliseconds) {
  const nb::gil_scoped_release unlocked;
  return check(dGpuTriMeshWaitForDevices(milliseconds));
}

int setBackend(int backend) {
  const nb::gil_scoped_release unlocked;
  return check(dGpuTriMeshSetBackend(backend));
}

}  // namespace

void bindDevices(nb::module_& module) {
  using Params = dGpuTriMeshParams;
  nb::class_<Params>(module, "Params", "The choices of one geom. The package's `Options` fills it.")
      .def("__init__", [](Params* params) { dGpuTriMeshParamsInit(new (params) Params()); })
      .def_rw("traversal", &Params::traversal)
      .def_rw("descent", &Params::descent)
      .def_rw("contact_model", &Params::contact_model)
      .def_rw("reduction", &Params::reduction)
      .def_rw("max_contacts", &Params::max_contacts)
      .def_rw("contacts_per_region", &Params::contacts_per_region)
      .def_rw("region_merge", &Params::region_merge)
      .def_rw("history", &Params::history)
      .def_rw("backend", &Params::backend)
      .def_rw("max_pairs", &Params::max_pairs)
      .def_prop_rw(
          "bins",
          [](const Params& params) {
            std::array<int, 6> bins{};
            std::copy(params.bins, params.bins + 6, bins.begin());
            return bins;
          },
          [](Params& params, const std::array<int, 6>& bins) { std::copy(bins.begin(), bins.end(), params.bins); });
  module.def("set_backend", &setBackend, nb::arg("backend"));
  module.def("wait_for_devices", &waitForDevices, nb::arg("milliseconds"));
  module.def("open_devices", &openDevices);
  module.def(
      "set_threads", [](int count) { check(dGpuTriMeshSetThreadCount(count), "the number of threads"); },
      nb::arg("count"));
  module.def("get_threads", &dGpuTriMeshGetThreadCount);
  module.def("version", &dGpuTriMeshGetVersion);
  module.def("close", [] {
    const nb::gil_scoped_release unlocked;
    dGpuTriMeshClose();
  });
}

}  // namespace otg::python
